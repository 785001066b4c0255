/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the host asks the box to do: COMMAND and BOOTLOADER. */
#include "wire_bytes.h"
#include "wire_frame.h"

enum { OPCODE = 2, ARGUMENT = 4, MAGIC = 4 };

/* Not text, not all ones or zeros, no counter: nothing comes here by mistake. */
static const uint32_t bootloader_magic = 0xB0075E1F;

void opms_wire_write_command(const opms_command_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_COMMAND);
    bytes[OPCODE] = (uint8_t)report->opcode;
    put_u32(bytes + ARGUMENT, report->argument);
    wire_seal(bytes);
}

static bool is_command(uint8_t opcode, uint32_t argument)
{
    switch (opcode) {
    case OPMS_COMMAND_PING: return true;
    case OPMS_COMMAND_ARM: return argument != 0;
    case OPMS_COMMAND_DISARM: return argument == 0;
    default: return false;
    }
}

opms_wire_result_t opms_wire_read_command(const uint8_t *bytes, size_t size,
                                          opms_command_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_COMMAND);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    if (!is_command(bytes[OPCODE], get_u32(bytes + ARGUMENT))) {
        return OPMS_WIRE_VALUE;
    }
    const opms_command_report_t got = {(opms_command_opcode_t)bytes[OPCODE],
                                       get_u32(bytes + ARGUMENT)};
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_command(&got, again);
    if (!wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}

void opms_wire_write_bootloader(uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_BOOTLOADER);
    put_u32(bytes + MAGIC, bootloader_magic);
    wire_seal(bytes);
}

opms_wire_result_t opms_wire_read_bootloader(const uint8_t *bytes, size_t size)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_BOOTLOADER);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    uint8_t right[OPMS_WIRE_SIZE];
    opms_wire_write_bootloader(right);
    return wire_same(bytes, right) ? OPMS_WIRE_OK : OPMS_WIRE_VALUE;
}
