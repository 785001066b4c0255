/* SPDX-License-Identifier: Apache-2.0 */
#include "world_mishaps.hpp"

namespace opms_host {

namespace {

constexpr double GLITCH_OF_DEBOUNCE = 0.4;

std::int64_t ns_of_s(double s)
{
    return static_cast<std::int64_t>(s * 1e9);
}

}  // namespace

void WorldMishaps::run_began()
{
    const std::uint64_t run = ++runs_;
    boot_id_ = to_.box.boot_id();
    session_id_ = to_.box.session_id();
    for (std::size_t i = 0; i < MISHAP_KINDS; ++i) {
        plan_random(static_cast<Mishap>(i), run);
    }
    for (const PlannedMishap &planned : options_.planned) {
        to_.agenda.after(ns_of_s(planned.at_s), [this, planned, run] {
            if (is_of_run(run)) {
                happen(planned.what, planned.length_s);
            }
        });
    }
}

/** The run that it was planned in still goes on. */
bool WorldMishaps::is_of_run(std::uint64_t run) const
{
    return run == runs_ && to_.box.state() == OPMS_BOX_RUNNING &&
           to_.box.boot_id() == boot_id_ && to_.box.session_id() == session_id_;
}

void WorldMishaps::plan_random(Mishap what, std::uint64_t run)
{
    const double mean_s = options_.faults[what];
    if (mean_s <= 0) {
        return;
    }
    to_.agenda.after(ns_of_s(random_.exponential(mean_s)), [this, what, run] {
        if (is_of_run(run)) {
            happen(what, random_length_s(what));
            plan_random(what, run);
        }
    });
}

double WorldMishaps::random_length_s(Mishap what)
{
    switch (what) {
    case Mishap::box_unplug: return random_.log_uniform(0.3, 5);
    case Mishap::box_reboot: return random_.uniform(1, 2);
    case Mishap::camera_restart: return random_.uniform(0.5, 3);
    case Mishap::host_stall: return random_.log_uniform(0.02, 2);
    case Mishap::hide_bar: return random_.log_uniform(0.1, 10);
    default: return 0;
    }
}

void WorldMishaps::happen(Mishap what, double length_s)
{
    const std::int64_t now = to_.agenda.now_ns(), length = ns_of_s(length_s);
    const std::int64_t debounce_ns = to_.box.settings().debounce_cycles * NS_PER_CYCLE;
    to_.truth.add_mishap(mishap_name(what), now, length);
    switch (what) {
    case Mishap::box_unplug:
        to_.link.unplug();
        to_.agenda.after(length, [this] { to_.link.plug(); });
        break;
    case Mishap::box_reboot:
        to_.link.unplug();
        to_.box.power_off();
        to_.agenda.after(length, [this] {
            to_.box.power_on(OPMS_RESET_POWER);
            to_.link.plug();
        });
        break;
    case Mishap::camera_restart: to_.camera.restart(length); break;
    case Mishap::host_stall: to_.stall.until(now + length); break;
    case Mishap::hide_bar: to_.camera.hide_bar(now + length); break;
    case Mishap::glitch:
        to_.box.start_edge(
            static_cast<std::int64_t>(GLITCH_OF_DEBOUNCE * static_cast<double>(debounce_ns)));
        break;
    case Mishap::COUNT: break;
    }
}

}  // namespace opms_host
