/* SPDX-License-Identifier: Apache-2.0 */
#include "light_loop.hpp"

#include <cmath>

namespace opms_host {
namespace {

/** Differences that no picture shows are not worth a word to the camera. */
bool differs(double exposure_us, double gain_db, const opms_exposure_command_t &command)
{
    return !(std::fabs(command.exposure_us - exposure_us) <= 0.002 * exposure_us &&
             std::fabs(command.gain_db - gain_db) <= 0.02);
}

}  // namespace

opms_exposure_options_t light_options(const SourceTraits &traits)
{
    opms_exposure_options_t options;
    opms_exposure_options_init(&options);
    if (traits.exposure_max_us > 0) {
        options.exposure_min_us = std::fmax(traits.exposure_min_us, options.exposure_min_us);
        options.exposure_max_us = std::fmin(traits.exposure_max_us, options.exposure_max_us);
        if (options.exposure_min_us > options.exposure_max_us) {
            options.exposure_min_us = options.exposure_max_us = traits.exposure_max_us;
        }
    }
    options.gain_min_db = traits.gain_min_db;
    options.gain_max_db = std::fmax(traits.gain_max_db, traits.gain_min_db);
    return options;
}

std::unique_ptr<LightLoop> LightLoop::create(const opms_exposure_options_t &options,
                                             std::string &error)
{
    opms_exposure_t *exposure = nullptr;
    opms_error_t why{};
    if (opms_exposure_create(&options, &exposure, &why) != OPMS_OK) {
        error = std::string("automatic exposure: ") + why.message;
        return nullptr;
    }
    return std::unique_ptr<LightLoop>(new LightLoop(exposure));
}

bool LightLoop::take(const Frame &frame, std::uint32_t squares_expected, double speed_px_s,
                     PoseRecord &pose)
{
    opms_exposure_frame_t input{};
    input.exposure_us = frame.exposure_us;
    /* A camera without a gain to set may not report one. */
    input.gain_db = std::isfinite(frame.gain_db) ? frame.gain_db : 0;
    input.light = pose.light;
    const bool is_located = pose.location.state == OPMS_BAR_LOCATED;
    input.squares_located = is_located ? pose.location.bar.square_count : 0;
    input.squares_expected = squares_expected;
    input.speed_px_s = speed_px_s;
    if (!(frame.exposure_us > 0) ||
        opms_exposure_push(exposure_.get(), &input, &pose.exposure, nullptr) != OPMS_OK) {
        return false;
    }
    if (!differs(asked_exposure_us_, asked_gain_db_, pose.exposure)) {
        return false;
    }
    asked_exposure_us_ = pose.exposure.exposure_us;
    asked_gain_db_ = pose.exposure.gain_db;
    return true;
}

void LightLoop::forget()
{
    asked_exposure_us_ = asked_gain_db_ = NOT_KNOWN;
}

bool LightLoop::asked(double &exposure_us, double &gain_db) const
{
    exposure_us = asked_exposure_us_;
    gain_db = asked_gain_db_;
    return std::isfinite(asked_exposure_us_);
}

}  // namespace opms_host
