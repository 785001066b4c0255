/* SPDX-License-Identifier: Apache-2.0 */
#include "record_queue.hpp"

#include <utility>

namespace opms_host {

namespace {

constexpr std::size_t EARLY_BYTES = 8u << 20; /* a simulated scan may run faster than real time */
constexpr std::size_t MOST_BYTES = 512u << 20;

}  // namespace

bool RecordQueue::push(Row row)
{
    const std::size_t bytes = row_bytes(row);
    const std::lock_guard<std::mutex> guard(mutex_);
    if (closed_) {
        return true;
    }
    rows_.push_back(std::move(row));
    if (bytes_ < EARLY_BYTES && bytes_ + bytes >= EARLY_BYTES) {
        changed_.notify_all();
    }
    bytes_ += bytes;
    return bytes_ < MOST_BYTES;
}

void RecordQueue::wait(std::chrono::steady_clock::time_point deadline)
{
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_until(lock, deadline,
                        [this] { return woken_ || closed_ || bytes_ >= EARLY_BYTES; });
    woken_ = false;
}

void RecordQueue::wake()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    woken_ = true;
    changed_.notify_all();
}

void RecordQueue::close()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    closed_ = true;
    changed_.notify_all();
}

bool RecordQueue::is_closed() const
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return closed_;
}

std::vector<Row> RecordQueue::take(std::int64_t &taken_host_ns)
{
    std::vector<Row> rows;
    const std::lock_guard<std::mutex> guard(mutex_);
    rows.swap(rows_);
    bytes_ = 0;
    taken_host_ns = clock_.now_ns();
    return rows;
}

std::uint64_t RecordQueue::size() const
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return rows_.size();
}

}  // namespace opms_host
