/* SPDX-License-Identifier: Apache-2.0 */
#include "picoboot_protocol.hpp"

#include <cinttypes>
#include <cstdio>

#include "little_endian.hpp"

namespace opms::flash {

namespace {

constexpr std::uint32_t MAGIC = 0x431FD10B;
constexpr std::uint32_t EXCLUSIVE = 1;

}  // namespace

Command command_exclusive_access()
{
    return {CommandId::exclusive_access, 1, {EXCLUSIVE}, 0};
}

Command command_exit_xip()
{
    return {CommandId::exit_xip, 0, {}, 0};
}

Command command_flash_erase(std::uint32_t address, std::uint32_t size)
{
    return {CommandId::flash_erase, 8, {address, size}, 0};
}

Command command_write(std::uint32_t address, std::uint32_t size)
{
    return {CommandId::write, 8, {address, size}, size};
}

Command command_read(std::uint32_t address, std::uint32_t size)
{
    return {CommandId::read, 8, {address, size}, size};
}

Command command_reboot(std::uint32_t delay_ms)
{
    /* Program counter 0: boot as after power-on. The stack pointer is for programs in RAM. */
    return {CommandId::reboot, 12, {0, 0, delay_ms}, 0};
}

std::array<std::uint8_t, PICOBOOT_COMMAND_BYTES> command_bytes(const Command &command,
                                                               std::uint32_t token)
{
    std::array<std::uint8_t, PICOBOOT_COMMAND_BYTES> bytes{};
    put_u32(&bytes[0], MAGIC);
    put_u32(&bytes[4], token);
    bytes[8] = static_cast<std::uint8_t>(command.id);
    bytes[9] = command.argument_bytes;
    put_u32(&bytes[12], command.transfer_bytes);
    for (std::size_t i = 0; i < command.arguments.size(); ++i) {
        put_u32(&bytes[16 + 4 * i], command.arguments[i]);
    }
    return bytes;
}

std::string command_name(const Command &command)
{
    char text[40];
    const char *name = "";
    switch (command.id) {
    case CommandId::exclusive_access: return "EXCLUSIVE_ACCESS";
    case CommandId::reboot: return "REBOOT";
    case CommandId::exit_xip: return "EXIT_XIP";
    case CommandId::flash_erase: name = "FLASH_ERASE"; break;
    case CommandId::write: name = "WRITE"; break;
    case CommandId::read: name = "READ"; break;
    }
    std::snprintf(text, sizeof text, "%s at 0x%08" PRIX32, name, command.arguments[0]);
    return text;
}

CommandStatus status_parse(const std::array<std::uint8_t, PICOBOOT_STATUS_BYTES> &bytes)
{
    return {u32_at(&bytes[0]), u32_at(&bytes[4]), bytes[8], bytes[9] != 0};
}

std::string status_name(std::uint32_t code)
{
    static const char *const names[] = {
        "no error",    "unknown command", "wrong length of the command",
        "wrong length of the data",       "bad address",
        "bad alignment", "interleaved write", "rebooting",
        "unknown error"};
    if (code < sizeof names / sizeof *names) {
        return names[code];
    }
    return "status " + std::to_string(code);
}

}  // namespace opms::flash
