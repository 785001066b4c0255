/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The light of day over the simulated scene: clouds, and steps at known times. */
#ifndef OPMS_SIMULATED_WORLD_LIGHT_HPP
#define OPMS_SIMULATED_WORLD_LIGHT_HPP

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "world_options.hpp"
#include "world_random.hpp"

namespace opms_host {

class WorldLight {
public:
    explicit WorldLight(const WorldOptions &options)
        : clouds_ev_(options.clouds_ev), steps_(options.light_steps)
    {
        WorldRandom random(options.seed, Chance::light);
        for (Wave &wave : waves_) {
            wave = {random.log_uniform(8, 60), random.uniform(0, 6.283185307179586)};
        }
    }
    /** Against that of the look; 1 at the beginning without clouds. @p t_s since the run began. */
    double factor(double t_s) const
    {
        double ev = 0;
        double latest_s = -1;
        for (const LightStep &step : steps_) {
            if (step.at_s <= t_s && step.at_s >= latest_s) {
                ev = step.ev;
                latest_s = step.at_s;
            }
        }
        for (const Wave &wave : waves_) {
            ev += clouds_ev_ / waves_.size() * std::sin(6.283185307179586 * t_s / wave.period_s +
                                                        wave.phase);
        }
        return std::exp2(ev);
    }

private:
    struct Wave {
        double period_s, phase;
    };
    const double clouds_ev_;
    const std::vector<LightStep> steps_;
    std::array<Wave, 4> waves_{};
};

}  // namespace opms_host
#endif
