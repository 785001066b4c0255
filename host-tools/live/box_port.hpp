/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A trigger box as the live system sees it: real, emulated (opms::hid), simulated, replayed. */
#ifndef OPMS_LIVE_BOX_PORT_HPP
#define OPMS_LIVE_BOX_PORT_HPP

#include <cstdint>
#include <string>

#include <opms/hid.h>
#include <opms/wire.h>

namespace opms_host {

/** Calls may come from any thread at any time; poll() from one thread at a time.
 *
 * Calls that return a bool are false on failure and then set @p error to one line for people. A
 * box that is unplugged is no end: items of OPMS_ITEM_LINK tell of it, and poll() goes on. Gaps are
 * filled by the port itself (items of OPMS_ITEM_HISTORY), pings are sent by it, too. */
class BoxPort {
public:
    virtual ~BoxPort() = default;
    /** For people and recordings: "hid:E660...", "emulated:47653", "simulated". */
    virtual std::string name() const = 0;
    /** The next item; item.kind is OPMS_ITEM_NONE when none came within @p timeout_ms or wake() was
     * called. False only when no more can ever come (the end of a replay). */
    virtual bool poll(uint32_t timeout_ms, opms_box_item_t &item) = 0;
    /** End a poll() that waits, and the next one if none does. */
    virtual void wake() = 0;
    virtual bool arm(uint32_t session_id, std::string &error) = 0;
    virtual bool disarm(std::string &error) = 0;
    virtual bool settings(opms_settings_report_t &report, std::string &error) = 0;
    virtual bool set_settings(const opms_settings_t &settings, std::string &error) = 0;
    /** As read when it was connected last. @return Whether it is connected now. */
    virtual bool identity(opms_identity_report_t &identity) const = 0;
    /** The hardware start by a hand of software: emulated and simulated boxes only. Does not wait;
     * an OPMS_EVENT_START comes as an item. */
    virtual bool press_start(std::string &error) = 0;
};

}  // namespace opms_host
#endif
