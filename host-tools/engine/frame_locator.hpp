/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All that is found in one picture: the bar and the pose, or the grid; the light; the blur. */
#ifndef OPMS_ENGINE_FRAME_LOCATOR_HPP
#define OPMS_ENGINE_FRAME_LOCATOR_HPP

#include <memory>
#include <optional>
#include <string>

#include "bar_motion.hpp"
#include "live_session.hpp"

namespace opms_host {

/** What the control of the exposure wants to know beside the pose. */
struct BarInPicture {
    std::uint32_t squares_expected = 0;
    double speed_px_s = 0;
};

/** One camera's pictures, in their order. One thread at a time. */
class FrameLocator {
public:
    virtual ~FrameLocator() = default;
    /** Fill in what the picture tells of a pose (its number is there). A damaged picture, or one of
     * another size than the camera's lens, is not located: what it shows may be older. */
    virtual void locate(const Frame &frame, PoseRecord &pose, BarInPicture &bar) = 0;
    /** A new scan: no picture from before it is a hint. */
    virtual void forget() = 0;
    /** The grid of the last picture (mode calibration); NULL in other modes. */
    virtual std::shared_ptr<const GridRecord> grid() const { return nullptr; }
};

/** For the options' mode. @return NULL where they do not allow one, with @p error. */
std::unique_ptr<FrameLocator> make_frame_locator(const SessionOptions &options,
                                                 const SourceTraits &traits, std::string &error);
std::unique_ptr<FrameLocator> make_bar_locator(const SessionOptions &options,
                                               const SourceTraits &traits, std::string &error);
std::unique_ptr<FrameLocator> make_grid_locator();

}  // namespace opms_host
#endif
