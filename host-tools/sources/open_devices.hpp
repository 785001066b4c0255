/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From the texts of --box and --source to the devices that they mean.
 *
 *     --box     hid[:ID] | emulated[:PORT] | replay:PATH | simulated[:KEY=VALUE,...] | none
 *     --source  aravis:[NAME-OR-ID] | v4l2:/dev/videoN | replay:PATH | simulated[:KEY=VALUE,...] |
 *               preview:N | none */
#ifndef OPMS_SOURCES_OPEN_DEVICES_HPP
#define OPMS_SOURCES_OPEN_DEVICES_HPP

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices.hpp"

namespace opms_host {

/** What kind of failure it is: they have exit codes of their own. */
enum class OpenFailure { none, usage, device, input };

struct OpenError {
    OpenFailure kind = OpenFailure::none;
    std::string text; /**< one line: what, and what to try */
};

/** What the simulated world shall stand in for; one world serves both. */
struct SimulatedRequest {
    /** Text behind "simulated:" of each; none where that one is not simulated. */
    std::optional<std::string> box_options, source_options;
    /** A box that is not simulated, for the simulated camera to follow; its text and place. */
    std::string box_text;
    opms_box_options_t box_place{};
};

/** Makes what is asked for: sets devices.clock (where it needs its own) and devices.box or .source
 * or both. devices.box is there already where the box is not simulated: it may be wrapped.
 * @return false with @p error. */
using SimulatedFactory =
    std::function<bool(const SimulatedRequest &request, Devices &devices, OpenError &error)>;

struct OpenRequest {
    std::string box = "hid";      /**< "" or "none": without a box */
    std::string source = "aravis:"; /**< "" or "none": without a camera */
    /** A box or camera that is not there yet is sought from then on instead of failing. */
    bool wait_for_missing = false;
    SimulatedFactory simulated;   /**< empty: this program has no simulated world */
};

/** Open box and camera. @return false with @p error; @p devices is empty then. */
bool open_devices(const OpenRequest &request, Devices &devices, OpenError &error);

/** Whether a text has the form of a source or a box; for a command line, before anything is opened.
 * @return Empty, or what is wrong with it. */
std::string source_text_problem(const std::string &text);
std::string box_text_problem(const std::string &text);

/** A camera that is there now. */
struct SourceEntry {
    std::string text;   /**< what --source takes */
    std::string model;  /**< maker, model, serial number */
    std::string notes;  /**< what stands in the way, or what it can do */
};

/** Cameras of Aravis and of V4L2. @param[out] problems  Lines for people: what could not be looked
 * at, or is not part of this build. */
std::vector<SourceEntry> list_sources(std::vector<std::string> &problems);

}  // namespace opms_host
#endif
