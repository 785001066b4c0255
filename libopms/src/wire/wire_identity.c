/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_bytes.h"
#include "wire_frame.h"

enum {
    CAPABILITIES = 2,
    MAGIC = 4,
    HARDWARE = 8,
    FIRMWARE = 10,
    FLAGS = 13,
    START_CYCLES = 14,
    UNIQUE_ID = 16,
    UNIQUE_ID_SIZE = 8,
    GIT_HASH = 24,
    GIT_HASH_SIZE = 20,
    CLOCK_HZ = 44,
    RING_ENTRIES = 48,
    HISTORY_ENTRIES = 50,
    BOOT = 52
};

enum {
    FLAG_MODIFIED = 1U << 0,
    CAPABILITIES_ALL = OPMS_CAPABILITY_STROBE | OPMS_CAPABILITY_SYNC | OPMS_CAPABILITY_HISTORY |
                       OPMS_CAPABILITY_BOOTLOADER
};

static const uint8_t magic[4] = {'O', 'P', 'M', 'S'};

static void copy(uint8_t *to, const uint8_t *from, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        to[i] = from[i];
    }
}

void opms_wire_write_identity(const opms_identity_report_t *report, uint8_t *bytes)
{
    wire_begin(bytes, OPMS_REPORT_IDENTITY);
    put_u16(bytes + CAPABILITIES, report->capabilities);
    copy(bytes + MAGIC, magic, sizeof magic);
    put_u16(bytes + HARDWARE, report->hardware_version);
    copy(bytes + FIRMWARE, report->firmware_version, sizeof report->firmware_version);
    bytes[FLAGS] = report->firmware_modified ? FLAG_MODIFIED : 0;
    put_u16(bytes + START_CYCLES, report->start_cycles);
    copy(bytes + UNIQUE_ID, report->unique_id, UNIQUE_ID_SIZE);
    for (size_t i = 0; i < GIT_HASH_SIZE; i++) {
        bytes[GIT_HASH + i] = (uint8_t)report->git_hash[i];
    }
    put_u32(bytes + CLOCK_HZ, report->clock_hz);
    put_u16(bytes + RING_ENTRIES, report->ring_entries);
    put_u16(bytes + HISTORY_ENTRIES, report->history_entries);
    put_u32(bytes + BOOT, report->boot_id);
    wire_seal(bytes);
}

static opms_identity_report_t decode_identity(const uint8_t *bytes)
{
    opms_identity_report_t report = {
        .hardware_version = get_u16(bytes + HARDWARE),
        .firmware_modified = (bytes[FLAGS] & FLAG_MODIFIED) != 0,
        .capabilities = get_u16(bytes + CAPABILITIES),
        .boot_id = get_u32(bytes + BOOT),
        .clock_hz = get_u32(bytes + CLOCK_HZ),
        .start_cycles = get_u16(bytes + START_CYCLES),
        .ring_entries = get_u16(bytes + RING_ENTRIES),
        .history_entries = get_u16(bytes + HISTORY_ENTRIES),
    };
    copy(report.firmware_version, bytes + FIRMWARE, sizeof report.firmware_version);
    copy(report.unique_id, bytes + UNIQUE_ID, UNIQUE_ID_SIZE);
    for (size_t i = 0; i < GIT_HASH_SIZE; i++) {
        report.git_hash[i] = (char)bytes[GIT_HASH + i];
    }
    return report;
}

static bool is_hash(const char *hash)
{
    for (size_t i = 0; i < GIT_HASH_SIZE; i++) {
        const char c = hash[i];
        if (!((c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'))) {
            return false;
        }
    }
    return true;
}

opms_wire_result_t opms_wire_read_identity(const uint8_t *bytes, size_t size,
                                           opms_identity_report_t *report)
{
    const opms_wire_result_t result = wire_open(bytes, size, OPMS_REPORT_IDENTITY);
    if (result != OPMS_WIRE_OK) {
        return result;
    }
    const opms_identity_report_t got = decode_identity(bytes);
    uint8_t again[OPMS_WIRE_SIZE];
    opms_wire_write_identity(&got, again);
    if (got.boot_id == 0 || got.clock_hz == 0 || got.capabilities > CAPABILITIES_ALL ||
        !is_hash(got.git_hash) || !wire_same(bytes, again)) {
        return OPMS_WIRE_VALUE;
    }
    if (report != NULL) {
        *report = got;
    }
    return OPMS_WIRE_OK;
}
