/* SPDX-License-Identifier: Apache-2.0 */
#include "scan_feed.hpp"

#include <chrono>

void ScanFeed::push(Item item)
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (items_.size() == MOST) {
            items_.pop_front();
            left_out_++;
        }
        items_.push_back(std::move(item));
    }
    came_.notify_one();
}

void ScanFeed::on_state(const opms_host::SessionStatus &status)
{
    push(status);
}

void ScanFeed::on_pose(const Pose &pose)
{
    push(pose);
}

void ScanFeed::on_event(const opms_host::EventRecord &event)
{
    push(event);
}

std::uint64_t ScanFeed::take(std::uint32_t timeout_ms, std::deque<Item> &items)
{
    items.clear();
    std::unique_lock<std::mutex> lock(mutex_);
    came_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [this] { return !items_.empty(); });
    items.swap(items_);
    const std::uint64_t left_out = left_out_;
    left_out_ = 0;
    return left_out;
}
