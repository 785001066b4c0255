/* SPDX-License-Identifier: Apache-2.0 */
#include <opms/wire.h>

/* Four bits a step: a table of 32 bytes is small enough for the box, and 124 steps a report fast
 * enough. Entry n is the remainder of n * x^16. */
static const uint16_t remainders[16] = {
    0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50A5, 0x60C6, 0x70E7,
    0x8108, 0x9129, 0xA14A, 0xB16B, 0xC18C, 0xD1AD, 0xE1CE, 0xF1EF,
};

static uint16_t add_nibble(uint16_t crc, unsigned nibble)
{
    return (uint16_t)((uint16_t)(crc << 4) ^ remainders[(crc >> 12) ^ nibble]);
}

uint16_t opms_wire_crc16(const uint8_t *bytes, size_t size)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < size; i++) {
        crc = add_nibble(crc, bytes[i] >> 4);
        crc = add_nibble(crc, bytes[i] & 0x0FU);
    }
    return crc;
}
