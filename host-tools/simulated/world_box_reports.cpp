/* SPDX-License-Identifier: Apache-2.0 */
/* What the simulated box remembers of its pulses, and what it reports. */
#include "world_box.hpp"

#include <algorithm>

namespace opms_host {

namespace {

constexpr std::uint32_t TRIGGERS_IN_ROW = 8;
constexpr std::int64_t PROMPT_CYCLES = 2 * 125000;
constexpr std::uint32_t GAP_MAX_US = 0xFFFFFF;
constexpr unsigned STROBE_FLAGS = OPMS_TRIGGER_STROBE | OPMS_TRIGGER_STROBE_MISSING;

}  // namespace

const BoxPulse *WorldBox::find(std::uint32_t number) const
{
    if (memory_.empty() || number < memory_.front().number || number > memory_.back().number) {
        return nullptr;
    }
    return &memory_[number - memory_.front().number];
}

BoxPulse *WorldBox::find(std::uint32_t number)
{
    return const_cast<BoxPulse *>(static_cast<const WorldBox *>(this)->find(number));
}

void WorldBox::strobe(std::int64_t from_true_ns, std::int64_t to_true_ns)
{
    if (!is_on_ || !settings_.strobe_enabled) {
        return;
    }
    const std::int64_t rise = clock_.cycles(from_true_ns);
    const auto after = std::upper_bound(
        memory_.begin(), memory_.end(), rise,
        [](std::int64_t cycles, const BoxPulse &pulse) { return cycles < pulse.cycles; });
    if (after == memory_.begin()) {
        return;
    }
    BoxPulse &pulse = *std::prev(after);
    if (pulse.number <= strobe_checked_) {
        return;  // it has its exposure, or has been told to have none
    }
    pulse.strobe_delay_cycles = static_cast<std::uint32_t>(rise - pulse.cycles);
    pulse.strobe_length_cycles = static_cast<std::uint32_t>(clock_.cycles(to_true_ns) - rise);
    pulse.flags |= OPMS_TRIGGER_STROBE;
    strobe_number_ = pulse.number;
    check_strobes(pulse.number + 2);
}

/** An exposure may last until the pulse after its own: it is overdue at the one after that. */
void WorldBox::check_strobes(std::uint32_t newest)
{
    if (!settings_.strobe_enabled) {
        return;
    }
    for (; strobe_checked_ + 2 < newest; ++strobe_checked_) {
        BoxPulse *const pulse = find(strobe_checked_ + 1);
        if (pulse && !(pulse->flags & OPMS_TRIGGER_STROBE)) {
            pulse->flags |= OPMS_TRIGGER_STROBE_MISSING;
            ++strobes_missing_;
            strobe_missing_news_ = true;
            push_event(OPMS_EVENT_STROBE_MISSING, clock_.cycles(agenda_.now_ns()), pulse->number);
        }
    }
}

std::uint32_t WorldBox::gap_us(std::uint32_t number, std::uint32_t back) const
{
    const BoxPulse *const later = find(number - back), *const earlier = find(number - back - 1);
    if (!later || !earlier) {
        return 0;
    }
    const std::int64_t gap = later->cycles / OPMS_BOX_CYCLES_PER_US -
                             earlier->cycles / OPMS_BOX_CYCLES_PER_US;
    return gap <= GAP_MAX_US ? static_cast<std::uint32_t>(gap) : 0;
}

bool WorldBox::others_wait() const
{
    return !pongs_.empty() || !events_.empty() || status_due_;
}

bool WorldBox::has_report() const
{
    return is_on_ && (reported_ != last_number_ || others_wait());
}

ReportBytes WorldBox::next_report()
{
    const bool others = others_wait();
    if (reported_ != last_number_ && !(others && triggers_in_row_ >= TRIGGERS_IN_ROW)) {
        triggers_in_row_ = others ? triggers_in_row_ + 1 : 0;
        return write_trigger();
    }
    triggers_in_row_ = 0;
    return write_other();
}

ReportBytes WorldBox::write_trigger()
{
    const BoxPulse &pulse = *find(++reported_);
    opms_trigger_report_t report = {};
    report.flags = static_cast<std::uint16_t>(pulse.flags & ~STROBE_FLAGS);
    report.boot_id = boot_id_;
    report.session_id = session_id_;
    report.report_number = ++report_number_;
    report.trigger_number = pulse.number;
    report.time = box_time_of(pulse.cycles);
    if (pulse.flags & OPMS_TRIGGER_RUN) {
        report.start_edge = box_time_of(start_edge_cycles_);
        report.first_run_number = first_run_number_;
    }
    if (clock_.cycles(agenda_.now_ns()) - pulse.cycles > PROMPT_CYCLES) {
        report.flags |= OPMS_TRIGGER_DELAYED;
    }
    if (strobe_missing_news_) {
        report.flags |= OPMS_TRIGGER_STROBE_MISSING;
        strobe_missing_news_ = false;
    }
    if (const BoxPulse *const exposed = strobe_number_ ? find(strobe_number_) : nullptr) {
        report.flags |= OPMS_TRIGGER_STROBE;
        report.strobe_for_trigger = exposed->number;
        report.strobe_delay_cycles = exposed->strobe_delay_cycles;
        report.strobe_length_cycles = exposed->strobe_length_cycles;
    }
    report.gap_us[0] = gap_us(pulse.number, 0);
    report.gap_us[1] = gap_us(pulse.number, 1);
    report.dropped = static_cast<std::uint16_t>(std::min<std::uint32_t>(dropped_, 65535));
    ReportBytes bytes;
    opms_wire_write_trigger(&report, bytes.data());
    return bytes;
}

ReportBytes WorldBox::write_other()
{
    ReportBytes bytes;
    if (!pongs_.empty()) {
        opms_pong_report_t pong = {boot_id_, ++report_number_, pongs_.front().id,
                                   box_time_of(pongs_.front().received_cycles),
                                   box_time_of(clock_.cycles(agenda_.now_ns()))};
        pongs_.pop_front();
        opms_wire_write_pong(&pong, bytes.data());
    } else if (!events_.empty()) {
        events_.front().report_number = ++report_number_;
        opms_wire_write_event(&events_.front(), bytes.data());
        events_.pop_front();
    } else {
        bytes = write_status();
    }
    return bytes;
}

ReportBytes WorldBox::write_status()
{
    opms_status_report_t status = {};
    status.state = state_;
    status.reset_cause = reset_cause_;
    status.boot_id = boot_id_;
    status.session_id = session_id_;
    status.report_number = ++report_number_;
    status.uptime_us = box_time_of(clock_.cycles(agenda_.now_ns())).us;
    status.trigger_number = last_number_;
    status.first_run_number = first_run_number_;
    status.glitches = glitches_;
    status.starts_refused = starts_refused_;
    status.strobes_missing = strobes_missing_;
    status.dropped = dropped_;
    status.commands_refused = commands_refused_;
    status.settings_crc = opms_wire_settings_crc(&settings_);
    status_due_ = false;
    ReportBytes bytes;
    opms_wire_write_status(&status, bytes.data());
    return bytes;
}

opms_history_entry_t WorldBox::history(std::uint32_t session_id, std::uint32_t number) const
{
    opms_history_entry_t entry = {};
    entry.number = number;
    entry.flags = OPMS_TRIGGER_NOT_HELD;
    const BoxPulse *const pulse = session_id == session_id_ ? find(number) : nullptr;
    if (pulse) {
        entry.flags = pulse->flags;
        entry.time = box_time_of(pulse->cycles);
        entry.strobe_delay_cycles = pulse->strobe_delay_cycles;
        entry.strobe_length_cycles = pulse->strobe_length_cycles;
    }
    return entry;
}

}  // namespace opms_host
