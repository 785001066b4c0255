/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Automatic exposure of a camera: what opms/exposure.h decides, within what the camera can do. */
#ifndef OPMS_ENGINE_LIGHT_LOOP_HPP
#define OPMS_ENGINE_LIGHT_LOOP_HPP

#include <memory>

#include "scan_records.hpp"

namespace opms_host {

/** The defaults within a camera's limits. */
opms_exposure_options_t light_options(const SourceTraits &traits);

/** One camera's control. One thread at a time. */
class LightLoop {
public:
    /** @return NULL where the options are wrong, with @p error. */
    static std::unique_ptr<LightLoop> create(const opms_exposure_options_t &options,
                                             std::string &error);

    /** After a picture. pose.light is there; sets pose.exposure.
     * @return Whether the camera shall be set to pose.exposure now: it is not what was asked for
     *         last. */
    bool take(const Frame &frame, std::uint32_t squares_expected, double speed_px_s,
              PoseRecord &pose);
    /** The camera has forgotten what it was set to. */
    void forget();
    /** What was asked for last. @return false: nothing yet. */
    bool asked(double &exposure_us, double &gain_db) const;

private:
    struct Free {
        void operator()(opms_exposure_t *exposure) const { opms_exposure_destroy(exposure); }
    };
    explicit LightLoop(opms_exposure_t *exposure) : exposure_(exposure) {}

    std::unique_ptr<opms_exposure_t, Free> exposure_;
    double asked_exposure_us_ = NOT_KNOWN, asked_gain_db_ = NOT_KNOWN;
};

}  // namespace opms_host
#endif
