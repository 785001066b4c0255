/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the calls that talk to the box share. */
#ifndef OPMS_HID_BOX_CALLS_HPP
#define OPMS_HID_BOX_CALLS_HPP

#include "box_transport.hpp"

namespace opms_hid {

constexpr uint32_t CALL_TIMEOUT_MS = 2000;

inline Clock::time_point deadline_of(uint32_t timeout_ms, uint32_t usual_ms = CALL_TIMEOUT_MS)
{
    return Clock::now() + std::chrono::milliseconds(timeout_ms ? timeout_ms : usual_ms);
}

} // namespace opms_hid

#endif
