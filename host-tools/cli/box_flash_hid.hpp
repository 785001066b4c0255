/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The running boxes, as `opms box flash` needs them. */
#ifndef OPMS_CLI_BOX_FLASH_HID_HPP
#define OPMS_CLI_BOX_FLASH_HID_HPP

#include "flash_session.hpp"

/** Through opms::hid; without it none is ever seen, and only Picos that are in their bootloader
 * already can be flashed. */
class HidBoxes : public opms::flash::Boxes {
public:
    std::vector<std::string> list() override;
    void enter_bootloader(const std::string &unique_id) override;
    opms::flash::BoxVersion version(const std::string &unique_id) override;
};

#endif
