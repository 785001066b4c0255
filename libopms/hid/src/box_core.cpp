/* SPDX-License-Identifier: Apache-2.0 */
/* What callers see of the core, and the life of its threads. */
#include "box_core.hpp"

#include <csignal>
#include <exception>
#include <random>

#include <pthread.h>

namespace opms_hid {

namespace {

constexpr std::chrono::milliseconds CLOSE_TIMEOUT(2000);
constexpr size_t REQUESTS_MAX = 64;

} // namespace

BoxCore::BoxCore(const opms_box_options_t &options, std::unique_ptr<BoxTransport> transport)
    : options_(options), transport_(std::move(transport)), queue_(options.queue_items),
      ping_id_(std::random_device{}())
{
}

/** The threads take no signals: one in the midst of a read would look like an unplug. */
void BoxCore::start_thread(std::thread &thread, void (BoxCore::*body)())
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        ++running_;
    }
    try {
        thread = std::thread([core = shared_from_this(), body] {
            try {
                (core.get()->*body)();
            } catch (const std::exception &error) {
                core->tell_link(OPMS_LINK_FAILED, 0, error.what());
            }
            const std::lock_guard<std::mutex> guard(core->mutex_);
            --core->running_;
            core->stopping_ = true;
            core->changed_.notify_all();
        });
    } catch (const std::exception &) {
        const std::lock_guard<std::mutex> guard(mutex_);
        --running_;
        stopping_ = true;
    }
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

OpenResult BoxCore::open()
{
    const Clock::time_point deadline =
        Clock::now() + std::chrono::milliseconds(options_.open_timeout_ms);
    start_thread(reader_, &BoxCore::read_thread);
    start_thread(worker_, &BoxCore::work_thread);
    Lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return opened_ || stopping_; });
    if (!opened_) {
        return {OPMS_ERR_TIMEOUT, false,
                "the box did not answer within " + std::to_string(options_.open_timeout_ms) +
                    " ms", {}};
    }
    return outcome_;
}

void BoxCore::join_or_leave(std::thread &thread, bool is_over)
{
    if (thread.joinable()) {
        is_over ? thread.join() : thread.detach();
    }
}

void BoxCore::close()
{
    {
        const std::lock_guard<std::mutex> guard(deliver_mutex_);
        is_closed_ = true;
    }
    transport_->interrupt();
    Lock lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
    const bool is_over = changed_.wait_until(lock, Clock::now() + CLOSE_TIMEOUT,
                                             [this] { return running_ == 0; });
    lock.unlock();
    join_or_leave(reader_, is_over);
    join_or_leave(worker_, is_over);
}

bool BoxCore::pop(opms_box_item_t &item, Clock::time_point deadline)
{
    return queue_.pop(item, deadline);
}

void BoxCore::deliver(const opms_box_item_t *items, size_t count)
{
    const std::lock_guard<std::mutex> guard(deliver_mutex_);
    for (size_t i = 0; i < count && !is_closed_; ++i) {
        if (options_.on_item) {
            options_.on_item(options_.user, &items[i]);
        } else {
            queue_.push(items[i]);
        }
    }
}

opms_identity_report_t BoxCore::identity(bool &connected)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    connected = connected_;
    return identity_;
}

opms_box_counters_t BoxCore::counters()
{
    const uint64_t items_lost = queue_.lost();
    const std::lock_guard<std::mutex> guard(mutex_);
    opms_box_counters_t counters = tracker_.counters();
    counters.triggers_filled = filled_;
    counters.triggers_unfilled = unfilled_;
    counters.items_lost = items_lost;
    counters.requests_failed = requests_failed_;
    return counters;
}

Io BoxCore::run(Work work, Clock::time_point deadline)
{
    const auto request = std::make_shared<Request>();
    request->work = std::move(work);
    Lock lock(mutex_);
    if (!connected_ || stopping_) {
        return Io::gone;
    }
    if (requests_.size() >= REQUESTS_MAX) {
        return Io::timed_out;
    }
    requests_.push_back(request);
    changed_.notify_all();
    changed_.wait_until(lock, deadline, [&] { return request->is_done || stopping_; });
    return request->is_done ? request->io : stopping_ ? Io::gone : Io::timed_out;
}

uint32_t BoxCore::next_ping_id()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return ++ping_id_;
}

Io BoxCore::send_ping(BoxTransport &transport, uint32_t ping_id)
{
    const opms_command_report_t command = {OPMS_COMMAND_PING, ping_id};
    Report report;
    opms_wire_write_command(&command, report.data());
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        tracker_.ping_sent(ping_id, host_now_ns());
    }
    return transport.write(report);
}

void BoxCore::arming(uint32_t session_id)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    tracker_.arming(session_id);
}

Seen BoxCore::seen()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return seen_;
}

bool BoxCore::wait_seen(const std::function<bool(const Seen &)> &is_enough,
                        Clock::time_point deadline)
{
    Lock lock(mutex_);
    changed_.wait_until(lock, deadline,
                        [&] { return is_enough(seen_) || !connected_ || stopping_; });
    return is_enough(seen_);
}

bool BoxCore::begin_history_turn(Clock::time_point deadline)
{
    Lock lock(mutex_);
    ++history_wanted_;
    const bool is_ours =
        changed_.wait_until(lock, deadline, [this] { return !history_taken_; });
    history_taken_ = history_taken_ || is_ours;
    return is_ours;
}

void BoxCore::end_history_turn(bool was_ours)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    --history_wanted_;
    history_taken_ = history_taken_ && !was_ours;
    changed_.notify_all();
}

} // namespace opms_hid
