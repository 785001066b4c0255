/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What can go wrong between the host and a Pico, so that a caller can choose an exit code. */
#ifndef OPMS_FLASH_FLASH_ERROR_HPP
#define OPMS_FLASH_FLASH_ERROR_HPP

#include <stdexcept>
#include <string>

namespace opms::flash {

enum class Fault {
    no_device,  /**< neither a box nor a bootloader is there */
    several,    /**< more than one, and nothing says which */
    permission, /**< the system does not let this user open it */
    gone,       /**< unplugged, or it stopped answering, half-way */
    refused,    /**< the bootloader or the box said no */
    verify,     /**< the flash does not hold what was written */
    no_return   /**< written and verified, but no box came back */
};

class FlashError : public std::runtime_error {
public:
    FlashError(Fault fault, const std::string &text) : std::runtime_error(text), fault_(fault) {}
    Fault fault() const { return fault_; }

private:
    Fault fault_;
};

}  // namespace opms::flash

#endif
