/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A real or an emulated trigger box, by opms::hid. */
#ifndef OPMS_SOURCES_HID_BOX_HPP
#define OPMS_SOURCES_HID_BOX_HPP

#include <memory>
#include <string>

#include "box_port.hpp"

namespace opms_host {

/** Open the box at @p place. Its times are of CLOCK_MONOTONIC.
 *
 * @param wait_for_missing  A box that is not there is no failure: it is sought from then on.
 * @param[out] error  One line for people.
 * @return NULL on failure. */
std::unique_ptr<BoxPort> open_hid_box(const opms_box_options_t &place, bool wait_for_missing,
                                      std::string &error);

}  // namespace opms_host
#endif
