/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers are compared by their difference in 32 bit, so that a wrap is a step like any other.
 *
 * A pulse is missing when a later one is reported. The last ones of a run have none after them:
 * STATUS and STOP announce their number, and if the next STATUS comes before their reports, they
 * are missing, too. One announcement alone proves nothing: a report may be on its way. */
#include "report_tracker.hpp"

#include <cstdio>

namespace opms_hid {

namespace {

/** How far a is ahead of b; negative where it is behind. */
int32_t ahead(uint32_t a, uint32_t b)
{
    return static_cast<int32_t>(a - b);
}

opms_box_item_t make_item(opms_item_kind_t kind, int64_t t_host_ns)
{
    opms_box_item_t item = {};
    item.kind = kind;
    item.t_host_ns = t_host_ns;
    return item;
}

opms_box_item_t lost_item(int64_t t_host_ns, opms_lost_what_t what, uint32_t session_id,
                          uint32_t first, uint32_t count)
{
    opms_box_item_t item = make_item(OPMS_ITEM_LOST, t_host_ns);
    item.as.lost = {what, session_id, first, count};
    return item;
}

} // namespace

void PingTimes::sent(uint32_t ping_id, int64_t t_host_ns)
{
    pings_[next_] = {ping_id, t_host_ns};
    next_ = (next_ + 1) % pings_.size();
}

int64_t PingTimes::take(uint32_t ping_id)
{
    for (Ping &ping : pings_) {
        if (ping.id == ping_id && ping.t_host_ns != 0) {
            const int64_t t_host_ns = ping.t_host_ns;
            ping.t_host_ns = 0;
            return t_host_ns;
        }
    }
    return 0;
}

bool ReportTracker::connected(uint32_t boot_id)
{
    ++counters_.connections;
    const bool is_other = boot_id_ != 0 && boot_id != boot_id_;
    if (boot_id != boot_id_) {
        counters_.reboots += is_other ? 1 : 0;
        boot_id_ = boot_id;
        has_report_number_ = false;
        session_id_ = 0;
    }
    return is_other;
}

void ReportTracker::take(const Input &input, Result &result)
{
    result.items.clear();
    result.gaps.clear();
    const opms_wire_result_t what =
        input.size == OPMS_WIRE_SIZE ? add_report(input, result) : OPMS_WIRE_LENGTH;
    if (what != OPMS_WIRE_OK) {
        add_malformed(input, what, result);
    }
}

void ReportTracker::add_malformed(const Input &input, opms_wire_result_t what, Result &result)
{
    ++counters_.malformed[what];
    opms_box_item_t item = make_item(OPMS_ITEM_MALFORMED, input.t_host_ns);
    item.as.malformed = {what, input.size ? input.bytes[0] : uint8_t{0},
                         static_cast<uint32_t>(input.size)};
    result.items.push_back(item);
}

/** Count and number off what every report has. */
template <typename T> void ReportTracker::see(const T &report, int64_t t_host_ns, Result &result)
{
    see_boot(report.boot_id, t_host_ns, result);
    see_report_number(report.report_number, t_host_ns, result);
}

opms_wire_result_t ReportTracker::add_trigger(const Input &input, Result &result)
{
    opms_box_item_t item = make_item(OPMS_ITEM_TRIGGER, input.t_host_ns);
    const opms_wire_result_t what =
        opms_wire_read_trigger(input.bytes.data(), input.size, &item.as.trigger);
    if (what == OPMS_WIRE_OK) {
        ++counters_.triggers;
        see(item.as.trigger, input.t_host_ns, result);
        see_trigger(item.as.trigger, input.t_host_ns, result);
        result.items.push_back(item);
    }
    return what;
}

opms_wire_result_t ReportTracker::add_pong(const Input &input, Result &result)
{
    opms_box_item_t item = make_item(OPMS_ITEM_PONG, input.t_host_ns);
    const opms_wire_result_t what =
        opms_wire_read_pong(input.bytes.data(), input.size, &item.as.pong.report);
    if (what == OPMS_WIRE_OK) {
        ++counters_.pongs;
        item.as.pong.t_sent_host_ns = pings_.take(item.as.pong.report.ping_id);
        see(item.as.pong.report, input.t_host_ns, result);
        result.items.push_back(item);
    }
    return what;
}

opms_wire_result_t ReportTracker::add_status(const Input &input, Result &result)
{
    opms_box_item_t item = make_item(OPMS_ITEM_STATUS, input.t_host_ns);
    opms_status_report_t &status = item.as.status;
    const opms_wire_result_t what =
        opms_wire_read_status(input.bytes.data(), input.size, &status);
    if (what == OPMS_WIRE_OK) {
        ++counters_.statuses;
        see(status, input.t_host_ns, result);
        see_last_trigger(status.session_id, status.trigger_number, true, input.t_host_ns, result);
        result.items.push_back(item);
    }
    return what;
}

opms_wire_result_t ReportTracker::add_event(const Input &input, Result &result)
{
    opms_box_item_t item = make_item(OPMS_ITEM_EVENT, input.t_host_ns);
    opms_event_report_t &event = item.as.event;
    const opms_wire_result_t what = opms_wire_read_event(input.bytes.data(), input.size, &event);
    if (what == OPMS_WIRE_OK) {
        ++counters_.events;
        see(event, input.t_host_ns, result);
        if (event.kind == OPMS_EVENT_STOP) {
            see_last_trigger(event.session_id, event.argument, false, input.t_host_ns, result);
        }
        result.items.push_back(item);
    }
    return what;
}

/** The report, preceded by what its numbers tell. */
opms_wire_result_t ReportTracker::add_report(const Input &input, Result &result)
{
    uint8_t id = 0;
    const opms_wire_result_t what = opms_wire_check(input.bytes.data(), input.size, &id);
    if (what != OPMS_WIRE_OK) {
        return what;
    }
    switch (id) {
    case OPMS_REPORT_TRIGGER: return add_trigger(input, result);
    case OPMS_REPORT_PONG: return add_pong(input, result);
    case OPMS_REPORT_STATUS: return add_status(input, result);
    case OPMS_REPORT_EVENT: return add_event(input, result);
    default: return OPMS_WIRE_ID; /* of no input report */
    }
}

void ReportTracker::see_boot(uint32_t boot_id, int64_t t_host_ns, Result &result)
{
    if (boot_id == boot_id_) {
        return;
    }
    opms_box_item_t item = make_item(OPMS_ITEM_LINK, t_host_ns);
    item.as.link.change = OPMS_LINK_REBOOTED;
    item.as.link.boot_id = boot_id;
    std::snprintf(item.as.link.message, sizeof item.as.link.message,
                  "the box has restarted (boot id %08x, was %08x)", boot_id, boot_id_);
    result.items.push_back(item);
    ++counters_.reboots;
    boot_id_ = boot_id;
    has_report_number_ = false;
    session_id_ = 0;
}

void ReportTracker::see_report_number(uint32_t number, int64_t t_host_ns, Result &result)
{
    const int32_t step = has_report_number_ ? ahead(number, report_number_) : 1;
    if (step <= 0) {
        ++counters_.reports_repeated;
        return;
    }
    if (step > 1) {
        const uint32_t count = static_cast<uint32_t>(step) - 1;
        counters_.reports_lost += count;
        result.items.push_back(
            lost_item(t_host_ns, OPMS_LOST_REPORTS, 0, report_number_ + 1, count));
    }
    has_report_number_ = true;
    report_number_ = number;
}

/** A session that was armed here is known from its first pulse on, any other one from what is seen
 * first: what came before it was not ours to read. */
void ReportTracker::see_session(uint32_t session_id, uint32_t before_first)
{
    if (session_id == session_id_) {
        return;
    }
    session_id_ = session_id;
    trigger_number_ = session_id == armed_here_ ? 0 : before_first;
    announced_ = trigger_number_;
}

void ReportTracker::see_trigger(const opms_trigger_report_t &trigger, int64_t t_host_ns,
                                Result &result)
{
    see_session(trigger.session_id, trigger.trigger_number - 1);
    const int32_t step = ahead(trigger.trigger_number, trigger_number_);
    if (step <= 0) {
        return;
    }
    if (step > 1) {
        miss(trigger_number_ + 1, static_cast<uint32_t>(step) - 1, t_host_ns, result);
    }
    trigger_number_ = trigger.trigger_number;
}

void ReportTracker::see_last_trigger(uint32_t session_id, uint32_t number, bool is_final,
                                     int64_t t_host_ns, Result &result)
{
    if (session_id == 0) {
        return;
    }
    see_session(session_id, number);
    const int32_t step = ahead(announced_, trigger_number_);
    if (is_final && step > 0) {
        const uint32_t first = trigger_number_ + 1;
        trigger_number_ = announced_;
        miss(first, static_cast<uint32_t>(step), t_host_ns, result);
    }
    if (ahead(number, announced_) > 0) {
        announced_ = number;
    }
}

void ReportTracker::miss(uint32_t first, uint32_t count, int64_t t_host_ns, Result &result)
{
    counters_.triggers_missed += count;
    result.items.push_back(
        lost_item(t_host_ns, OPMS_LOST_TRIGGERS, session_id_, first, count));
    result.gaps.push_back({boot_id_, session_id_, first, count});
}

} // namespace opms_hid
