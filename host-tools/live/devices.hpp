/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A box, a camera and the clock that both live by. */
#ifndef OPMS_LIVE_DEVICES_HPP
#define OPMS_LIVE_DEVICES_HPP

#include <memory>

#include "box_port.hpp"
#include "frame_source.hpp"
#include "host_clock.hpp"

namespace opms_host {

/** Members go in this order's reverse: the clock last. Box or camera may be absent. */
struct Devices {
    std::shared_ptr<HostClock> clock;
    std::unique_ptr<BoxPort> box;
    std::unique_ptr<FrameSource> source;
};

}  // namespace opms_host
#endif
