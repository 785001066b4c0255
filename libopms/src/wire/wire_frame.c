/* SPDX-License-Identifier: Apache-2.0 */
#include "wire_frame.h"

#include "wire_bytes.h"

enum { CRC_AT = OPMS_WIRE_SIZE - 2 };

void wire_begin(uint8_t *bytes, opms_report_id_t id)
{
    for (size_t i = 0; i < OPMS_WIRE_SIZE; i++) {
        bytes[i] = 0;
    }
    bytes[0] = (uint8_t)id;
    bytes[1] = OPMS_WIRE_PROTOCOL;
}

void wire_seal(uint8_t *bytes)
{
    put_u16(bytes + CRC_AT, opms_wire_crc16(bytes, CRC_AT));
}

bool wire_same(const uint8_t *a, const uint8_t *b)
{
    for (size_t i = 0; i < OPMS_WIRE_SIZE; i++) {
        if (a[i] != b[i]) {
            return false;
        }
    }
    return true;
}

/* The version comes before the CRC: another version may keep its CRC elsewhere. */
static opms_wire_result_t check_version_and_crc(const uint8_t *bytes)
{
    if (bytes[1] != OPMS_WIRE_PROTOCOL) {
        return OPMS_WIRE_VERSION;
    }
    return get_u16(bytes + CRC_AT) == opms_wire_crc16(bytes, CRC_AT) ? OPMS_WIRE_OK : OPMS_WIRE_CRC;
}

opms_wire_result_t wire_open(const uint8_t *bytes, size_t size, opms_report_id_t id)
{
    if (bytes == NULL || size != OPMS_WIRE_SIZE) {
        return OPMS_WIRE_LENGTH;
    }
    return bytes[0] == id ? check_version_and_crc(bytes) : OPMS_WIRE_ID;
}

static bool is_known(uint8_t id)
{
    switch (id) {
    case OPMS_REPORT_TRIGGER:
    case OPMS_REPORT_PONG:
    case OPMS_REPORT_STATUS:
    case OPMS_REPORT_EVENT:
    case OPMS_REPORT_COMMAND:
    case OPMS_REPORT_IDENTITY:
    case OPMS_REPORT_SETTINGS:
    case OPMS_REPORT_HISTORY:
    case OPMS_REPORT_BOOTLOADER: return true;
    default: return false;
    }
}

opms_wire_result_t opms_wire_check(const uint8_t *bytes, size_t size, uint8_t *id)
{
    if (id != NULL) {
        *id = bytes != NULL && size > 0 ? bytes[0] : 0;
    }
    if (bytes == NULL || size != OPMS_WIRE_SIZE) {
        return OPMS_WIRE_LENGTH;
    }
    return is_known(bytes[0]) ? check_version_and_crc(bytes) : OPMS_WIRE_ID;
}
