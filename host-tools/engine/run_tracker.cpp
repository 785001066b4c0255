/* SPDX-License-Identifier: Apache-2.0 */
#include "run_tracker.hpp"

namespace opms_host {

void RunTracker::begin(std::uint32_t boot_id, std::uint32_t session_id, std::int64_t now_host_ns)
{
    *this = RunTracker();
    boot_id_ = boot_id;
    session_id_ = session_id;
    begun_host_ns_ = now_host_ns;
}

/** Is it of this boot, and newer than all before? Report numbers wrap. */
bool RunTracker::is_news(std::uint32_t boot_id, std::uint32_t report_number)
{
    if (boot_id != boot_id_) {
        over_ = "box.rebooted";
        return false;
    }
    if (any_report_ && static_cast<std::int32_t>(report_number - newest_report_) <= 0) {
        return false;
    }
    any_report_ = true;
    newest_report_ = report_number;
    return true;
}

void RunTracker::take_state(opms_box_state_t state, const char *reason)
{
    switch (state) {
    case OPMS_BOX_IDLE: over_ = reason; return;
    case OPMS_BOX_ARMED: state_ = SessionState::arming; break;
    case OPMS_BOX_PREAMBLE: state_ = SessionState::preamble; break;
    case OPMS_BOX_WAITING: state_ = SessionState::ready; break;
    case OPMS_BOX_RUNNING: state_ = SessionState::running; break;
    }
    taken_up_ = true;
}

void RunTracker::take_status(const opms_status_report_t &status)
{
    if (!is_news(status.boot_id, status.report_number)) {
        return;
    }
    if (status.session_id == session_id_) {
        take_state(status.state, "box.stopped");
    } else if (taken_up_) {
        over_ = "box.taken";
    }
}

void RunTracker::take_event(const opms_event_report_t &event)
{
    if (is_news(event.boot_id, event.report_number) && event.session_id == session_id_) {
        take_state(event.state,
                   event.kind == OPMS_EVENT_WAIT_TIMEOUT ? "box.wait_timeout" : "box.stopped");
    }
}

void RunTracker::take_trigger(const opms_trigger_report_t &trigger)
{
    if (!is_news(trigger.boot_id, trigger.report_number) || trigger.session_id != session_id_) {
        return;
    }
    /* A pulse's report may be made before the state changes and sent after it. */
    if (trigger.flags & OPMS_TRIGGER_RUN) {
        take_state(OPMS_BOX_RUNNING, nullptr);
    } else if (state_ == SessionState::arming) {
        take_state(OPMS_BOX_PREAMBLE, nullptr);
    }
}

void RunTracker::take(const opms_box_item_t &item)
{
    if (over_ || item.t_host_ns < begun_host_ns_) {
        return;
    }
    switch (item.kind) {
    case OPMS_ITEM_STATUS: take_status(item.as.status); break;
    case OPMS_ITEM_EVENT: take_event(item.as.event); break;
    case OPMS_ITEM_TRIGGER: take_trigger(item.as.trigger); break;
    case OPMS_ITEM_LINK:
        if (item.as.link.change == OPMS_LINK_REBOOTED) {
            over_ = "box.rebooted";
        }
        break;
    default: break;
    }
}

}  // namespace opms_host
