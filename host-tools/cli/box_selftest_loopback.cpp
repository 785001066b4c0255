/* SPDX-License-Identifier: Apache-2.0 */
/* With a jumper from TRIG to START the box sees its own pulses, in two ways. With a debounce longer
 * than a pulse each one comes back as a glitch, whose length is measured: both pins, and the wire
 * between, are good. And where START takes the edge that ends a pulse, the preamble's first pulse
 * starts a run: START stays active behind it for as long as any debounce. */
#include <algorithm>
#include <cstdlib>

#include "box_json.hpp"
#include "box_selftest.hpp"

namespace {

using std::chrono::milliseconds;

constexpr uint32_t WIDTH_US = 1000, GLITCH_DEBOUNCE_US = 2000, RUN_DEBOUNCE_US = 10;
constexpr uint16_t GAP_MS = 20;
constexpr size_t GAPS = 4;
constexpr milliseconds PATIENCE(3000);
constexpr uint32_t LENGTH_TOLERANCE_CYCLES = 10;

/** What is set but for the width and a short preamble. */
opms_settings_t loopback_settings(const opms_settings_t &usual)
{
    opms_settings_t settings = usual;
    settings.width_us = WIDTH_US;
    std::fill(std::begin(settings.preamble_gap_ms), std::end(settings.preamble_gap_ms),
              uint16_t{0});
    std::fill_n(settings.preamble_gap_ms, GAPS, GAP_MS);
    return settings;
}

/** START takes the edge that begins a pulse of TRIG, and finds it too short. */
opms_settings_t glitch_settings(const opms_settings_t &usual)
{
    opms_settings_t settings = loopback_settings(usual);
    settings.debounce_cycles = GLITCH_DEBOUNCE_US * OPMS_BOX_CYCLES_PER_US;
    settings.start_falling_edge = usual.trig_active_low;
    return settings;
}

/** START takes the edge that ends a pulse of TRIG. It is active before the first one, too, so that
 * the box cuts that one short after some cycles; the debounce keeps the run's first one apart. */
opms_settings_t run_settings(const opms_settings_t &usual)
{
    opms_settings_t settings = loopback_settings(usual);
    settings.debounce_cycles = RUN_DEBOUNCE_US * OPMS_BOX_CYCLES_PER_US;
    settings.start_falling_edge = !usual.trig_active_low;
    return settings;
}

} // namespace

bool Selftest::put_settings(const std::string &name, const opms_settings_t &settings)
{
    opms_error_t error = {};
    settings_ = settings;
    return called(name, opms_box_set_settings(device_.get(), &settings, 0, nullptr, &error), error);
}

void Selftest::check_loopback()
{
    if (!options_.loopback) {
        return;
    }
    const opms_settings_t usual = settings_;
    opms_error_t error = {};
    if (put_settings("loopback", glitch_settings(usual))) {
        check_loopback_pulses();
        called("loopback", opms_box_disarm(device_.get(), 0, &error), error);
    }
    if (put_settings("loopback-run", run_settings(usual))) {
        check_loopback_run();
        called("loopback-run", opms_box_disarm(device_.get(), 0, &error), error);
    }
    if (!put_settings("loopback", usual)) {
        box_talk("the settings are not those of before; see 'opms box settings'");
    }
}

void Selftest::check_loopback_pulses()
{
    record_.begin_session();
    opms_error_t error = {};
    if (!called("loopback", opms_box_arm(device_.get(), box_new_session(), 0, &error), error)) {
        return;
    }
    const auto count = [this] { return record_.count_events(OPMS_EVENT_GLITCH); };
    record_.pump(PATIENCE, [&] { return count() > GAPS; });
    if (count() == 0) {
        fail("loopback", "START saw none of the pulses of TRIG: check the jumper between the two "
                         "pins, and that nothing else drives START");
        return;
    }
    const uint32_t due = WIDTH_US * OPMS_BOX_CYCLES_PER_US;
    for (const opms_event_report_t &event : record_.events()) {
        const int64_t off = static_cast<int64_t>(event.argument) - due;
        if (event.kind == OPMS_EVENT_GLITCH && std::llabs(off) > LENGTH_TOLERANCE_CYCLES) {
            fail("loopback", box_text("START saw a pulse of %.3f us, TRIG sends %u us: is there "
                                      "a filter, or a long wire, between the pins?",
                                      event.argument * 0.008, WIDTH_US));
            return;
        }
    }
    if (count() != GAPS + 1) {
        fail("loopback", box_text("START saw %zu of %zu pulses of TRIG: is the jumper loose?",
                                  count(), GAPS + 1));
    } else {
        pass("loopback", box_text("START saw all %zu pulses of TRIG, %u us long", GAPS + 1,
                                  WIDTH_US));
    }
}

void Selftest::check_loopback_run()
{
    record_.begin_session();
    opms_error_t error = {};
    if (!called("loopback-run", opms_box_arm(device_.get(), box_new_session(), 0, &error),
                error)) {
        return;
    }
    if (record_.pump(PATIENCE, [this] { return record_.event(OPMS_EVENT_START) != nullptr; })) {
        check_run("loopback-run");
    } else {
        fail("loopback-run", "no pulse of TRIG started a run: check the jumper between the two "
                             "pins, and that nothing else drives START");
    }
}
