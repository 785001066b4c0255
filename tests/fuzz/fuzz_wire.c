/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a report: a reader that takes them says the same again when it writes, and no other
 * reader takes them. The bytes are tried as they are and, because hardly any would have it, with id
 * and version as they were and the right CRC. make_wire_corpus.py writes seeds. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <opms/wire.h>

static void require(int holds)
{
    if (!holds) {
        abort();
    }
}

/* Reads `bytes`, and if that went well writes them again into `again`. */
#define ROUND_TRIP(kind, type)                                                                     \
    static opms_wire_result_t round_trip_##kind(const uint8_t *bytes, size_t size, uint8_t *again) \
    {                                                                                              \
        type report;                                                                               \
        const opms_wire_result_t result = opms_wire_read_##kind(bytes, size, &report);             \
        require(result == opms_wire_read_##kind(bytes, size, NULL));                               \
        if (result == OPMS_WIRE_OK) {                                                              \
            opms_wire_write_##kind(&report, again);                                                \
        }                                                                                          \
        return result;                                                                             \
    }

ROUND_TRIP(trigger, opms_trigger_report_t)
ROUND_TRIP(pong, opms_pong_report_t)
ROUND_TRIP(status, opms_status_report_t)
ROUND_TRIP(event, opms_event_report_t)
ROUND_TRIP(command, opms_command_report_t)
ROUND_TRIP(identity, opms_identity_report_t)
ROUND_TRIP(settings, opms_settings_report_t)
ROUND_TRIP(settings_set, opms_settings_t)
ROUND_TRIP(history_request, opms_history_request_t)
ROUND_TRIP(history, opms_history_report_t)

static opms_wire_result_t round_trip_bootloader(const uint8_t *bytes, size_t size, uint8_t *again)
{
    opms_wire_write_bootloader(again);
    return opms_wire_read_bootloader(bytes, size);
}

static const struct {
    uint8_t id;
    opms_wire_result_t (*round_trip)(const uint8_t *bytes, size_t size, uint8_t *again);
} kinds[] = {
    {OPMS_REPORT_TRIGGER, round_trip_trigger},
    {OPMS_REPORT_PONG, round_trip_pong},
    {OPMS_REPORT_STATUS, round_trip_status},
    {OPMS_REPORT_EVENT, round_trip_event},
    {OPMS_REPORT_COMMAND, round_trip_command},
    {OPMS_REPORT_IDENTITY, round_trip_identity},
    {OPMS_REPORT_SETTINGS, round_trip_settings},
    {OPMS_REPORT_SETTINGS, round_trip_settings_set},
    {OPMS_REPORT_HISTORY, round_trip_history_request},
    {OPMS_REPORT_HISTORY, round_trip_history},
    {OPMS_REPORT_BOOTLOADER, round_trip_bootloader},
};

static void check_kind(size_t kind, const uint8_t *bytes, size_t size)
{
    uint8_t id = 0, again[OPMS_WIRE_SIZE] = {0};
    const opms_wire_result_t checked = opms_wire_check(bytes, size, &id);
    const opms_wire_result_t result = kinds[kind].round_trip(bytes, size, again);
    if (result == OPMS_WIRE_OK) {
        require(memcmp(bytes, again, OPMS_WIRE_SIZE) == 0);
    }
    if (size == OPMS_WIRE_SIZE && id != kinds[kind].id) {
        require(result == OPMS_WIRE_ID);
    } else if (checked != OPMS_WIRE_OK) {
        require(result == checked);
    } else {
        require(result == OPMS_WIRE_OK || result == OPMS_WIRE_VALUE);
    }
    require(strcmp(opms_wire_result_name(result), "unknown") != 0);
}

static void check_all(const uint8_t *bytes, size_t size)
{
    for (size_t kind = 0; kind < sizeof kinds / sizeof kinds[0]; kind++) {
        check_kind(kind, bytes, size);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_all(data, size);
    if (size < OPMS_WIRE_SIZE - 2) {
        return 0;
    }
    uint8_t sealed[OPMS_WIRE_SIZE];
    memcpy(sealed, data, OPMS_WIRE_SIZE - 2);
    const uint16_t crc = opms_wire_crc16(sealed, OPMS_WIRE_SIZE - 2);
    sealed[OPMS_WIRE_SIZE - 2] = (uint8_t)crc;
    sealed[OPMS_WIRE_SIZE - 1] = (uint8_t)(crc >> 8);
    check_all(sealed, sizeof sealed);
    return 0;
}
