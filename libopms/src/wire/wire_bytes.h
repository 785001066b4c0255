/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Little-endian integers at a place in a report, whatever the machine's own byte order. */
#ifndef OPMS_WIRE_BYTES_H
#define OPMS_WIRE_BYTES_H

#include <stdint.h>

#include <opms/wire.h>

static inline void put_u16(uint8_t *at, uint16_t value)
{
    at[0] = (uint8_t)value;
    at[1] = (uint8_t)(value >> 8);
}

static inline void put_u24(uint8_t *at, uint32_t value)
{
    put_u16(at, (uint16_t)value);
    at[2] = (uint8_t)(value >> 16);
}

static inline void put_u32(uint8_t *at, uint32_t value)
{
    put_u16(at, (uint16_t)value);
    put_u16(at + 2, (uint16_t)(value >> 16));
}

static inline void put_u64(uint8_t *at, uint64_t value)
{
    put_u32(at, (uint32_t)value);
    put_u32(at + 4, (uint32_t)(value >> 32));
}

static inline uint16_t get_u16(const uint8_t *at)
{
    return (uint16_t)(at[0] | (uint16_t)(at[1] << 8));
}

static inline uint32_t get_u24(const uint8_t *at)
{
    return get_u16(at) | (uint32_t)at[2] << 16;
}

static inline uint32_t get_u32(const uint8_t *at)
{
    return get_u16(at) | (uint32_t)get_u16(at + 2) << 16;
}

static inline uint64_t get_u64(const uint8_t *at)
{
    return get_u32(at) | (uint64_t)get_u32(at + 4) << 32;
}

/** The two parts of a box time stand apart in most reports. */
static inline void put_time(uint8_t *us, uint8_t *cycles, opms_box_time_t time)
{
    put_u64(us, time.us);
    *cycles = time.cycles;
}

static inline opms_box_time_t get_time(const uint8_t *us, const uint8_t *cycles)
{
    opms_box_time_t time = {get_u64(us), *cycles};
    return time;
}

static inline bool is_time(opms_box_time_t time)
{
    return time.cycles < OPMS_BOX_CYCLES_PER_US;
}

#endif
