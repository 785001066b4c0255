/* SPDX-License-Identifier: Apache-2.0 */
#include "recorded_items.hpp"

#include <algorithm>

namespace opms_host {
namespace {

opms_box_item_t item_of(opms_item_kind_t kind, std::int64_t t_host_ns)
{
    opms_box_item_t item = {};
    item.kind = kind;
    item.t_host_ns = t_host_ns;
    return item;
}

opms_box_item_t trigger_item(const TriggerRecord &record)
{
    if (!record.from_history) {
        opms_box_item_t item = item_of(OPMS_ITEM_TRIGGER, record.arrival_host_ns);
        item.as.trigger = record.report;
        return item;
    }
    opms_box_item_t item = item_of(OPMS_ITEM_HISTORY, record.arrival_host_ns);
    item.as.history.boot_id = record.report.boot_id;
    item.as.history.session_id = record.report.session_id;
    item.as.history.entry.number = record.report.trigger_number;
    item.as.history.entry.flags = record.report.flags;
    item.as.history.entry.time = record.report.time;
    item.as.history.entry.strobe_delay_cycles = record.report.strobe_delay_cycles;
    item.as.history.entry.strobe_length_cycles = record.report.strobe_length_cycles;
    return item;
}

opms_box_time_t box_time(std::int64_t ns)
{
    return {static_cast<std::uint64_t>(ns / 1000), static_cast<std::uint8_t>(ns % 1000 / 8)};
}

opms_box_item_t pong_item(const ClockRecord &record, std::uint32_t boot_id)
{
    opms_box_item_t item = item_of(OPMS_ITEM_PONG, record.trip.arrived_host_ns);
    item.as.pong.t_sent_host_ns = record.trip.sent_host_ns;
    item.as.pong.report.boot_id = boot_id;
    item.as.pong.report.received = box_time(record.trip.received_box_ns);
    item.as.pong.report.sent = box_time(record.trip.sent_box_ns);
    return item;
}

bool report_item(const BoxReportRecord &record, opms_box_item_t &item)
{
    item = item_of(OPMS_ITEM_STATUS, record.arrival_host_ns);
    if (opms_wire_read_status(record.bytes.data(), record.bytes.size(), &item.as.status) ==
        OPMS_WIRE_OK) {
        return true;
    }
    item = item_of(OPMS_ITEM_EVENT, record.arrival_host_ns);
    return opms_wire_read_event(record.bytes.data(), record.bytes.size(), &item.as.event) ==
           OPMS_WIRE_OK;
}

}  // namespace

bool recorded_items(ScanReader &reader, std::vector<opms_box_item_t> &items, std::string &error)
{
    const std::uint32_t boot_id = reader.summary().header.boot_id;
    const bool good =
        reader.each_trigger(
            [&items](const TriggerRecord &record) {
                items.push_back(trigger_item(record));
                return true;
            },
            error) &&
        reader.each_clock(
            [&items, boot_id](const ClockRecord &record) {
                items.push_back(pong_item(record, boot_id));
                return true;
            },
            error) &&
        reader.each_box_report(
            [&items](const BoxReportRecord &record) {
                opms_box_item_t item = {};
                if (report_item(record, item)) {
                    items.push_back(item);
                }
                return true;
            },
            error);
    std::stable_sort(items.begin(), items.end(),
                     [](const opms_box_item_t &a, const opms_box_item_t &b) {
                         return a.t_host_ns < b.t_host_ns;
                     });
    return good;
}

std::uint32_t *item_session(opms_box_item_t &item)
{
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER: return &item.as.trigger.session_id;
    case OPMS_ITEM_HISTORY: return &item.as.history.session_id;
    case OPMS_ITEM_STATUS: return &item.as.status.session_id;
    case OPMS_ITEM_EVENT: return &item.as.event.session_id;
    default: return nullptr;
    }
}

}  // namespace opms_host
