/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_locator.hpp"

#include "locate_run.hpp"
#include "picture_file.hpp"

namespace {

using namespace opms_host;

struct LocatorDeleter {
    void operator()(opms_locator_t *locator) const { opms_locator_destroy(locator); }
};
using Locator = std::unique_ptr<opms_locator_t, LocatorDeleter>;

void take_details(const opms_locator_t *locator, PoseRecord &again)
{
    uint32_t count = 0;
    const opms_square_t *squares = opms_locator_squares(locator, &count);
    again.squares.assign(squares, squares + count);
    const opms_edge_t *edges = opms_locator_edges(locator, &count);
    again.edges.assign(edges, edges + count);
    const double *residuals = opms_locator_residuals_px(locator);
    again.residuals_px.assign(residuals, residuals ? residuals + count : residuals);
}

cv::Mat read_grey(const std::string &path, const opms_lens_t &lens, std::string &error)
{
    const cv::Mat picture = picture_read(path, lens.width_px, lens.height_px, error);
    if (picture.empty()) {
        error = path + ": " + error;
        return picture;
    }
    return picture_grey(picture);
}

/** Bars of kind hope33. */
class HopeReplay : public ReplayLocator {
public:
    HopeReplay(const opms_camera_t &camera, Locator locator)
        : lens_(camera.lens), locator_(std::move(locator))
    {
    }

    bool from_picture(const std::string &path, const FrameRecord &frame,
                      const PoseRecord &recorded, PoseRecord &again, std::string &error) override
    {
        const cv::Mat grey = read_grey(path, lens_, error);
        if (grey.empty()) {
            return false;
        }
        const opms_image_t image = picture_view(grey, frame.white_level);
        const opms_transform_t *hint = recorded.has_hint ? &recorded.hint : nullptr;
        opms_error_t why = {};
        if (opms_locator_locate(locator_.get(), &image, nullptr, hint, &again.location, &why) !=
            OPMS_OK) {
            error = path + ": " + why.message;
            return false;
        }
        take_details(locator_.get(), again);
        return true;
    }

    bool from_points(const PoseRecord &recorded, PoseRecord &again, std::string &error) override
    {
        opms_error_t why = {};
        if (opms_locator_solve(locator_.get(), recorded.edges.data(),
                               static_cast<uint32_t>(recorded.edges.size()), &again.location,
                               &why) != OPMS_OK) {
            error = "picture " + std::to_string(recorded.number) + ": " + why.message;
            return false;
        }
        if (again.location.state == OPMS_BAR_ABSENT) {
            again.location.state = OPMS_BAR_AMBIGUOUS; /* a bar is there, but no pose fits it */
        }
        take_details(locator_.get(), again);
        return true;
    }

private:
    opms_lens_t lens_;
    Locator locator_;
};

/** Bars of kind apriltag33: pictures by their own detector, which knows no hint. */
class AprilTagReplay : public HopeReplay {
public:
    AprilTagReplay(const opms_camera_t &camera, Locator locator, double bar_tilt_rad)
        : HopeReplay(camera, std::move(locator)), camera_(camera), bar_tilt_rad_(bar_tilt_rad)
    {
    }

    bool from_picture(const std::string &path, const FrameRecord &frame, const PoseRecord &,
                      PoseRecord &again, std::string &error) override
    {
        const cv::Mat grey = read_grey(path, camera_.lens, error);
        if (grey.empty() || !make_run(frame.white_level, error)) {
            return false;
        }
        LocateResult result;
        run_->locate(grey, result);
        if (!result.reason.empty()) {
            error = path + ": " + result.reason;
            return false;
        }
        again.location = result.location;
        again.squares = result.squares;
        again.edges = result.edges;
        again.residuals_px = result.residuals_px;
        return true;
    }

private:
    bool make_run(uint16_t white_level, std::string &error)
    {
        if (run_ && white_level == white_level_) {
            return true;
        }
        LocateSettings settings;
        settings.bar = "apriltag33";
        settings.bar_tilt_rad = bar_tilt_rad_;
        settings.white_level = white_level_ = white_level;
        run_ = LocateRun::create(camera_, settings, error);
        return run_ != nullptr;
    }

    opms_camera_t camera_;
    double bar_tilt_rad_;
    uint16_t white_level_ = 0;
    std::unique_ptr<LocateRun> run_;
};

}  // namespace

std::unique_ptr<ReplayLocator> ReplayLocator::create(const opms_camera_t &camera,
                                                     const ScanHeader &header, std::string &error)
{
    if (!locate_bar_supported(header.bar)) {
        error = "its bar is '" + header.bar + "', which this program cannot read";
        return nullptr;
    }
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar_tilt_rad = header.bar_tilt_rad;
    opms_locator_t *made = nullptr;
    opms_error_t why = {};
    if (opms_locator_create(&camera, &options, &made, &why) != OPMS_OK) {
        error = why.message;
        return nullptr;
    }
    Locator locator(made);
    if (header.bar == "apriltag33") {
        return std::make_unique<AprilTagReplay>(camera, std::move(locator), header.bar_tilt_rad);
    }
    return std::make_unique<HopeReplay>(camera, std::move(locator));
}
