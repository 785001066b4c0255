/* SPDX-License-Identifier: Apache-2.0 */
#include "world_tracker.hpp"

#include <cstdio>

namespace opms_host {

namespace {

/** How far a is ahead of b; numbers wrap. */
std::int32_t ahead(std::uint32_t a, std::uint32_t b)
{
    return static_cast<std::int32_t>(a - b);
}

constexpr std::size_t PINGS_MAX = 64;

}  // namespace

opms_box_item_t box_item(opms_item_kind_t kind, std::int64_t t_host_ns)
{
    opms_box_item_t item = {};
    item.kind = kind;
    item.t_host_ns = t_host_ns;
    return item;
}

opms_box_item_t link_item(std::int64_t t_host_ns, opms_link_change_t change,
                          std::uint32_t boot_id, const char *message)
{
    opms_box_item_t item = box_item(OPMS_ITEM_LINK, t_host_ns);
    item.as.link.change = change;
    item.as.link.boot_id = boot_id;
    std::snprintf(item.as.link.message, sizeof item.as.link.message, "%s", message);
    return item;
}

opms_box_item_t lost_item(std::int64_t t_host_ns, opms_lost_what_t what,
                          std::uint32_t session_id, std::uint32_t first, std::uint32_t count)
{
    opms_box_item_t item = box_item(OPMS_ITEM_LOST, t_host_ns);
    item.as.lost = {what, session_id, first, count};
    return item;
}

bool WorldTracker::connected(std::uint32_t boot_id)
{
    const bool is_other = boot_id_ != 0 && boot_id != boot_id_;
    if (boot_id != boot_id_) {
        boot_id_ = boot_id;
        has_report_number_ = false;
        session_id_ = 0;
    }
    return is_other;
}

void WorldTracker::ping_sent(std::uint32_t ping_id, std::int64_t t_host_ns)
{
    pings_[ping_id] = t_host_ns;
    if (pings_.size() > PINGS_MAX) {
        pings_.erase(pings_.begin());
    }
}

void WorldTracker::see(std::uint32_t boot_id, std::uint32_t report_number, std::int64_t t,
                       Items &items)
{
    if (boot_id != boot_id_) {
        connected(boot_id);
        items.push_back(link_item(t, OPMS_LINK_REBOOTED, boot_id, "the box has restarted"));
    }
    const std::int32_t step = has_report_number_ ? ahead(report_number, report_number_) : 1;
    if (step <= 0) {
        return;
    }
    if (step > 1) {
        items.push_back(lost_item(t, OPMS_LOST_REPORTS, 0, report_number_ + 1,
                                  static_cast<std::uint32_t>(step) - 1));
    }
    has_report_number_ = true;
    report_number_ = report_number;
}

void WorldTracker::see_session(std::uint32_t session_id, std::uint32_t before_first)
{
    if (session_id != session_id_) {
        session_id_ = session_id;
        trigger_number_ = session_id == armed_here_ ? 0 : before_first;
        announced_ = trigger_number_;
    }
}

void WorldTracker::miss(std::uint32_t first, std::uint32_t count, std::int64_t t, Items &items,
                        Gaps &gaps)
{
    items.push_back(lost_item(t, OPMS_LOST_TRIGGERS, session_id_, first, count));
    gaps.push_back({boot_id_, session_id_, first, count});
}

void WorldTracker::see_pulse(const opms_trigger_report_t &report, std::int64_t t, Items &items,
                             Gaps &gaps)
{
    see_session(report.session_id, report.trigger_number - 1);
    const std::int32_t step = ahead(report.trigger_number, trigger_number_);
    if (step <= 0) {
        return;
    }
    if (step > 1) {
        miss(trigger_number_ + 1, static_cast<std::uint32_t>(step) - 1, t, items, gaps);
    }
    trigger_number_ = report.trigger_number;
}

/** The last pulses have none after them. An announcement alone proves nothing, for a report may be
 * on its way; that it has not come by the next STATUS does. */
void WorldTracker::see_last(std::uint32_t session_id, std::uint32_t number, bool by_status,
                            std::int64_t t, Items &items, Gaps &gaps)
{
    if (session_id == 0) {
        return;
    }
    see_session(session_id, number);
    const std::int32_t step = ahead(announced_, trigger_number_);
    if (by_status && step > 0) {
        const std::uint32_t first = trigger_number_ + 1;
        trigger_number_ = announced_;
        miss(first, static_cast<std::uint32_t>(step), t, items, gaps);
    }
    if (ahead(number, announced_) > 0) {
        announced_ = number;
    }
}

void WorldTracker::take(const ReportBytes &bytes, std::int64_t t, Items &items, Gaps &gaps)
{
    std::uint8_t id = 0;
    opms_wire_result_t result = opms_wire_check(bytes.data(), bytes.size(), &id);
    opms_box_item_t item = box_item(OPMS_ITEM_MALFORMED, t);
    if (result == OPMS_WIRE_OK && id == OPMS_REPORT_TRIGGER) {
        item.kind = OPMS_ITEM_TRIGGER;
        result = opms_wire_read_trigger(bytes.data(), bytes.size(), &item.as.trigger);
        if (result == OPMS_WIRE_OK) {
            see(item.as.trigger.boot_id, item.as.trigger.report_number, t, items);
            see_pulse(item.as.trigger, t, items, gaps);
        }
    } else if (result == OPMS_WIRE_OK && id == OPMS_REPORT_PONG) {
        item.kind = OPMS_ITEM_PONG;
        opms_pong_report_t &pong = item.as.pong.report;
        result = opms_wire_read_pong(bytes.data(), bytes.size(), &pong);
        const auto ping = pings_.find(pong.ping_id);
        if (result == OPMS_WIRE_OK && ping != pings_.end()) {
            item.as.pong.t_sent_host_ns = ping->second;
            pings_.erase(ping);
        }
        see(pong.boot_id, pong.report_number, t, items);
    } else if (result == OPMS_WIRE_OK && id == OPMS_REPORT_STATUS) {
        item.kind = OPMS_ITEM_STATUS;
        const opms_status_report_t &status = item.as.status;
        result = opms_wire_read_status(bytes.data(), bytes.size(), &item.as.status);
        see(status.boot_id, status.report_number, t, items);
        see_last(status.session_id, status.trigger_number, true, t, items, gaps);
    } else if (result == OPMS_WIRE_OK && id == OPMS_REPORT_EVENT) {
        item.kind = OPMS_ITEM_EVENT;
        const opms_event_report_t &event = item.as.event;
        result = opms_wire_read_event(bytes.data(), bytes.size(), &item.as.event);
        see(event.boot_id, event.report_number, t, items);
        if (event.kind == OPMS_EVENT_STOP) {
            see_last(event.session_id, event.argument, false, t, items, gaps);
        }
    } else if (result == OPMS_WIRE_OK) {
        result = OPMS_WIRE_ID;
    }
    if (result != OPMS_WIRE_OK) {
        item = box_item(OPMS_ITEM_MALFORMED, t);
        item.as.malformed = {result, bytes[0], static_cast<std::uint32_t>(bytes.size())};
    }
    items.push_back(item);
}

}  // namespace opms_host
