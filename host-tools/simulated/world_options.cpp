/* SPDX-License-Identifier: Apache-2.0 */
#include "world_options.hpp"

#include <cmath>

namespace opms_host {

const char *fault_name(Fault fault)
{
    static constexpr std::array<const char *, FAULT_KINDS> NAMES = {
        "report_lost", "report_late", "report_repeated", "report_overtaken", "report_damaged",
        "history_lost", "strobe_unseen", "trigger_ignored", "frame_extra", "id_skip", "id_reset",
        "frame_lost", "frame_late", "frame_repeated", "frame_stale", "frame_damaged", "ping_held"};
    return NAMES[static_cast<std::size_t>(fault)];
}

const char *mishap_name(Mishap mishap)
{
    static constexpr std::array<const char *, MISHAP_KINDS> NAMES = {
        "box_unplug", "box_reboot", "camera_restart", "host_stall", "hidden", "glitch"};
    return NAMES[static_cast<std::size_t>(mishap)];
}

FaultRates FaultRates::some()
{
    FaultRates rates;
    rates[Fault::report_lost] = 0.005;
    rates[Fault::report_late] = 0.003;
    rates[Fault::report_repeated] = 0.003;
    rates[Fault::report_overtaken] = 0.003;
    rates[Fault::report_damaged] = 0.0005;
    rates[Fault::history_lost] = 0.01;
    rates[Fault::strobe_unseen] = 0.001;
    rates[Fault::trigger_ignored] = 0.001;
    rates[Fault::frame_extra] = 0.0005;
    rates[Fault::id_skip] = 0.0005;
    rates[Fault::frame_lost] = 0.005;
    rates[Fault::frame_late] = 0.003;
    rates[Fault::frame_repeated] = 0.002;
    rates[Fault::frame_stale] = 0.0005;
    rates[Fault::frame_damaged] = 0.001;
    rates[Fault::ping_held] = 0.02;
    rates[Mishap::box_unplug] = 120;
    rates[Mishap::camera_restart] = 150;
    rates[Mishap::host_stall] = 60;
    rates[Mishap::hide_bar] = 60;
    rates[Mishap::glitch] = 90;
    rates.extra_first_frame = true;
    return rates;
}

FaultRates FaultRates::many()
{
    FaultRates rates = some();
    for (double &share : rates.share) {
        share *= 4;
    }
    rates[Fault::id_reset] = 0.001;
    rates[Mishap::box_unplug] = 40;
    rates[Mishap::box_reboot] = 200;
    rates[Mishap::camera_restart] = 50;
    rates[Mishap::host_stall] = 20;
    rates[Mishap::hide_bar] = 20;
    rates[Mishap::glitch] = 30;
    return rates;
}

namespace {

std::string range_problem(const char *name, double value, double low, double high)
{
    if (value >= low && value <= high) {
        return {};
    }
    return std::string(name) + " must be " + std::to_string(low) + " to " + std::to_string(high);
}

std::string fault_problem(const FaultRates &rates)
{
    for (std::size_t i = 0; i < FAULT_KINDS; ++i) {
        if (!(rates.share[i] >= 0 && rates.share[i] <= 0.5)) {
            return std::string(fault_name(static_cast<Fault>(i))) + " must be 0 to 0.5";
        }
    }
    for (std::size_t i = 0; i < MISHAP_KINDS; ++i) {
        if (!(rates.mean_interval_s[i] >= 0)) {
            return std::string(mishap_name(static_cast<Mishap>(i))) + " must be 0 s or more";
        }
    }
    return {};
}

}  // namespace

std::string world_options_problem(const WorldOptions &o)
{
    struct Range {
        const char *name;
        double value, low, high;
    };
    const Range ranges[] = {
        {"speed", o.speed, 0, 10000},
        {"box_drift_ppm", o.box_drift_ppm, -300, 300},
        {"ping_interval_ms", static_cast<double>(o.ping_interval_ms), 10, 60000},
        {"start_after", o.start_after_s, 0, 3600},
        {"period_us", o.period_us ? static_cast<double>(o.period_us) : 10000.0, 10000, 10000000},
        {"camera_drift_ppm", o.camera_drift_ppm, -300, 300},
        {"camera_tick_hz", static_cast<double>(o.camera_tick_hz), 1000, 1e10},
        {"start_delay_us", o.start_delay_us, 0, 5000},
        {"readout_ms", o.readout_ms, 0, 1000},
        {"transport_jitter_ms", o.transport_jitter_ms, 0, 50},
        {"exposure_us", o.exposure_us, EXPOSURE_MIN_US, EXPOSURE_MAX_US},
        {"gain_db", o.gain_db, 0, GAIN_MAX_DB},
        {"exposure_delay_frames", static_cast<double>(o.exposure_delay_frames), 0, 20},
        {"frames", static_cast<double>(o.frames), 1, 20000},
        {"path_period", o.path_period_s, 0, 10},
        {"max_speed", o.max_speed_m_s, 0, 3},
        {"tilt", o.bar_tilt_deg, -45, 45},
        {"noise", o.noise, 0, 30},
        {"white", o.white, 1, 250},
        {"black", o.black, 0, 250},
        {"clouds", o.clouds_ev, 0, 6},
        {"sensor_hz", o.sensor_hz, 0.1, 10000},
        {"sensor_noise", o.sensor_noise, 0, 1000}};
    for (const Range &range : ranges) {
        const std::string problem = range_problem(range.name, range.value, range.low, range.high);
        if (!problem.empty()) {
            return problem;
        }
    }
    if (o.frame_id_bits != 16 && o.frame_id_bits != 64) {
        return "id_bits must be 16 or 64";
    }
    if (o.first_frame_id == 0 || (o.frame_id_bits == 16 && o.first_frame_id > 65535)) {
        return "first_id must be 1 to 65535 with 16 bits, and not 0";
    }
    if (o.bar != "hope33" && o.bar != "apriltag33") {
        return "bar must be hope33 or apriltag33";
    }
    return fault_problem(o.faults);
}

}  // namespace opms_host
