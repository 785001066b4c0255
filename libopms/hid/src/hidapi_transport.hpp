/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The box on USB, by hidapi: the only file that knows hidapi is hidapi_transport.cpp. */
#ifndef OPMS_HID_HIDAPI_TRANSPORT_HPP
#define OPMS_HID_HIDAPI_TRANSPORT_HPP

#include <memory>
#include <vector>

#include "box_transport.hpp"

namespace opms_hid {

std::unique_ptr<BoxTransport> make_hidapi_transport();

/** All boxes that are plugged in. */
std::vector<opms_box_entry_t> list_hidapi_boxes();

} // namespace opms_hid

#endif
