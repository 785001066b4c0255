/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One camera's run of `opms locate`: pictures in, results with their times out. */
#ifndef OPMS_CLI_LOCATE_RUN_HPP
#define OPMS_CLI_LOCATE_RUN_HPP

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <opms/locate.h>

struct LocateSettings {
    std::string bar = "hope33"; /**< or "apriltag33" */
    double bar_tilt_rad = 0;
    bool follow = false;        /**< the last located pose is the hint for the next picture */
    uint16_t white_level = 0;   /**< as in opms_image_t */
};

/** Microseconds by the steady clock, from the decoded pixels to the result. */
struct LocateTimes {
    double detect_us = 0, pose_us = 0, total_us = 0;
};

struct LocateResult {
    std::string image;  /**< as the user wrote it */
    std::string reason; /**< not empty: the picture could not be read, nothing below is set */
    opms_location_t location = {};
    std::vector<opms_square_t> squares;
    std::vector<opms_edge_t> edges;
    std::vector<double> residuals_px; /**< one for each edge, empty where not located */
    LocateTimes time;

    bool located() const { return reason.empty() && location.state == OPMS_BAR_LOCATED; }
    /** "located", "absent", "ambiguous" or "error". */
    const char *state_name() const;
};

/** Whether bars of this name can be read by this build. */
bool locate_bar_supported(const std::string &bar);

class LocateRun {
public:
    virtual ~LocateRun() = default;
    /** Locate the bar in a decoded picture of the camera's size; a library error becomes the
     * result's reason. */
    virtual void locate(const cv::Mat &picture, LocateResult &result) = 0;
    /** @return NULL with @p error on failure. */
    static std::unique_ptr<LocateRun> create(const opms_camera_t &camera,
                                             const LocateSettings &settings, std::string &error);
};

#endif
