/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * PICOBOOT's packets: values <-> bytes, without any USB.
 *
 * The RP2040's boot ROM takes commands of 32 bytes on a bulk endpoint; data follow by the
 * command's direction, and an empty packet the other way ends it (RP2040 datasheet, "USB PICOBOOT
 * Interface"). On an error it stalls, and a control request tells why. */
#ifndef OPMS_FLASH_PICOBOOT_PROTOCOL_HPP
#define OPMS_FLASH_PICOBOOT_PROTOCOL_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace opms::flash {

constexpr std::uint16_t PICOBOOT_VENDOR = 0x2E8A;
constexpr std::uint16_t PICOBOOT_PRODUCT = 0x0003;
constexpr std::uint8_t PICOBOOT_INTERFACE_CLASS = 0xFF;
constexpr std::uint8_t PICOBOOT_REQUEST_RESET = 0x41;
constexpr std::uint8_t PICOBOOT_REQUEST_STATUS = 0x42;
constexpr std::size_t PICOBOOT_COMMAND_BYTES = 32;
constexpr std::size_t PICOBOOT_STATUS_BYTES = 16;

enum class CommandId : std::uint8_t {
    exclusive_access = 0x01,
    reboot = 0x02,
    flash_erase = 0x03,
    write = 0x05,
    exit_xip = 0x06,
    read = 0x84 /**< bit 7: data come from the device */
};

struct Command {
    CommandId id;
    std::uint8_t argument_bytes;
    std::array<std::uint32_t, 4> arguments;
    std::uint32_t transfer_bytes;

    bool is_in() const { return (static_cast<unsigned>(id) & 0x80U) != 0; }
};

Command command_exclusive_access(); /**< no writing through the USB drive meanwhile */
Command command_exit_xip();
Command command_flash_erase(std::uint32_t address, std::uint32_t size);
Command command_write(std::uint32_t address, std::uint32_t size);
Command command_read(std::uint32_t address, std::uint32_t size);
Command command_reboot(std::uint32_t delay_ms); /**< into what the flash holds */

/** @p token comes back in the status. */
std::array<std::uint8_t, PICOBOOT_COMMAND_BYTES> command_bytes(const Command &command,
                                                               std::uint32_t token);

/** For messages: "WRITE at 0x10001000". */
std::string command_name(const Command &command);

struct CommandStatus {
    std::uint32_t token;
    std::uint32_t code; /**< 0: done without an error */
    std::uint8_t command_id;
    bool in_progress;
};

CommandStatus status_parse(const std::array<std::uint8_t, PICOBOOT_STATUS_BYTES> &bytes);

/** What a status code means, e.g. "bad address". */
std::string status_name(std::uint32_t code);

}  // namespace opms::flash

#endif
