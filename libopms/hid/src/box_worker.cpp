/* SPDX-License-Identifier: Apache-2.0 */
/* The worker thread: one request at a time. Callers first, then pings, then lost pulses. */
#include <algorithm>

#include "box_core.hpp"

namespace opms_hid {

namespace {

constexpr std::chrono::milliseconds FILL_PAUSE(20); /* after a failure */
constexpr std::chrono::hours LONG(1);

} // namespace

bool BoxCore::may_fill(Clock::time_point now) const
{
    return announced_ && history_wanted_ == 0 && now >= fill_after_ &&
           (!new_gaps_.empty() || !fill_.is_idle());
}

Clock::time_point BoxCore::next_wake() const
{
    Clock::time_point wake = Clock::now() + LONG;
    if (connected_ && options_.ping_interval_ms) {
        wake = std::min(wake, next_ping_);
    }
    if (announced_ && history_wanted_ == 0 && (!new_gaps_.empty() || !fill_.is_idle())) {
        wake = std::min(wake, fill_after_);
    }
    return wake;
}

void BoxCore::work_thread()
{
    Lock lock(mutex_);
    while (!stopping_) {
        const Clock::time_point now = Clock::now();
        if (!requests_.empty()) {
            do_request(lock);
        } else if (connected_ && options_.ping_interval_ms && now >= next_ping_) {
            do_ping(lock);
        } else if (may_fill(now)) {
            do_fill(lock);
        } else {
            changed_.wait_until(lock, next_wake());
        }
    }
}

void BoxCore::do_request(Lock &lock)
{
    const std::shared_ptr<Request> request = requests_.front();
    requests_.pop_front();
    Io io = Io::gone;
    if (connected_) {
        lock.unlock();
        io = request->work(*transport_);
        lock.lock();
    }
    requests_failed_ += io == Io::done ? 0 : 1;
    request->io = io;
    request->is_done = true;
    changed_.notify_all();
}

void BoxCore::do_ping(Lock &lock)
{
    next_ping_ = Clock::now() + std::chrono::milliseconds(options_.ping_interval_ms);
    const uint32_t ping_id = ++ping_id_;
    lock.unlock();
    const Io io = send_ping(*transport_, ping_id);
    lock.lock();
    requests_failed_ += io == Io::done ? 0 : 1;
}

void BoxCore::do_fill(Lock &lock)
{
    for (const Gap &gap : new_gaps_) {
        fill_.add(gap);
    }
    new_gaps_.clear();
    if (fill_connection_ != connection_) {
        fill_connection_ = connection_;
        fill_.disconnected();
    }
    lock.unlock();
    fill_.step(*transport_, fill_result_);
    const auto &items = fill_result_.items;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        filled_ += fill_result_.filled;
        unfilled_ += fill_result_.unfilled;
        requests_failed_ += fill_result_.failed ? 1 : 0;
    }
    deliver(items.data(), items.size());
    lock.lock();
    if (fill_result_.failed) {
        fill_after_ = Clock::now() + FILL_PAUSE;
    }
}

} // namespace opms_hid
