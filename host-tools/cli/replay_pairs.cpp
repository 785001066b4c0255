/* SPDX-License-Identifier: Apache-2.0 */
/* Reports, pongs and frames are recorded by separate threads, each with the time of its arrival;
 * that time brings them back into one order. */
#include "replay_pairs.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <variant>

#include <nlohmann/json.hpp>

using namespace opms_host;

namespace {

constexpr std::size_t CHANGES_SHOWN = 100;

using Arrived = std::variant<ClockRecord, BoxReportRecord, TriggerRecord, FrameRecord>;
struct Arrival {
    std::int64_t host_ns = 0;
    Arrived what;
};

using Fates = std::map<std::uint64_t, PairFate>;
using FrameFlags = std::map<std::uint64_t, std::uint32_t>;

struct PairerDeleter {
    void operator()(opms_pairer_t *pairer) const { opms_pairer_destroy(pairer); }
};
using Pairer = std::unique_ptr<opms_pairer_t, PairerDeleter>;

void take_result(const opms_pair_result_t &result, Fates &triggers, Fates &frames)
{
    const bool has_frame = result.frame_state != OPMS_FRAME_NONE;
    const bool has_trigger = result.trigger_state != OPMS_TRIGGER_NONE;
    if (has_frame) {
        frames[result.frame.tag] = {result.frame_state, has_trigger ? result.trigger_number : 0};
    }
    for (std::uint32_t i = 0; has_trigger && i < result.trigger_count; i++) {
        triggers[result.trigger_number + i] = {result.trigger_state,
                                               has_frame ? result.frame.tag : 0};
    }
}

opms_box_time_t box_time(std::int64_t ns)
{
    opms_box_time_t time = {};
    time.us = static_cast<std::uint64_t>(ns) / 1000U;
    time.cycles = static_cast<std::uint8_t>(static_cast<std::uint64_t>(ns) % 1000U / 8U);
    return time;
}

template <typename Record> ScanReader::Each<Record> into(std::vector<Arrival> &arrivals)
{
    return [&arrivals](const Record &record) {
        arrivals.push_back({record.arrival_host_ns, record});
        return true;
    };
}

bool read_arrivals(ScanReader &scan, std::vector<Arrival> &arrivals, std::string &error)
{
    const bool read = scan.each_clock(
                          [&arrivals](const ClockRecord &record) {
                              arrivals.push_back({record.trip.arrived_host_ns, record});
                              return true;
                          },
                          error) &&
                      scan.each_box_report(into<BoxReportRecord>(arrivals), error) &&
                      scan.each_trigger(into<TriggerRecord>(arrivals), error) &&
                      scan.each_frame(into<FrameRecord>(arrivals), error);
    std::stable_sort(arrivals.begin(), arrivals.end(), [](const Arrival &a, const Arrival &b) {
        return a.host_ns < b.host_ns;
    });
    return read;
}

/** One session, from its recording. */
class PairingAgain {
public:
    /** @param frame_flags  As the pairer was told them: it is told less of a preview's frames. */
    PairingAgain(const ScanHeader &header, const FrameFlags &frame_flags)
        : header_(header), frame_flags_(frame_flags)
    {
    }

    bool create(const std::vector<Arrival> &arrivals, std::string &error)
    {
        take_ids(arrivals);
        opms_pair_options_t options;
        opms_pair_options_init(&options);
        options.camera = header_.camera_profile;
        take_wait(options);
        opms_pairer_t *made = nullptr;
        opms_error_t why = {};
        if (opms_pairer_create(&options, &made, &why) != OPMS_OK) {
            error = why.message;
            return false;
        }
        pairer_.reset(made);
        return true;
    }

    bool run(const std::vector<Arrival> &arrivals, std::string &error)
    {
        opms_error_t why = {};
        opms_status_t status = OPMS_OK;
        bool is_open = false;
        for (const Arrival &arrival : arrivals) {
            if (!is_open && arrival.host_ns >= header_.begun_host_ns) {
                status = open(why);
                is_open = true;
            }
            if (status == OPMS_OK) {
                status = take(arrival, why);
            }
            if (status != OPMS_OK) {
                break;
            }
        }
        if (status == OPMS_OK && !is_open) {
            status = open(why);
        }
        if (status == OPMS_OK) {
            status = opms_pairer_close(pairer_.get(), &why);
        }
        poll();
        if (status != OPMS_OK) {
            error = std::string("pairing anew: ") + why.message;
        }
        return status == OPMS_OK;
    }

    /** Without an armed box there is nothing to pair with. */
    bool possible() const { return header_.boot_id != 0 && header_.session_id != 0; }

    void summary(PairReplay &replay) const
    {
        opms_pair_summary_t summary;
        opms_pairer_summary(pairer_.get(), &summary);
        replay.sums_hold = summary.sums_hold != 0;
        replay.line = summary.line;
    }

    Fates triggers, frames;

private:
    /** The header has them since the box was armed; a cut-off one may not. */
    void take_ids(const std::vector<Arrival> &arrivals)
    {
        for (const Arrival &arrival : arrivals) {
            const auto *trigger = std::get_if<TriggerRecord>(&arrival.what);
            if (trigger && (header_.boot_id == 0 || header_.session_id == 0)) {
                header_.boot_id = trigger->report.boot_id;
                header_.session_id = trigger->report.session_id;
            }
        }
    }

    void take_wait(opms_pair_options_t &options) const
    {
        const nlohmann::json settings =
            nlohmann::json::parse(header_.settings_json, nullptr, false);
        const std::uint32_t wait_ms = settings.is_object() ? settings.value("max_wait_ms", 0U) : 0U;
        options.max_wait_ms = wait_ms > 0 ? wait_ms : options.max_wait_ms;
    }

    opms_status_t open(opms_error_t &why)
    {
        return opms_pairer_open(pairer_.get(), header_.boot_id, header_.session_id,
                                &header_.box_settings, &why);
    }

    opms_status_t take(const Arrival &arrival, opms_error_t &why)
    {
        opms_status_t status = opms_pairer_advance(pairer_.get(), arrival.host_ns, &why);
        poll();
        if (status == OPMS_OK) {
            status = std::visit([&](const auto &what) { return push(what, why); }, arrival.what);
        }
        poll();
        return status;
    }

    opms_status_t push(const ClockRecord &record, opms_error_t &why)
    {
        opms_pong_report_t pong = {};
        pong.boot_id = header_.boot_id;
        pong.received = box_time(record.trip.received_box_ns);
        pong.sent = box_time(record.trip.sent_box_ns);
        return opms_pairer_push_pong(pairer_.get(), record.trip.sent_host_ns, &pong,
                                     record.trip.arrived_host_ns, &why);
    }

    opms_status_t push(const BoxReportRecord &record, opms_error_t &why)
    {
        opms_status_report_t status = {};
        opms_event_report_t event = {};
        const std::uint8_t *bytes = record.bytes.data();
        if (opms_wire_read_status(bytes, record.bytes.size(), &status) == OPMS_WIRE_OK) {
            return opms_pairer_push_status(pairer_.get(), &status, &why);
        }
        if (opms_wire_read_event(bytes, record.bytes.size(), &event) == OPMS_WIRE_OK) {
            return opms_pairer_push_event(pairer_.get(), &event, &why);
        }
        return OPMS_OK; /* another kind of report, which pairing has no use for */
    }

    opms_status_t push(const TriggerRecord &record, opms_error_t &why)
    {
        if (!record.from_history) {
            return opms_pairer_push_trigger(pairer_.get(), &record.report,
                                            record.arrival_host_ns, &why);
        }
        const opms_trigger_report_t &from = record.report;
        opms_history_report_t history = {};
        history.boot_id = from.boot_id;
        history.session_id = from.session_id;
        history.count = 1;
        history.entries[0].number = from.trigger_number;
        history.entries[0].flags = from.flags;
        history.entries[0].time = from.time;
        history.entries[0].strobe_delay_cycles = from.strobe_delay_cycles;
        history.entries[0].strobe_length_cycles = from.strobe_length_cycles;
        return opms_pairer_push_history(pairer_.get(), &history, &why);
    }

    opms_status_t push(const FrameRecord &record, opms_error_t &why)
    {
        opms_frame_t frame = {};
        frame.frame_id = record.frame_id;
        frame.camera_time_ticks = record.camera_time_ticks;
        frame.arrival_host_ns = record.arrival_host_ns;
        frame.tag = record.number;
        const auto told = frame_flags_.find(record.number);
        frame.flags = told == frame_flags_.end() ? record.flags : told->second;
        return opms_pairer_push_frame(pairer_.get(), &frame, &why);
    }

    void poll()
    {
        opms_pair_result_t results[16];
        std::uint32_t count = 0;
        do {
            if (opms_pairer_poll(pairer_.get(), results, 16, &count, nullptr) != OPMS_OK) {
                return;
            }
            for (std::uint32_t i = 0; i < count; i++) {
                take_result(results[i], triggers, frames);
            }
        } while (count > 0);
    }

    ScanHeader header_;
    const FrameFlags &frame_flags_;
    Pairer pairer_;
};

/** All numbers of both, each once. @return How many differ. */
std::uint64_t compare(const Fates &recorded, const Fates &again, bool of_frame, PairReplay &replay)
{
    Fates all = recorded;
    all.insert(again.begin(), again.end());
    std::uint64_t changed = 0;
    for (const auto &entry : all) {
        const auto before = recorded.find(entry.first), after = again.find(entry.first);
        PairChange change{of_frame, entry.first, {}, {}};
        change.recorded = before == recorded.end() ? PairFate() : before->second;
        change.again = after == again.end() ? PairFate() : after->second;
        if (change.recorded.state != change.again.state ||
            change.recorded.partner != change.again.partner) {
            changed++;
            if (replay.changes.size() < CHANGES_SHOWN) {
                replay.changes.push_back(change);
            }
        }
    }
    return changed;
}

}  // namespace

bool replay_pairs(ScanReader &scan, PairReplay &replay, std::string &error)
{
    Fates triggers, frames;
    FrameFlags flags;
    std::vector<Arrival> arrivals;
    if (!scan.each_pair(
            [&](const PairRecord &pair) {
                take_result(pair.result, triggers, frames);
                if (pair.result.frame_state != OPMS_FRAME_NONE) {
                    flags[pair.result.frame.tag] = pair.result.frame.flags;
                }
                return true;
            },
            error) ||
        !read_arrivals(scan, arrivals, error)) {
        return false;
    }
    PairingAgain again(scan.summary().header, flags);
    if (!again.create(arrivals, error)) {
        return false;
    }
    replay.possible = again.possible();
    if (!replay.possible) {
        return true;
    }
    if (!again.run(arrivals, error)) {
        return false;
    }
    again.summary(replay);
    replay.triggers = again.triggers.size();
    replay.frames = again.frames.size();
    replay.triggers_changed = compare(triggers, again.triggers, false, replay);
    replay.frames_changed = compare(frames, again.frames, true, replay);
    return true;
}
