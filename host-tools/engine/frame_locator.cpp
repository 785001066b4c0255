/* SPDX-License-Identifier: Apache-2.0 */
#include "frame_locator.hpp"

namespace opms_host {
namespace {

/** Mode capture: the light alone. */
class LightOnly : public FrameLocator {
public:
    void locate(const Frame &frame, PoseRecord &pose, BarInPicture &) override
    {
        if (!(frame.flags & OPMS_FRAME_DAMAGED)) {
            opms_exposure_measure(&frame.image, nullptr, 0, &pose.light, nullptr);
        }
    }
    void forget() override {}
};

/** Mode calibration: nodes of the grid for whom it may help to hold the camera right. */
class GridLocator : public FrameLocator {
public:
    void locate(const Frame &frame, PoseRecord &pose, BarInPicture &) override
    {
        grid_ = nullptr;
        if ((frame.flags & OPMS_FRAME_DAMAGED) || !fit_detector(frame.image)) {
            return;
        }
        opms_exposure_measure(&frame.image, nullptr, 0, &pose.light, nullptr);
        auto found = std::make_shared<GridRecord>();
        found->number = pose.number;
        if (opms_grid_detect(detector_.get(), &frame.image, &found->summary, nullptr) == OPMS_OK) {
            std::uint32_t count = 0;
            const opms_node_t *nodes = opms_grid_nodes(detector_.get(), &count);
            found->nodes.assign(nodes, nodes + count);
            pose.blur_px = {found->summary.blur_px, found->summary.blur_px};
            grid_ = std::move(found);
        }
    }
    void forget() override {}
    std::shared_ptr<const GridRecord> grid() const override { return grid_; }

private:
    struct Free {
        void operator()(opms_grid_detector_t *detector) const
        {
            opms_grid_detector_destroy(detector);
        }
    };

    /** The size of the pictures is known by the first one, and a camera may be changed. */
    bool fit_detector(const opms_image_t &image)
    {
        if (detector_ && image.width_px == width_px_ && image.height_px == height_px_) {
            return true;
        }
        opms_grid_options_t options;
        opms_grid_options_init(&options);
        options.width_px = width_px_ = image.width_px;
        options.height_px = height_px_ = image.height_px;
        opms_grid_detector_t *detector = nullptr;
        opms_grid_detector_create(&options, &detector, nullptr);
        detector_.reset(detector);
        return detector != nullptr;
    }

    std::unique_ptr<opms_grid_detector_t, Free> detector_;
    std::int32_t width_px_ = 0, height_px_ = 0;
    std::shared_ptr<const GridRecord> grid_;
};

}  // namespace

std::unique_ptr<FrameLocator> make_grid_locator()
{
    return std::make_unique<GridLocator>();
}

std::unique_ptr<FrameLocator> make_frame_locator(const SessionOptions &options,
                                                 const SourceTraits &traits, std::string &error)
{
    switch (options.mode) {
    case SessionMode::position: return make_bar_locator(options, traits, error);
    case SessionMode::calibration: return make_grid_locator();
    case SessionMode::capture: break;
    }
    return std::make_unique<LightOnly>();
}

}  // namespace opms_host
