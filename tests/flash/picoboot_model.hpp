/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The RP2040's boot ROM as its USB side shows it (RP2040 datasheet, "USB PICOBOOT Interface"), with
 * a NOR flash behind. Stricter than the ROM: whatever the datasheet does not allow is noted. */
#ifndef TESTS_FLASH_PICOBOOT_MODEL_HPP
#define TESTS_FLASH_PICOBOOT_MODEL_HPP

#include <cstdint>
#include <string>

#include "firmware_bytes.hpp"
#include "nor_flash.hpp"

class PicobootModel {
public:
    static constexpr std::uint8_t ENDPOINT_OUT = 0x03, ENDPOINT_IN = 0x84;
    static constexpr int STALL = -1, NOTHING_YET = -2;

    explicit PicobootModel(std::size_t flash_size) : flash(flash_size) {}

    /** Descriptors as the device gives them: the device's, then the configuration's. */
    static Bytes descriptors();

    /** A packet train to the bulk endpoint. @return bytes taken, or STALL. */
    int bulk_out(const Bytes &bytes);

    /** @return 0 with what it has for the host, STALL, or NOTHING_YET. */
    int bulk_in(std::size_t size, Bytes &bytes);

    /** @param setup 8 bytes. @return bytes for the host (or 0 of an OUT request), or STALL. */
    int control(const Bytes &setup, Bytes &bytes);

    void clear_halt(std::uint8_t endpoint);

    NorFlash flash;
    bool exclusive = false, xip = true, rebooting = false;
    bool powered = true;              /**< false once a flash operation was cut */
    int fail_command = -1;            /**< answer this command with an error, ... */
    std::uint32_t fail_code = 5;      /**< ... this one */
    std::string complaints;           /**< what the host did against the datasheet */
    int commands = 0;

private:
    enum class Phase { command, data_out, data_in, ack_in, ack_out };

    int begin(const Bytes &bytes);
    int start_command();
    int run_command(const Bytes &data);
    int stall(std::uint32_t code);
    bool in_flash(std::uint32_t size_unit);
    void complain(const std::string &what) { complaints += what + "\n"; }

    Phase phase_ = Phase::command;
    bool halted_[2] = {false, false}; /* OUT, IN */
    std::uint32_t token_ = 0, code_ = 0, transfer_ = 0, address_ = 0, size_ = 0;
    std::uint8_t command_ = 0;
    Bytes data_;
};

#endif
