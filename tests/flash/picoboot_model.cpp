/* SPDX-License-Identifier: Apache-2.0 */
#include "picoboot_model.hpp"

namespace {

enum { EXCLUSIVE = 0x01, REBOOT = 0x02, ERASE = 0x03, WRITE = 0x05, EXIT_XIP = 0x06, READ = 0x84 };
enum { UNKNOWN_COMMAND = 1, BAD_COMMAND_LENGTH = 2, BAD_TRANSFER = 3, BAD_ADDRESS = 4,
       BAD_ALIGNMENT = 5 };
constexpr std::uint32_t MAGIC = 0x431FD10B;

/** Length of a command's arguments; -1: no such command. */
int argument_bytes(std::uint8_t command)
{
    switch (command) {
    case EXCLUSIVE: return 1;
    case REBOOT: return 12;
    case ERASE:
    case WRITE:
    case READ: return 8;
    case EXIT_XIP: return 0;
    default: return -1;
    }
}

}  // namespace

Bytes PicobootModel::descriptors()
{
    return {/* device: USB 1.1, 2e8a:0003 */
            18, 1, 0x10, 0x01, 0, 0, 0, 64, 0x8A, 0x2E, 0x03, 0x00, 0x00, 0x01, 1, 2, 3, 1,
            /* configuration of 55 bytes with two interfaces */
            9, 2, 55, 0, 2, 1, 0, 0x80, 250,
            /* mass storage */
            9, 4, 0, 0, 2, 8, 6, 0x50, 0, 7, 5, 0x81, 2, 64, 0, 0, 7, 5, 0x02, 2, 64, 0, 0,
            /* PICOBOOT */
            9, 4, 1, 0, 2, 0xFF, 0, 0, 0, 7, 5, 0x03, 2, 64, 0, 0, 7, 5, 0x84, 2, 64, 0, 0};
}

int PicobootModel::stall(std::uint32_t code)
{
    code_ = code;
    phase_ = Phase::command;
    halted_[0] = halted_[1] = true;
    return STALL;
}

int PicobootModel::begin(const Bytes &bytes)
{
    if (bytes.size() != 32 || get_u32(bytes, 0) != MAGIC) {
        complain("a command of " + std::to_string(bytes.size()) + " bytes or without its magic");
        return stall(UNKNOWN_COMMAND);
    }
    ++commands;
    token_ = get_u32(bytes, 4);
    command_ = bytes[8];
    transfer_ = get_u32(bytes, 12);
    address_ = get_u32(bytes, 16);
    size_ = get_u32(bytes, 20);
    code_ = 0;
    if (bytes[10] != 0 || bytes[11] != 0) {
        complain("reserved bytes are not 0");
    }
    if (argument_bytes(command_) < 0) {
        return stall(UNKNOWN_COMMAND);
    }
    if (bytes[9] != argument_bytes(command_)) {
        return stall(BAD_COMMAND_LENGTH);
    }
    if (command_ == EXCLUSIVE) {
        exclusive = bytes[16] != 0;
    }
    return command_ == fail_command ? stall(fail_code) : start_command();
}

bool PicobootModel::in_flash(std::uint32_t size_unit)
{
    if (address_ < TEST_FLASH || size_ > flash.bytes.size() ||
        address_ - TEST_FLASH > flash.bytes.size() - size_) {
        stall(BAD_ADDRESS);
        return false;
    }
    if (address_ % size_unit != 0 || size_ % size_unit != 0) {
        stall(BAD_ALIGNMENT);
        return false;
    }
    return true;
}

int PicobootModel::start_command()
{
    const bool has_data = command_ == WRITE || command_ == READ;
    if (transfer_ != (has_data ? size_ : 0)) {
        return stall(BAD_TRANSFER);
    }
    if (has_data || command_ == ERASE) {
        if (!in_flash(command_ == ERASE ? 4096 : command_ == WRITE ? 256 : 1)) {
            return STALL;
        }
        if (xip || !exclusive) {
            complain("flash is touched before EXIT_XIP and EXCLUSIVE_ACCESS");
        }
    }
    if (command_ == WRITE) {
        phase_ = Phase::data_out;
        return 32;
    }
    return run_command({}) == STALL ? STALL : 32;
}

int PicobootModel::run_command(const Bytes &data)
{
    const std::uint32_t offset = address_ - TEST_FLASH;
    phase_ = Phase::ack_in;
    switch (command_) {
    case EXIT_XIP: xip = false; break;
    case REBOOT: rebooting = true; break;
    case ERASE:
        for (std::uint32_t i = 0; i < size_ && powered; i += 4096) {
            powered = flash.erase_sector(offset + i);
        }
        break;
    case WRITE:
        for (std::uint32_t i = 0; i < size_ && powered; i += 256) {
            powered = flash.program_page(offset + i, data.data() + i);
        }
        break;
    case READ:
        data_.assign(flash.bytes.begin() + offset, flash.bytes.begin() + offset + size_);
        phase_ = Phase::data_in;
        break;
    default: break;
    }
    return 0;
}

int PicobootModel::bulk_out(const Bytes &bytes)
{
    if (halted_[0]) {
        return STALL;
    }
    switch (phase_) {
    case Phase::command: return begin(bytes);
    case Phase::data_out:
        data_.insert(data_.end(), bytes.begin(), bytes.end());
        if (data_.size() < transfer_) {
            return static_cast<int>(bytes.size());
        }
        if (data_.size() > transfer_) {
            complain("more data than announced");
        }
        run_command(data_);
        data_.clear();
        return static_cast<int>(bytes.size());
    case Phase::ack_out:
        if (!bytes.empty()) {
            complain("the packet that ends a READ is not empty");
        }
        phase_ = Phase::command;
        return static_cast<int>(bytes.size());
    default: complain("data go out where the device has something to say"); return stall(8);
    }
}

int PicobootModel::bulk_in(std::size_t size, Bytes &bytes)
{
    if (halted_[1]) {
        return STALL;
    }
    if (phase_ == Phase::data_in) {
        if (size != data_.size()) {
            complain("a READ is not fetched as a whole");
        }
        bytes.swap(data_);
        data_.clear();
        phase_ = Phase::ack_out;
        return 0;
    }
    if (phase_ == Phase::ack_in) {
        bytes.clear();
        phase_ = Phase::command;
        return 0;
    }
    return NOTHING_YET;
}

int PicobootModel::control(const Bytes &setup, Bytes &bytes)
{
    const bool our_interface = setup[4] == 1 && setup[5] == 0;
    if (setup[0] == 0x41 && setup[1] == 0x41 && our_interface) {
        halted_[0] = halted_[1] = false;
        phase_ = Phase::command;
        exclusive = false;
        data_.clear();
        return 0;
    }
    if (setup[0] == 0xC1 && setup[1] == 0x42 && our_interface && setup[6] == 16) {
        bytes.assign(16, 0);
        set_u32(bytes, 0, token_);
        set_u32(bytes, 4, code_);
        bytes[8] = command_;
        return 16;
    }
    return STALL;
}

void PicobootModel::clear_halt(std::uint8_t endpoint)
{
    halted_[endpoint == ENDPOINT_IN] = false;
}
