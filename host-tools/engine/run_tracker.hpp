/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where a run stands, by what its box says. */
#ifndef OPMS_ENGINE_RUN_TRACKER_HPP
#define OPMS_ENGINE_RUN_TRACKER_HPP

#include <cstdint>

#include <opms/hid.h>

#include "scan_listener.hpp"

namespace opms_host {

/** Follows one session of one boot of the box. Reports that are older than the newest one, or of
 * another session, change nothing. One thread at a time. */
class RunTracker {
public:
    /** Right before the box is armed. Items from before @p now_host_ns are of the time before. */
    void begin(std::uint32_t boot_id, std::uint32_t session_id, std::int64_t now_host_ns);
    void take(const opms_box_item_t &item);

    /** arming to running; what the box said last. */
    SessionState state() const { return state_; }
    /** Why the run is over without having been stopped from here: a code of an event; NULL while it
     * is not. */
    const char *over() const { return over_; }

private:
    bool is_news(std::uint32_t boot_id, std::uint32_t report_number);
    void take_state(opms_box_state_t state, const char *reason);
    void take_status(const opms_status_report_t &status);
    void take_event(const opms_event_report_t &event);
    void take_trigger(const opms_trigger_report_t &trigger);

    std::uint32_t boot_id_ = 0, session_id_ = 0, newest_report_ = 0;
    std::int64_t begun_host_ns_ = 0;
    bool any_report_ = false, taken_up_ = false;
    SessionState state_ = SessionState::arming;
    const char *over_ = nullptr;
};

}  // namespace opms_host
#endif
