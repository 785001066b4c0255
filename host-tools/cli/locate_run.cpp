/* SPDX-License-Identifier: Apache-2.0 */
/* The result is always the locator's own. For hope33, the share of the pose in its time is found by
 * solving once more from the same edges, outside the total. */
#include "locate_run.hpp"

#include <algorithm>
#include <chrono>

#ifdef OPMS_CLI_HAVE_APRILTAG
#include <opms/apriltag.h>
#endif

#include "location_json.hpp"
#include "picture_file.hpp"

namespace {

using Clock = std::chrono::steady_clock;

double us_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

struct LocatorDeleter {
    void operator()(opms_locator_t *locator) const { opms_locator_destroy(locator); }
};
using Locator = std::unique_ptr<opms_locator_t, LocatorDeleter>;

Locator make_locator(const opms_camera_t &camera, const LocateSettings &settings,
                     std::string &error)
{
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar_tilt_rad = settings.bar_tilt_rad;
    opms_locator_t *locator = nullptr;
    opms_error_t why = {};
    if (opms_locator_create(&camera, &options, &locator, &why) != OPMS_OK) {
        error = why.message;
    }
    return Locator(locator);
}

/** Copy what the locator holds until its next call. */
void take_details(const opms_locator_t *locator, LocateResult &result)
{
    uint32_t count = 0;
    const opms_square_t *squares = opms_locator_squares(locator, &count);
    result.squares.assign(squares, squares + count);
    const opms_edge_t *edges = opms_locator_edges(locator, &count);
    result.edges.assign(edges, edges + count);
    const double *residuals = opms_locator_residuals_px(locator);
    result.residuals_px.assign(residuals, residuals ? residuals + count : residuals);
}

/** Bars of kind hope33. */
class HopeRun : public LocateRun {
public:
    HopeRun(const opms_camera_t &camera, const LocateSettings &settings, Locator locator)
        : lens_(camera.lens), settings_(settings), locator_(std::move(locator))
    {
    }

    void locate(const cv::Mat &picture, LocateResult &result) override
    {
        opms_error_t error = {};
        const opms_transform_t *hint = settings_.follow && has_last_ ? &last_ : nullptr;
        const Clock::time_point start = Clock::now();
        const cv::Mat grey = picture_grey(picture);
        const opms_image_t image = picture_view(grey, settings_.white_level);
        const opms_status_t status = opms_locator_locate(locator_.get(), &image, nullptr, hint,
                                                         &result.location, &error);
        result.time.total_us = us_since(start);
        if (status != OPMS_OK) {
            result.reason = error.message;
            return;
        }
        take_details(locator_.get(), result);
        split_time(result);
        if (result.located()) {
            last_ = result.location.pose.bar_camera.transform;
            has_last_ = true;
        }
    }

private:
    void split_time(LocateResult &result) const
    {
        const auto count = static_cast<uint32_t>(result.edges.size());
        if (result.location.bar.state == OPMS_BAR_LOCATED) {
            opms_pose_result_t again;
            const Clock::time_point start = Clock::now();
            opms_pose_solve(&lens_, result.edges.data(), count, nullptr, &again, nullptr);
            result.time.pose_us = std::min(us_since(start), result.time.total_us);
        }
        result.time.detect_us = result.time.total_us - result.time.pose_us;
    }

    opms_lens_t lens_;
    LocateSettings settings_;
    Locator locator_;
    opms_transform_t last_ = {};
    bool has_last_ = false;
};

#ifdef OPMS_CLI_HAVE_APRILTAG
struct AprilTagDeleter {
    void operator()(opms_apriltag_detector_t *detector) const
    {
        opms_apriltag_detector_destroy(detector);
    }
};
using AprilTagDetector = std::unique_ptr<opms_apriltag_detector_t, AprilTagDeleter>;

/** Bars of kind apriltag33: another detector, the same pose. It has no use for a hint. */
class AprilTagRun : public LocateRun {
public:
    AprilTagRun(const LocateSettings &settings, Locator locator, AprilTagDetector detector)
        : settings_(settings), locator_(std::move(locator)), detector_(std::move(detector))
    {
    }

    void locate(const cv::Mat &picture, LocateResult &result) override
    {
        opms_error_t error = {};
        opms_bar_summary_t summary = {};
        const Clock::time_point start = Clock::now();
        const cv::Mat grey = picture_grey(picture);
        const opms_image_t image = picture_view(grey, settings_.white_level);
        opms_status_t status = opms_apriltag_detect(detector_.get(), &image, &summary, &error);
        result.time.detect_us = us_since(start);
        result.location.state = summary.state;
        if (status == OPMS_OK && summary.state == OPMS_BAR_LOCATED) {
            status = solve(result.location, error);
        }
        result.time.total_us = us_since(start);
        result.time.pose_us = result.time.total_us - result.time.detect_us;
        result.location.bar = summary;
        if (status != OPMS_OK) {
            result.reason = error.message;
        } else if (summary.state == OPMS_BAR_LOCATED) {
            take_details(locator_.get(), result);
        }
    }

private:
    opms_status_t solve(opms_location_t &location, opms_error_t &error)
    {
        uint32_t count = 0;
        const opms_edge_t *edges = opms_apriltag_edges(detector_.get(), &count);
        const opms_status_t status =
            opms_locator_solve(locator_.get(), edges, count, &location, &error);
        if (status == OPMS_OK && location.state == OPMS_BAR_ABSENT) {
            location.state = OPMS_BAR_AMBIGUOUS; /* a bar is there, but no pose fits it */
        }
        return status;
    }

    LocateSettings settings_;
    Locator locator_;
    AprilTagDetector detector_;
};

std::unique_ptr<LocateRun> make_apriltag_run(const opms_camera_t &camera,
                                             const LocateSettings &settings, Locator locator,
                                             std::string &error)
{
    opms_apriltag_detector_t *detector = nullptr;
    opms_error_t why = {};
    if (opms_apriltag_detector_create(&camera.lens, nullptr, &detector, &why) != OPMS_OK) {
        error = why.message;
        return nullptr;
    }
    return std::make_unique<AprilTagRun>(settings, std::move(locator), AprilTagDetector(detector));
}
#endif

}  // namespace

const char *LocateResult::state_name() const
{
    return reason.empty() ? json_bar_state(location.state) : "error";
}

bool locate_bar_supported(const std::string &bar)
{
#ifdef OPMS_CLI_HAVE_APRILTAG
    return bar == "hope33" || bar == "apriltag33";
#else
    return bar == "hope33";
#endif
}

std::unique_ptr<LocateRun> LocateRun::create(const opms_camera_t &camera,
                                             const LocateSettings &settings, std::string &error)
{
    Locator locator = make_locator(camera, settings, error);
    if (!locator) {
        return nullptr;
    }
#ifdef OPMS_CLI_HAVE_APRILTAG
    if (settings.bar == "apriltag33") {
        return make_apriltag_run(camera, settings, std::move(locator), error);
    }
#endif
    return std::make_unique<HopeRun>(camera, settings, std::move(locator));
}
