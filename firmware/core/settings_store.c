/* SPDX-License-Identifier: Apache-2.0 */
#include "settings_store.h"

#include <string.h>

#define PAGES (STORE_SECTORS * STORE_SECTOR_SIZE / STORE_PAGE_SIZE)
#define PAGES_PER_SECTOR (STORE_SECTOR_SIZE / STORE_PAGE_SIZE)

/* A record: magic, its number in the log, the settings as a SET report, CRC-32 of all that. */
#define MAGIC 0x54455342U /* "BSET" */
#define AT_SEQUENCE 4
#define AT_SETTINGS 8
#define AT_CRC (AT_SETTINGS + OPMS_WIRE_SIZE)
#define RECORD_SIZE (AT_CRC + 4)

typedef struct record {
    uint32_t page;
    uint32_t sequence;
    opms_settings_t settings;
} record_t;

/* CRC-32 (polynomial 0xEDB88320, reflected), bit by bit: a record is 72 bytes. */
static uint32_t crc32(const uint8_t *bytes, uint32_t size)
{
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 0; i < size; i++) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
    return ~crc;
}

static uint32_t get32(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

static void put32(uint8_t *bytes, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> (8 * i));
}

static bool read_record(const store_flash_t *flash, uint32_t page, record_t *record)
{
    uint8_t bytes[RECORD_SIZE];
    flash->read(flash->context, page * STORE_PAGE_SIZE, bytes, sizeof bytes);
    if (get32(bytes) != MAGIC || get32(bytes + AT_CRC) != crc32(bytes, AT_CRC))
        return false;
    record->page = page;
    record->sequence = get32(bytes + AT_SEQUENCE);
    /* A record of another protocol version, or out of range, is none of ours. */
    return opms_wire_read_settings_set(bytes + AT_SETTINGS, OPMS_WIRE_SIZE, &record->settings) ==
               OPMS_WIRE_OK &&
           opms_wire_check_settings(&record->settings) == NULL;
}

static bool find_newest(const store_flash_t *flash, record_t *newest)
{
    bool found = false;
    for (uint32_t page = 0; page < PAGES; page++) {
        record_t record;
        if (!read_record(flash, page, &record))
            continue;
        if (!found || record.sequence - newest->sequence < UINT32_MAX / 2)
            *newest = record;
        found = true;
    }
    return found;
}

static bool is_blank(const store_flash_t *flash, uint32_t page)
{
    uint8_t bytes[32];
    for (uint32_t at = 0; at < STORE_PAGE_SIZE; at += sizeof bytes) {
        flash->read(flash->context, page * STORE_PAGE_SIZE + at, bytes, sizeof bytes);
        for (uint32_t i = 0; i < sizeof bytes; i++)
            if (bytes[i] != 0xFF)
                return false;
    }
    return true;
}

bool settings_store_load(const store_flash_t *flash, opms_settings_t *settings)
{
    record_t newest;
    if (!find_newest(flash, &newest))
        return false;
    *settings = newest.settings;
    return true;
}

static bool write_record(const store_flash_t *flash, uint32_t page, uint32_t sequence,
                         const opms_settings_t *settings)
{
    uint8_t bytes[STORE_PAGE_SIZE];
    memset(bytes, 0xFF, sizeof bytes);
    put32(bytes, MAGIC);
    put32(bytes + AT_SEQUENCE, sequence);
    opms_wire_write_settings_set(settings, bytes + AT_SETTINGS);
    put32(bytes + AT_CRC, crc32(bytes, AT_CRC));
    flash->program(flash->context, page * STORE_PAGE_SIZE, bytes);
    uint8_t kept[RECORD_SIZE];
    flash->read(flash->context, page * STORE_PAGE_SIZE, kept, sizeof kept);
    return memcmp(kept, bytes, sizeof kept) == 0;
}

/* Try the blank pages of one sector, from `page` on: a worn page is passed over. */
static bool write_in_sector(const store_flash_t *flash, uint32_t page, uint32_t sequence,
                            const opms_settings_t *settings)
{
    uint32_t end = (page / PAGES_PER_SECTOR + 1) * PAGES_PER_SECTOR;
    for (; page < end; page++)
        if (is_blank(flash, page) && write_record(flash, page, sequence, settings))
            return true;
    return false;
}

/* Compared as they stand on the wire: structs have gaps. */
static bool is_same(const opms_settings_t *one, const opms_settings_t *other)
{
    uint8_t bytes[2][OPMS_WIRE_SIZE];
    opms_wire_write_settings_set(one, bytes[0]);
    opms_wire_write_settings_set(other, bytes[1]);
    return memcmp(bytes[0], bytes[1], sizeof bytes[0]) == 0;
}

bool settings_store_save(const store_flash_t *flash, const opms_settings_t *settings)
{
    record_t newest = {.page = 0, .sequence = 0};
    bool found = find_newest(flash, &newest);
    if (found && is_same(&newest.settings, settings))
        return true;
    uint32_t sequence = newest.sequence + 1;
    uint32_t here = found ? newest.page + 1 : 0;
    bool has_room = !found || here % PAGES_PER_SECTOR != 0;
    if (has_room && write_in_sector(flash, here, sequence, settings))
        return true;
    /* Its sector is full: the other one holds only what is older. */
    uint32_t sector = found ? 1 - newest.page / PAGES_PER_SECTOR : 0;
    flash->erase(flash->context, sector * STORE_SECTOR_SIZE);
    return write_in_sector(flash, sector * PAGES_PER_SECTOR, sequence, settings);
}
