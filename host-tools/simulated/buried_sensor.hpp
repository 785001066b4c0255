/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A simulated metal detector over known things in the ground. */
#ifndef OPMS_SIMULATED_BURIED_SENSOR_HPP
#define OPMS_SIMULATED_BURIED_SENSOR_HPP

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "simulate/simulate.hpp"
#include "world_options.hpp"
#include "world_path.hpp"
#include "world_random.hpp"

namespace opms_host {

/** What a coil of 0.2 m under the head answers, without noise: for each object its strength, times
 * ((a^2 + h^2) / (a^2 + r^2))^3 with the coil's radius a, r from the head to the object, and h what
 * r is when the head is right above at 0.05 m. */
double buried_response(const std::vector<BuriedObject> &objects,
                       const opms::simulate::Pose &ground_detector);

/** Samples along the path of a run, as a table that `--sensor NAME=FILE` reads while it grows. One
 * thread at a time. */
class BuriedSensor {
public:
    /** @param path_s_of_run  Seconds of the path in a second of the run.
     *  @param delay_s  From a time of the run to the same time of the path: pictures show the path
     *                  at the middle of their exposure.
     * Throws std::runtime_error where options.sensor_file cannot be written. */
    BuriedSensor(const WorldOptions &options, const DetectorPath &path, double path_s_of_run,
                 double delay_s);

    /** The table begins anew: t_scan_s is 0 at START's edge. */
    void run_began();
    /** Write all samples before a time of the run. */
    void advance_to(double run_s);

private:
    void write_head();

    const WorldOptions options_;
    const DetectorPath path_;
    const double path_s_of_run_, delay_s_;
    WorldRandom random_;
    std::ofstream file_;
    std::uint64_t samples_ = 0;
};

}  // namespace opms_host
#endif
