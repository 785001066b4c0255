/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rows on their way from those who hand them over to the thread that writes. */
#ifndef OPMS_RECORDING_RECORD_QUEUE_HPP
#define OPMS_RECORDING_RECORD_QUEUE_HPP

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <vector>

#include "host_clock.hpp"
#include "row_writer.hpp"

namespace opms_host {

class RecordQueue {
public:
    explicit RecordQueue(const HostClock &clock) : clock_(clock) {}

    /** Never waits. Dropped where the queue is closed.
     * @return False where so much waits that the disk cannot be working; nothing is dropped yet. */
    bool push(Row row);
    /** Wait until @p deadline, or until there is reason not to: much waits, wake() or close(). */
    void wait(std::chrono::steady_clock::time_point deadline);
    void wake();
    /** No more comes in; what waits can still be taken. */
    void close();
    bool is_closed() const;
    /** All that waits. @param[out] taken_host_ns  All that was handed over before is in it. */
    std::vector<Row> take(std::int64_t &taken_host_ns);
    std::uint64_t size() const;

private:
    const HostClock &clock_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Row> rows_;
    std::size_t bytes_ = 0;
    bool woken_ = false, closed_ = false;
};

}  // namespace opms_host
#endif
