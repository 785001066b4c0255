/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * GenICam cameras (GigE Vision, USB3 Vision) by Aravis. */
#ifndef OPMS_SOURCES_ARAVIS_SOURCE_HPP
#define OPMS_SOURCES_ARAVIS_SOURCE_HPP

#include <memory>
#include <string>
#include <vector>

#include "frame_source.hpp"
#include "host_clock.hpp"

namespace opms_host {

/** What stands behind "aravis:". */
struct AravisPlace {
    std::string name;    /**< name, id, IP address or host name; empty: the first camera */
    std::string trigger; /**< input, such as "Line1"; empty: Line0, else the first line */
    std::string format;  /**< "Mono12"; empty: as it is if grey, else Mono8 */
};

/** "[NAME-OR-ID][,trigger=LINE][,format=FORMAT]". @return Whether it has that form. */
bool aravis_place_parse(const std::string &text, AravisPlace &place, std::string &error);

/** @param wait_for_missing  A camera that is not there is sought from then on instead.
 * @return NULL on failure. */
std::unique_ptr<FrameSource> open_aravis_source(const AravisPlace &place, bool wait_for_missing,
                                                std::shared_ptr<HostClock> clock,
                                                std::string &error);

/** A camera that is there. */
struct AravisEntry {
    std::string id, model, protocol, address;
};

/** @param[out] problem  What stands in the way; empty: nothing. */
std::vector<AravisEntry> list_aravis(std::string &problem);

}  // namespace opms_host
#endif
