/* SPDX-License-Identifier: Apache-2.0 */
#include "pairing.hpp"

#include <array>
#include <cstdio>
#include <cstring>

namespace opms_host {
namespace {

constexpr std::size_t ROUND_TRIPS = 31; /* as many as a clock remembers */
/* docs/pairing.md: beyond it arrivals are no witness. */
constexpr std::int64_t CLOCK_BOUND_NS = 1'500'000;
/* By so many the preamble is over, and later ones hardly help. */
constexpr std::uint64_t MANY_FRAMES = 30;

opms_history_report_t history_report(const opms_history_item_t &item)
{
    opms_history_report_t report{};
    report.token = 1;
    report.boot_id = item.boot_id;
    report.session_id = item.session_id;
    report.count = 1;
    report.entries[0] = item.entry;
    return report;
}

bool same(const opms_camera_profile_t &a, const opms_camera_profile_t &b)
{
    return a.has_frame_id == b.has_frame_id && a.frame_id_bits == b.frame_id_bits &&
           a.frame_id_skips_0 == b.frame_id_skips_0 && a.has_camera_time == b.has_camera_time &&
           a.camera_time_bits == b.camera_time_bits && a.has_strobe == b.has_strobe &&
           a.camera_tick_hz == b.camera_tick_hz && a.has_start_delay == b.has_start_delay &&
           a.has_exposure == b.has_exposure && a.start_delay_ns == b.start_delay_ns &&
           a.exposure_ns == b.exposure_ns;
}

/** All counters are of one type, and count up. */
opms_pair_counters_t since(const opms_pair_counters_t &now, const opms_pair_counters_t &then)
{
    constexpr std::size_t COUNT = sizeof(opms_pair_counters_t) / sizeof(std::uint64_t);
    static_assert(COUNT * sizeof(std::uint64_t) == sizeof(opms_pair_counters_t));
    std::array<std::uint64_t, COUNT> a, b;
    std::memcpy(a.data(), &now, sizeof now);
    std::memcpy(b.data(), &then, sizeof then);
    for (std::size_t i = 0; i < COUNT; ++i) {
        a[i] -= b[i];
    }
    opms_pair_counters_t difference;
    std::memcpy(&difference, a.data(), sizeof difference);
    return difference;
}

std::string count_text(std::uint64_t count, const char *what)
{
    return std::to_string(count) + " " + what;
}

}  // namespace

bool Pairing::fit(const opms_camera_profile_t &profile, std::string &error)
{
    if (pairer_ && same(profile, profile_)) {
        return true;
    }
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera = profile;
    if (max_wait_ms_ > 0) {
        options.max_wait_ms = max_wait_ms_;
    }
    opms_pairer_t *pairer = nullptr;
    opms_error_t why{};
    if (opms_pairer_create(&options, &pairer, &why) != OPMS_OK) {
        error = std::string("pairing: ") + why.message;
        return false;
    }
    pairer_.reset(pairer);
    profile_ = profile;
    at_open_ = {};
    for (const ClockRecord &record : round_trips_) {
        push_round_trip(record);
    }
    return true;
}

bool Pairing::open(std::uint32_t boot_id, std::uint32_t session_id,
                   const opms_settings_t &settings, std::string &error)
{
    opms_error_t why{};
    opms_pair_summary_t before;
    opms_pairer_summary(pairer_.get(), &before);
    if (opms_pairer_open(pairer_.get(), boot_id, session_id, &settings, &why) != OPMS_OK) {
        error = std::string("pairing: ") + why.message;
        return false;
    }
    is_open_ = true;
    at_open_ = before.counters;
    told_ = {};
    told_state_ = OPMS_PAIR_SEARCHING;
    told_not_locked_ = false;
    return true;
}

bool Pairing::close(std::string &error)
{
    opms_error_t why{};
    is_open_ = false;
    if (opms_pairer_close(pairer_.get(), &why) != OPMS_OK) {
        error = why.message;
        return false;
    }
    return true;
}

void Pairing::push_round_trip(const ClockRecord &record)
{
    opms_pong_report_t pong{};
    const auto time = [](std::int64_t ns) {
        return opms_box_time_t{static_cast<std::uint64_t>(ns / 1000),
                               static_cast<std::uint8_t>(ns % 1000 / 8)};
    };
    pong.boot_id = boot_id_;
    pong.received = time(record.trip.received_box_ns);
    pong.sent = time(record.trip.sent_box_ns);
    opms_pairer_push_pong(pairer_.get(), record.trip.sent_host_ns, &pong,
                          record.trip.arrived_host_ns, nullptr);
}

bool Pairing::note_round_trip(const opms_box_item_t &item, std::int64_t wall_ns)
{
    if (item.kind != OPMS_ITEM_PONG || item.as.pong.t_sent_host_ns == 0) {
        return false;
    }
    const opms_pong_report_t &pong = item.as.pong.report;
    if (pong.boot_id != boot_id_) {
        boot_id_ = pong.boot_id;
        round_trips_.clear();
    }
    if (round_trips_.size() == ROUND_TRIPS) {
        round_trips_.pop_front();
    }
    ClockRecord record;
    record.trip = {item.as.pong.t_sent_host_ns, opms_box_time_ns(pong.received),
                   opms_box_time_ns(pong.sent), item.t_host_ns};
    record.wall_ns = wall_ns;
    round_trips_.push_back(record);
    return true;
}

void Pairing::take(const opms_box_item_t &item)
{
    if (!pairer_) {
        return;
    }
    opms_pairer_t *pairer = pairer_.get();
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER:
        opms_pairer_push_trigger(pairer, &item.as.trigger, item.t_host_ns, nullptr);
        break;
    case OPMS_ITEM_PONG:
        if (item.as.pong.t_sent_host_ns != 0) {
            opms_pairer_push_pong(pairer, item.as.pong.t_sent_host_ns, &item.as.pong.report,
                                  item.t_host_ns, nullptr);
        }
        break;
    case OPMS_ITEM_STATUS: opms_pairer_push_status(pairer, &item.as.status, nullptr); break;
    case OPMS_ITEM_EVENT: opms_pairer_push_event(pairer, &item.as.event, nullptr); break;
    case OPMS_ITEM_HISTORY: {
        const opms_history_report_t report = history_report(item.as.history);
        opms_pairer_push_history(pairer, &report, nullptr);
        break;
    }
    default: break;
    }
}

void Pairing::take(const opms_frame_t &frame)
{
    opms_pairer_push_frame(pairer_.get(), &frame, nullptr);
}

void Pairing::advance(std::int64_t now_host_ns)
{
    if (pairer_) {
        opms_pairer_advance(pairer_.get(), now_host_ns, nullptr);
    }
}

void Pairing::poll(const TakeResult &take)
{
    std::uint32_t count = 1;
    std::array<opms_pair_result_t, 16> results;
    while (pairer_ && count > 0) {
        opms_pairer_poll(pairer_.get(), results.data(), results.size(), &count, nullptr);
        for (std::uint32_t i = 0; i < count; ++i) {
            take(results[i]);
        }
    }
}

void Pairing::news(std::int64_t now_host_ns, bool all, const TakeEvent &tell)
{
    const opms_pair_summary_t now = summary();
    const auto say = [&](Severity severity, const char *code, std::string text) {
        EventRecord event;
        event.t_host_ns = now_host_ns;
        event.severity = severity;
        event.code = code;
        event.text = std::move(text);
        tell(event);
    };
    if (now.state != told_state_) {
        told_state_ = now.state;
        if (now.state == OPMS_PAIR_LOCKED) {
            say(Severity::info, "pair.locked", "pulses and pictures are paired");
        } else if (now.state == OPMS_PAIR_SUSPECT) {
            say(Severity::warning, "pair.suspect",
                "a picture contradicts the pairing: nothing is paired until it is clear again");
        }
    }
    if (now.state == OPMS_PAIR_SEARCHING && now.counters.frames > MANY_FRAMES &&
        !told_not_locked_) {
        told_not_locked_ = true;
        say(Severity::error, "pair.not_locked",
            "pictures come and their pulses are not known: stop, and start again");
    }
    if (!all && now_host_ns - told_host_ns_ < 1'000'000'000) {
        return;
    }
    told_host_ns_ = now_host_ns;
    const opms_pair_counters_t change = since(now.counters, told_);
    told_ = now.counters;
    if (change.triggers_missing > 0) {
        say(Severity::warning, "pair.missing",
            count_text(change.triggers_missing, "pulse(s) without a picture"));
    }
    if (change.triggers_uncertain > 0) {
        say(Severity::warning, "pair.uncertain",
            count_text(change.triggers_uncertain, "pulse(s) whose picture is not certain"));
    }
    if (change.camera_restarts > 0) {
        say(Severity::warning, "pair.camera_restarted", "the camera counts from the beginning");
    }
}

opms_pair_summary_t Pairing::summary() const
{
    opms_pair_summary_t summary{};
    if (!pairer_) {
        return summary;
    }
    opms_pairer_summary(pairer_.get(), &summary);
    summary.counters = since(summary.counters, at_open_);
    const opms_pair_counters_t &c = summary.counters;
    const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
    std::snprintf(summary.line, sizeof summary.line,
                  "%s: %llu triggers: %llu paired, %llu missing, %llu uncertain; %llu frames",
                  opms_pair_state_name(summary.state), n(c.triggers), n(c.triggers_paired),
                  n(c.triggers_missing), n(c.triggers_uncertain), n(c.frames));
    return summary;
}

bool Pairing::is_clock_known(std::uint32_t boot_id) const
{
    opms_clock_fit_t fit{};
    if (clock() && boot_id == boot_id_) {
        opms_clock_get(clock(), &fit);
    }
    return fit.state == OPMS_CLOCK_FITTED && fit.bound_ns <= CLOCK_BOUND_NS;
}

const opms_clock_t *Pairing::clock() const
{
    return pairer_ ? opms_pairer_clock(pairer_.get()) : nullptr;
}

}  // namespace opms_host
