/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From "simulated:key=value,..." to the devices of a simulated world. */
#ifndef OPMS_SIMULATED_SIMULATED_FACTORY_HPP
#define OPMS_SIMULATED_SIMULATED_FACTORY_HPP

#include <string>

#include "open_devices.hpp"
#include "world_options.hpp"

namespace opms_host {

/** Put this into OpenRequest::simulated. Box and camera make one world where both are simulated; a
 * simulated camera beside an emulated box follows that one's TRIG (docs/emulated-box.md). */
bool simulated_devices(const SimulatedRequest &request, Devices &devices, OpenError &error);

/** Options by "key=value,key=value" (docs/simulated.md), added to what @p options holds.
 * @return Empty, or what is wrong with the text. */
std::string simulated_options_parse(const std::string &text, WorldOptions &options);

/** A line for each key, for --help and messages. */
std::string simulated_options_help();

}  // namespace opms_host
#endif
