/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Picos that wait as bootloaders, over libusb. */
#ifndef OPMS_FLASH_PICOBOOT_USB_HPP
#define OPMS_FLASH_PICOBOOT_USB_HPP

#include "flash_session.hpp"

namespace opms::flash {

/** Looks anew at each call, so that it follows what is plugged in and out. */
class UsbBootloaders : public Bootloaders {
public:
    std::vector<Place> list() override;
    /** Ready to be written: reset, and closed to writers through its USB drive. */
    std::unique_ptr<Bootloader> open(const Place &place) override;
};

}  // namespace opms::flash

#endif
