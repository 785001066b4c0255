/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that need no pulse: who the box is, how it is, its settings, its clock. */
#include <cmath>

#include "box_json.hpp"
#include "box_selftest.hpp"

namespace {

using std::chrono::milliseconds;

constexpr milliseconds STATUS_PATIENCE(3000); /* it comes once a second */
constexpr unsigned PINGS = 40;
constexpr milliseconds PONG_PATIENCE(1000), PING_PAUSE(20);
constexpr int64_t RESIDUAL_MAX_NS = 2'000'000;
constexpr double DRIFT_MAX_PPM = 200; /* two quartz clocks differ by less */

} // namespace

void Selftest::check_identity()
{
    const opms_identity_report_t identity = device_.identity();
    const std::string what = "firmware " + box_firmware_text(identity) +
                             box_text(", hardware %u, protocol %d", identity.hardware_version,
                                      OPMS_WIRE_PROTOCOL);
    if (identity.clock_hz != OPMS_BOX_CLOCK_HZ ||
        identity.start_cycles != OPMS_BOX_START_CYCLES) {
        fail("identity", what + box_text(": clock %u Hz and %u cycles from START to pulse, should "
                                         "be %d and %d: flash the firmware of this version",
                                         identity.clock_hz, identity.start_cycles,
                                         OPMS_BOX_CLOCK_HZ, OPMS_BOX_START_CYCLES));
    } else {
        pass("identity", box_id_text(identity) + ", " + what);
    }
}

bool Selftest::check_status()
{
    if (!record_.pump(STATUS_PATIENCE, [this] { return record_.statuses() > 0; })) {
        fail("status", "no STATUS came in 3 s, where one is due each second: the reports do not "
                       "get through; try another USB port and no hub");
        return false;
    }
    const opms_status_report_t &status = record_.status();
    std::string text = box_text("up for %.1f s since %s",
                                static_cast<double>(status.uptime_us) / 1e6,
                                box_reset_text(status.reset_cause));
    if (status.reset_cause == OPMS_RESET_WATCHDOG) {
        text += ": its program had hung; please report that";
    }
    pass("status", text);
    return true;
}

bool Selftest::check_idle()
{
    const opms_box_state_t state = record_.status().state;
    if (state != OPMS_BOX_IDLE && options_.stop) {
        opms_error_t error = {};
        return called("idle", opms_box_disarm(device_.get(), 0, &error), error);
    }
    if (state != OPMS_BOX_IDLE) {
        fail("idle", std::string("the box is ") + opms_box_state_name(state) +
                         ": another program uses it, or left it so; --stop stops it first");
        return false;
    }
    return true;
}

bool Selftest::check_settings()
{
    opms_error_t error = {};
    opms_settings_report_t report = {};
    if (!called("settings", opms_box_get_settings(device_.get(), 0, &report, &error), error)) {
        return false;
    }
    settings_ = report.settings;
    if (report.settings_crc != record_.status().settings_crc) {
        fail("settings", box_text("their CRC is %04x, STATUS says %04x", report.settings_crc,
                                  record_.status().settings_crc));
        return true;
    }
    const bool stored = report.stored;
    if (!called("settings", opms_box_set_settings(device_.get(), &settings_, 0, &report, &error),
                error)) {
        return true;
    }
    pass("settings", box_text("CRC %04x, written and read back%s", report.settings_crc,
                              stored ? "" : " (the flash held none)"));
    return true;
}

void Selftest::check_clock()
{
    unsigned answered = 0;
    for (unsigned i = 0; i < PINGS; ++i) {
        const uint32_t before = record_.pongs();
        opms_error_t error = {};
        if (!called("clock", opms_box_ping(device_.get(), 0, nullptr, &error), error)) {
            return;
        }
        answered += record_.pump(PONG_PATIENCE, [&] { return record_.pongs() > before; }) ? 1 : 0;
        record_.pump(PING_PAUSE, [] { return false; });
    }
    const opms_clock_fit_t clock = record_.watch().clock();
    const std::string text =
        box_text("%u of %u pings answered, residual %.3f ms, drift %+.1f ppm", answered, PINGS,
                 static_cast<double>(clock.residual_ns) / 1e6, clock.drift_ppm);
    if (answered < PINGS) {
        fail("clock", text + ": reports get lost; try another USB port and no hub");
    } else if (clock.state == OPMS_CLOCK_UNKNOWN || clock.residual_ns > RESIDUAL_MAX_NS) {
        fail("clock", text + ": more than 2 ms; is this machine very busy?");
    } else if (clock.drift_sigma_ppm > 0 &&
               std::fabs(clock.drift_ppm) > DRIFT_MAX_PPM + 4 * clock.drift_sigma_ppm) {
        fail("clock", text + ": the box's clock is far off; is its crystal good?");
    } else {
        pass("clock", text);
    }
}
