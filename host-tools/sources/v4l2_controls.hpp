/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Exposure, gain and trigger of a V4L2 camera. */
#ifndef OPMS_SOURCES_V4L2_CONTROLS_HPP
#define OPMS_SOURCES_V4L2_CONTROLS_HPP

#include <cstdint>
#include <optional>
#include <string>

#include "exposure_log.hpp"
#include "v4l2_calls.hpp"

namespace opms_host {

/** A control with whole numbers, as the driver has it. */
struct V4l2Control {
    std::uint32_t id = 0;
    std::int64_t least = 0, most = 0, step = 1;
};

/** What was found at a camera. */
struct V4l2Controls {
    std::optional<V4l2Control> exposure; /**< in units of 100 us */
    std::optional<V4l2Control> gain;     /**< in units that no standard names */
    std::optional<V4l2Control> trigger;
    std::int64_t trigger_on = 1, trigger_off = 0;
};

/** Look for the controls. Those that are there can be set. */
V4l2Controls v4l2_find_controls(V4l2Calls &calls, int fd);

/** No automatic exposure or gain: where there are such, they are switched off. */
void v4l2_take_manual(V4l2Calls &calls, int fd);

/** Follow the trigger line or the camera's own clock. @return Whether the driver did so. */
bool v4l2_set_trigger(V4l2Calls &calls, int fd, const V4l2Controls &controls, bool hardware,
                      std::string &error);

/** Set what is not NaN, within the limits, and read back what holds then.
 * @param gain_step_db  Of one step of the gain; 0: not known, and the gain is left alone; it is
 *                      then 0 dB, as all gains of this camera count from what it has. */
bool v4l2_set_exposure(V4l2Calls &calls, int fd, const V4l2Controls &controls,
                       double gain_step_db, ExposureSetting &setting, std::string &error);

/** What holds now. */
ExposureSetting v4l2_read_exposure(V4l2Calls &calls, int fd, const V4l2Controls &controls,
                                   double gain_step_db);

}  // namespace opms_host
#endif
