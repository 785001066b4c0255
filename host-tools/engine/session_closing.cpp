/* SPDX-License-Identifier: Apache-2.0 */
/* The end of a scan, by a thread of its own: it waits for the disk. */
#include "session_impl.hpp"

#include <chrono>

#include "standstill_guard.hpp"

namespace opms_host {
namespace {

using namespace std::chrono_literals;

/* The pairer's longest wait and the time that a new lock may take are over by then. */
constexpr std::int64_t SETTLE_NS = 3'000'000'000;
constexpr std::int64_t MAX_WAIT_NS = 6'000'000'000; /* the pairer's default */
/* After a box has gone, pictures that were on their way come within this time. */
constexpr std::int64_t ON_THE_WAY_NS = 500'000'000;

SessionState state_after(const std::string &reason)
{
    const bool is_broken =
        reason == "box.rebooted" || reason == "box.taken" || reason == "box.stopped";
    return is_broken ? SessionState::interrupted : SessionState::idle;
}

}  // namespace

/** With the lock held. The first reason counts. */
void LiveSession::Impl::request_finish(const std::string &reason, bool patient)
{
    if (!finish_ && core_.has_scan()) {
        finish_ = Finish{reason, patient};
        changed_.notify_all();
    }
}

void LiveSession::Impl::wait_for_finish(Lock &lock)
{
    changed_.wait(lock, [this] { return !core_.has_scan(); });
}

void LiveSession::Impl::closing_loop()
{
    Lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return quit_ || finish_; });
        if (!finish_) {
            return;
        }
        finish_scan(lock, Finish(*finish_));
        finish_.reset();
        changed_.notify_all();
    }
}

void LiveSession::Impl::finish_scan(Lock &lock, const Finish &finish)
{
    if (core_.scan_has_box() && core_.over().empty()) {
        core_.set_stopping();
        disarm_box(lock);
    }
    if (finish.patient || !core_.over().empty()) {
        wait_until_decided(lock);
    }
    core_.close_pairing();
    changed_.wait(lock, [this] { return core_.waiting() == 0; });
    if (devices_.source) {
        lock.unlock();
        const SourceCounters counters = devices_.source->counters();
        lock.lock();
        core_.set_source_counters(counters);
    }
    const ScanEnd end = core_.scan_end(finish.reason);
    core_.tell(Severity::info, "session.ended", "the scan has ended: " + finish.reason);
    const std::shared_ptr<ScanSink> sink = core_.sink();
    last_end_error_.clear();
    if (sink) {
        lock.unlock();
        std::string error;
        const bool is_whole = sink->end(end, error);
        lock.lock();
        if (!is_whole) {
            last_end_error_ = "recording: " + error;
            core_.tell(Severity::error, "session.recording_not_whole", error);
        }
    }
    last_end_ = end;
    core_.forget_scan(state_after(finish.reason));
}

void LiveSession::Impl::disarm_box(Lock &lock)
{
    std::string error = "the box is not connected: it is stopped as soon as it is back";
    bool done = false;
    if (core_.is_box_connected()) {
        lock.unlock();
        done = devices_.box->disarm(error);
        lock.lock();
    }
    if (!done) {
        disarm_wanted_ = true;
        core_.tell(Severity::warning, "box.not_disarmed", error);
    }
}

void LiveSession::Impl::wait_until_decided(Lock &lock)
{
    const std::int64_t wait_ns =
        options_.max_wait_ms > 0 ? options_.max_wait_ms * std::int64_t{1000000} : MAX_WAIT_NS;
    const std::int64_t deadline_ns = devices_.clock->now_ns() + wait_ns + SETTLE_NS;
    StandstillGuard guard;
    while (!quit_ && !core_.is_decided()) {
        const std::int64_t now_ns = devices_.clock->now_ns();
        const bool is_gone = !core_.over().empty() || source_ended_;
        if (now_ns > deadline_ns || guard.stands_still(now_ns) ||
            (is_gone && now_ns - core_.last_frame_ns() > ON_THE_WAY_NS)) {
            return;
        }
        changed_.wait_for(lock, 5ms);
    }
}

}  // namespace opms_host
