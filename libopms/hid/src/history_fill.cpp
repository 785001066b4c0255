/* SPDX-License-Identifier: Apache-2.0 */
#include "history_fill.hpp"

#include <algorithm>
#include <random>

namespace opms_hid {

namespace {

constexpr size_t GAPS_MAX = 256;
constexpr int FAILURES_MAX = 5; /* one after the other */

} // namespace

HistoryReader::HistoryReader(uint32_t session_id, uint32_t first, uint32_t count, uint16_t token)
    : session_id_(session_id), next_(first), left_(count), token_(token)
{
}

Io HistoryReader::select(BoxTransport &transport)
{
    const uint32_t count = std::min<uint32_t>(left_, OPMS_BOX_HISTORY_ENTRIES);
    const opms_history_request_t request = {token_, session_id_, next_,
                                            static_cast<uint16_t>(count)};
    Report report;
    opms_wire_write_history_request(&request, report.data());
    return transport.set_feature(report);
}

Io HistoryReader::step(BoxTransport &transport, std::vector<opms_history_entry_t> &entries,
                       uint32_t &boot_id)
{
    if (!selected_) {
        const Io io = select(transport);
        selected_ = io == Io::done;
        return io;
    }
    Report bytes;
    size_t size = 0;
    const Io io = transport.get_feature(OPMS_REPORT_HISTORY, bytes, size);
    opms_history_report_t report;
    if (io != Io::done || opms_wire_read_history(bytes.data(), size, &report) != OPMS_WIRE_OK) {
        selected_ = false; /* what was in that answer is gone: select again from there */
        return io == Io::done ? Io::stalled : io;
    }
    boot_id = report.boot_id;
    return take(report, entries);
}

Io HistoryReader::take(const opms_history_report_t &report,
                       std::vector<opms_history_entry_t> &entries)
{
    const bool is_ours = report.token == token_ && report.count > 0 &&
                         report.entries[0].number == next_ && report.count <= left_;
    if (!is_ours) {
        selected_ = false;
        return Io::stalled;
    }
    entries.insert(entries.end(), report.entries, report.entries + report.count);
    next_ += report.count;
    left_ -= report.count;
    selected_ = selected_ && report.remaining > 0;
    return Io::done;
}

void HistoryFill::add(const Gap &gap)
{
    if (token_ == 0) { /* another program may have the box open, too */
        token_ = static_cast<uint16_t>(std::random_device{}() | 1U);
    }
    Gap held = gap;
    if (held.count > OPMS_BOX_HISTORY_ENTRIES) {
        const uint32_t too_old = held.count - OPMS_BOX_HISTORY_ENTRIES;
        given_up_.push_back({held.boot_id, held.session_id, held.first, too_old});
        held.first += too_old;
        held.count -= too_old;
    }
    if (gaps_.size() >= GAPS_MAX) {
        given_up_.push_back(held);
        return;
    }
    token_ = static_cast<uint16_t>(token_ + 2U); /* odd, so never 0 */
    gaps_.push_back({held, HistoryReader(held.session_id, held.first, held.count, token_), 0});
}

void HistoryFill::disconnected()
{
    for (Job &job : gaps_) {
        job.reader.select_again();
    }
}

void HistoryFill::give_up(const Gap &gap, Result &result)
{
    opms_box_item_t item = {};
    item.kind = OPMS_ITEM_LOST;
    item.t_host_ns = host_now_ns();
    item.as.lost = {OPMS_LOST_UNFILLED, gap.session_id, gap.first, gap.count};
    result.items.push_back(item);
    result.unfilled += gap.count;
}

void HistoryFill::take(const std::vector<opms_history_entry_t> &entries, uint32_t boot_id,
                       Result &result)
{
    for (const opms_history_entry_t &entry : entries) {
        opms_box_item_t item = {};
        item.kind = OPMS_ITEM_HISTORY;
        item.t_host_ns = host_now_ns();
        item.as.history = {boot_id, gaps_.front().gap.session_id, entry};
        result.items.push_back(item);
        ++(entry.flags & OPMS_TRIGGER_NOT_HELD ? result.unfilled : result.filled);
    }
}

void HistoryFill::step(BoxTransport &transport, Result &result)
{
    result.items.clear();
    result.filled = result.unfilled = 0;
    result.failed = false;
    for (const Gap &gap : given_up_) {
        give_up(gap, result);
    }
    given_up_.clear();
    if (gaps_.empty()) {
        return;
    }
    Job &job = gaps_.front();
    uint32_t boot_id = job.gap.boot_id;
    entries_.clear();
    const Io io = job.reader.step(transport, entries_, boot_id);
    const bool rebooted = boot_id != job.gap.boot_id;
    if (io == Io::gone) {
        result.failed = true; /* it will be asked again when it is back */
        job.reader.select_again();
        return;
    }
    job.failures = io == Io::done ? 0 : job.failures + 1;
    result.failed = io != Io::done;
    if (!rebooted) {
        take(entries_, boot_id, result);
    }
    if (rebooted || job.failures >= FAILURES_MAX) {
        const auto unused = rebooted ? static_cast<uint32_t>(entries_.size()) : 0U;
        const uint32_t left = job.reader.left() + unused;
        give_up({job.gap.boot_id, job.gap.session_id, job.gap.first + job.gap.count - left, left},
                result);
        gaps_.pop_front();
    } else if (job.reader.is_done()) {
        gaps_.pop_front();
    }
}

} // namespace opms_hid
