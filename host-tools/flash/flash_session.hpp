/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From a running box, or a Pico that waits as a bootloader, to a box that runs the new firmware.
 *
 * Devices are seen through interfaces: the program gives real ones (UsbBootloaders and opms::hid),
 * tests give their own. */
#ifndef OPMS_FLASH_FLASH_SESSION_HPP
#define OPMS_FLASH_FLASH_SESSION_HPP

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "flash_error.hpp"
#include "flash_write.hpp"

namespace opms::flash {

/** Where a bootloader is plugged in; all of them carry the same serial number. */
struct Place {
    int bus = 0;
    int address = 0;  /**< another one each time it enumerates */
    std::string port; /**< such as "2.3": third port of the hub in the second port */

    std::string name() const { return "bus " + std::to_string(bus) + ", port " + port; }
    bool operator==(const Place &o) const { return bus == o.bus && address == o.address; }
};

/** One bootloader, open. */
class Bootloader : public FlashTarget {
public:
    virtual void reboot() = 0;
};

/** All Picos that wait as bootloaders. */
class Bootloaders {
public:
    virtual ~Bootloaders() = default;
    virtual std::vector<Place> list() = 0;
    virtual std::unique_ptr<Bootloader> open(const Place &place) = 0;
};

/** What a running box says of itself. */
struct BoxVersion {
    std::string unique_id;
    std::string firmware; /**< such as "0.2.0" */
    std::string git_hash;
};

/** All boxes that run. */
class Boxes {
public:
    virtual ~Boxes() = default;
    virtual std::vector<std::string> list() = 0; /**< unique ids */
    virtual void enter_bootloader(const std::string &unique_id) = 0;
    virtual BoxVersion version(const std::string &unique_id) = 0;
};

struct SessionOptions {
    std::string box_id;     /**< empty: the only one; upper or lower case */
    bool may_enter = true;  /**< false: only a Pico that is in the bootloader already */
    bool sees_boxes = true; /**< false: running boxes cannot be seen, so none is waited for */
};

/** How a session speaks to whoever watches, and how it waits. */
struct SessionHooks {
    std::function<void(const std::string &)> talk;
    Progress progress;
    std::function<void(int)> sleep_ms;
};

constexpr int SESSION_POLL_MS = 100;
constexpr int SESSION_ENTER_MS = 8000;   /**< for a box to come up as a bootloader */
constexpr int SESSION_RETURN_MS = 15000; /**< for a flashed box to come back */
constexpr int SESSION_SETTLE_MS = 2000;  /**< for the system to let us open what has come up */

/** Flash one box and wait until it is back. @return What it then says of itself
 * (nothing, unless options.sees_boxes).
 * @throws FlashError; nothing was erased where its fault is no_device, several or permission. */
BoxVersion flash_session(const Image &image, const SessionOptions &options,
                         Bootloaders &bootloaders, Boxes &boxes, const SessionHooks &hooks);

}  // namespace opms::flash

#endif
