/* SPDX-License-Identifier: Apache-2.0 */
/* Mode position: bar, pose, light and blur. The pose of the last picture is a hint for the next
 * one; it is told with the pose, so that a replay can give the same hint. */
#include "frame_locator.hpp"

#include <cstdlib>
#include <utility>

#include <opms/blur.h>
#ifdef OPMS_ENGINE_HAVE_APRILTAG
#include <opms/apriltag.h>
#endif

namespace opms_host {
namespace {

constexpr std::int64_t BLUR_EVERY_NS = 80'000'000;
constexpr std::int64_t HINT_OLD_NS = 1'000'000'000; /* a hand has moved on by then */

struct FreeLocator {
    void operator()(opms_locator_t *locator) const { opms_locator_destroy(locator); }
};

/** By the camera's clock where it has one: arrivals jitter. */
std::int64_t taken_ns(const Frame &frame, const opms_camera_profile_t &profile)
{
    if (!profile.has_camera_time || profile.camera_tick_hz == 0 ||
        (frame.flags & OPMS_FRAME_NO_TIME)) {
        return frame.arrival_host_ns;
    }
    return static_cast<std::int64_t>(static_cast<long double>(frame.camera_time_ticks) * 1e9L /
                                     static_cast<long double>(profile.camera_tick_hz));
}

BlurVerdict blur_verdict(opms_blur_verdict_t verdict)
{
    switch (verdict) {
    case OPMS_BLUR_UNKNOWN: return BlurVerdict::unknown;
    case OPMS_BLUR_SHARP: return BlurVerdict::sharp;
    case OPMS_BLUR_FOCUS: return BlurVerdict::focus;
    case OPMS_BLUR_MOTION: return BlurVerdict::motion;
    case OPMS_BLUR_APERTURE: return BlurVerdict::aperture;
    }
    return BlurVerdict::unknown;
}

class BarLocator : public FrameLocator {
public:
    BarLocator(const SessionOptions &options, const opms_camera_profile_t &profile,
               opms_locator_t *locator)
        : lens_(options.camera->lens), profile_(profile), follow_(options.follow),
          locator_(locator)
    {
    }

    void locate(const Frame &frame, PoseRecord &pose, BarInPicture &bar) override
    {
        const bool fits =
            frame.image.width_px == lens_.width_px && frame.image.height_px == lens_.height_px;
        if ((frame.flags & OPMS_FRAME_DAMAGED) || !fits) {
            return;
        }
        const bool has_last =
            has_last_ && std::llabs(frame.arrival_host_ns - last_host_ns_) < HINT_OLD_NS;
        pose.has_hint = find(frame, follow_ && has_last ? &last_ : nullptr, pose);
        pose.hint = pose.has_hint ? last_ : opms_transform_t{};
        take_details(pose);
        judge_blur(frame, pose);
        measure(frame, has_last, pose, bar);
        remember(frame, pose);
    }

    void forget() override
    {
        has_last_ = false;
        motion_.forget();
    }

protected:
    /** Set pose.location. @return Whether the hint was given to the locator. */
    virtual bool find(const Frame &frame, const opms_transform_t *hint, PoseRecord &pose)
    {
        opms_locator_locate(locator_.get(), &frame.image, nullptr, hint, &pose.location, nullptr);
        return hint != nullptr;
    }
    opms_locator_t *locator() const { return locator_.get(); }

private:
    /** Copy what the locator holds until its next call. */
    void take_details(PoseRecord &pose) const
    {
        std::uint32_t count = 0;
        const opms_square_t *squares = opms_locator_squares(locator_.get(), &count);
        pose.squares.assign(squares, squares + count);
        const opms_edge_t *edges = opms_locator_edges(locator_.get(), &count);
        pose.edges.assign(edges, edges + count);
        const double *residuals = opms_locator_residuals_px(locator_.get());
        if (residuals && pose.location.state == OPMS_BAR_LOCATED) {
            pose.residuals_px.assign(residuals, residuals + count);
        }
        pose.blur_px = {pose.location.bar.blur_px[0], pose.location.bar.blur_px[1]};
    }

    /** How sharp the bar is, and what a person could do about it: ten times a second at most, no
     * lens is turned faster. */
    void judge_blur(const Frame &frame, PoseRecord &pose)
    {
        if (std::llabs(frame.arrival_host_ns - blur_host_ns_) < BLUR_EVERY_NS) {
            return;
        }
        blur_host_ns_ = frame.arrival_host_ns;
        opms_blur_t blur{};
        const auto count = static_cast<std::uint32_t>(pose.squares.size());
        if (pose.location.state != OPMS_BAR_LOCATED ||
            opms_blur_measure(&frame.image, pose.squares.data(), count, nullptr, &blur, nullptr) !=
                OPMS_OK) {
            return;
        }
        pose.blur = blur_verdict(blur.verdict);
        pose.blur_px = {blur.blur_px[0], blur.blur_px[1]};
    }

    /** The light on the bar where it is, or where it was a moment ago. */
    void measure(const Frame &frame, bool has_last, PoseRecord &pose, BarInPicture &bar)
    {
        const bool is_located = pose.location.state == OPMS_BAR_LOCATED;
        const opms_transform_t &where =
            is_located ? pose.location.pose.bar_camera.transform : last_;
        opms_square_t expected[OPMS_BAR_SQUARES];
        std::uint32_t count = 0;
        if (is_located || has_last) {
            opms_exposure_expect(&lens_, &where, expected, &count, nullptr);
        }
        opms_exposure_measure(&frame.image, expected, count, &pose.light, nullptr);
        const std::int64_t t_ns = taken_ns(frame, profile_);
        if (is_located) {
            motion_.take(pose.squares, t_ns);
        }
        bar.squares_expected = is_located ? count : 0;
        bar.speed_px_s = motion_.speed_px_s(t_ns);
    }

    void remember(const Frame &frame, const PoseRecord &pose)
    {
        if (pose.location.state == OPMS_BAR_LOCATED) {
            has_last_ = true;
            last_ = pose.location.pose.bar_camera.transform;
            last_host_ns_ = frame.arrival_host_ns;
        }
    }

    const opms_lens_t lens_;
    const opms_camera_profile_t profile_;
    const bool follow_;
    std::unique_ptr<opms_locator_t, FreeLocator> locator_;
    BarMotion motion_;
    bool has_last_ = false;
    opms_transform_t last_{};
    std::int64_t last_host_ns_ = 0, blur_host_ns_ = 0;
};

#ifdef OPMS_ENGINE_HAVE_APRILTAG
/** Another detector, the same pose. It has no use for a hint. */
class AprilTagLocator : public BarLocator {
public:
    AprilTagLocator(const SessionOptions &options, const opms_camera_profile_t &profile,
                    opms_locator_t *locator, opms_apriltag_detector_t *detector)
        : BarLocator(options, profile, locator), detector_(detector)
    {
    }

protected:
    bool find(const Frame &frame, const opms_transform_t *, PoseRecord &pose) override
    {
        opms_bar_summary_t summary{};
        if (opms_apriltag_detect(detector_.get(), &frame.image, &summary, nullptr) != OPMS_OK) {
            return false;
        }
        std::uint32_t count = 0;
        const opms_edge_t *edges = opms_apriltag_edges(detector_.get(), &count);
        count = summary.state == OPMS_BAR_LOCATED ? count : 0;
        opms_locator_solve(locator(), edges, count, &pose.location, nullptr);
        if (summary.state != OPMS_BAR_LOCATED) {
            pose.location.state = summary.state;
        } else if (pose.location.state == OPMS_BAR_ABSENT) {
            pose.location.state = OPMS_BAR_AMBIGUOUS; /* a bar is there, but no pose fits it */
        }
        pose.location.bar = summary;
        return false;
    }

private:
    struct FreeDetector {
        void operator()(opms_apriltag_detector_t *detector) const
        {
            opms_apriltag_detector_destroy(detector);
        }
    };
    std::unique_ptr<opms_apriltag_detector_t, FreeDetector> detector_;
};
#endif

std::unique_ptr<FrameLocator> make_apriltag_locator(const SessionOptions &options,
                                                    const opms_camera_profile_t &profile,
                                                    opms_locator_t *locator, std::string &error)
{
#ifdef OPMS_ENGINE_HAVE_APRILTAG
    opms_apriltag_detector_t *detector = nullptr;
    opms_error_t why{};
    if (opms_apriltag_detector_create(&options.camera->lens, nullptr, &detector, &why) == OPMS_OK) {
        return std::make_unique<AprilTagLocator>(options, profile, locator, detector);
    }
    error = why.message;
#else
    (void)options;
    (void)profile;
    error = "bar apriltag33: this program was built without libapriltag";
#endif
    opms_locator_destroy(locator);
    return nullptr;
}

}  // namespace

std::unique_ptr<FrameLocator> make_bar_locator(const SessionOptions &options,
                                               const SourceTraits &traits, std::string &error)
{
    if (!options.camera) {
        error = "positions need a camera file: calibrate the camera first";
        return nullptr;
    }
    opms_locator_options_t how;
    opms_locator_options_init(&how);
    how.bar_tilt_rad = options.bar_tilt_rad;
    opms_locator_t *locator = nullptr;
    opms_error_t why{};
    if (opms_locator_create(&*options.camera, &how, &locator, &why) != OPMS_OK) {
        error = why.message;
        return nullptr;
    }
    if (options.bar == "hope33") {
        return std::make_unique<BarLocator>(options, traits.profile, locator);
    }
    if (options.bar == "apriltag33") {
        return make_apriltag_locator(options, traits.profile, locator, error);
    }
    opms_locator_destroy(locator);
    error = "bar \"" + options.bar + "\": hope33 or apriltag33";
    return nullptr;
}

}  // namespace opms_host
