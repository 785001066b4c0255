/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What an opms_box_t is. */
#ifndef OPMS_HID_BOX_HANDLE_HPP
#define OPMS_HID_BOX_HANDLE_HPP

#include "box_core.hpp"
#include "emulated_transport.hpp"

struct opms_box {
    std::shared_ptr<opms_hid::BoxCore> core;
    opms_hid::EmulatedTransport *emulated; /**< the core's transport, or NULL with another one */
};

#endif
