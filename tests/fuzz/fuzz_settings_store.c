/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes in the flash of the settings: what loads is in range, what is saved then is what loads,
 * and a power cut while saving leaves what was there or what was saved.
 *
 * The first four bytes set up the try (where the power fails, what the record claims); of the
 * others there is a whole record, and the same bytes over and over fill some of the flash. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "settings_store.h"

enum { FLASH_SIZE = STORE_SECTORS * STORE_SECTOR_SIZE, SETUP = 4 };

static uint8_t cells[FLASH_SIZE];
static uint32_t power_left;

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

static void change(uint32_t at, uint8_t value)
{
    if (power_left > 0) {
        power_left--;
        cells[at] = value;
    }
}

static void flash_read(void *context, uint32_t offset, uint8_t *bytes, uint32_t size)
{
    (void)context;
    require(offset <= FLASH_SIZE && size <= FLASH_SIZE - offset);
    memcpy(bytes, cells + offset, size);
}

static void flash_erase(void *context, uint32_t offset)
{
    (void)context;
    require(offset % STORE_SECTOR_SIZE == 0 && offset < FLASH_SIZE);
    for (uint32_t i = 0; i < STORE_SECTOR_SIZE; i++) {
        change(offset + i, 0xFF);
    }
}

static void flash_program(void *context, uint32_t offset, const uint8_t *page)
{
    (void)context;
    require(offset % STORE_PAGE_SIZE == 0 && offset < FLASH_SIZE);
    for (uint32_t i = 0; i < STORE_PAGE_SIZE; i++) {
        change(offset + i, cells[offset + i] & page[i]);
    }
}

static const store_flash_t flash = {NULL, flash_read, flash_erase, flash_program};

static bool same(const opms_settings_t *a, const opms_settings_t *b)
{
    uint8_t bytes[2][OPMS_WIRE_SIZE];
    opms_wire_write_settings_set(a, bytes[0]);
    opms_wire_write_settings_set(b, bytes[1]);
    return memcmp(bytes[0], bytes[1], OPMS_WIRE_SIZE) == 0;
}

static void fill_flash(const uint8_t *data, size_t size, uint8_t part)
{
    memset(cells, 0xFF, sizeof cells);
    for (size_t i = 0; size > 0 && i < sizeof cells * part / 255; i++) {
        cells[i] = data[i % size];
    }
}

/* A report with the right CRC stands where a saved record has its own: the loader must not believe
 * a record because its parts are right. */
static void plant_report(const uint8_t *data, size_t size)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    power_left = UINT32_MAX;
    require(settings_store_save(&flash, &settings));
    uint8_t report[OPMS_WIRE_SIZE] = {OPMS_REPORT_SETTINGS, OPMS_WIRE_PROTOCOL};
    memcpy(report + 2, data, size < OPMS_WIRE_SIZE - 4 ? size : OPMS_WIRE_SIZE - 4);
    const uint16_t crc = opms_wire_crc16(report, OPMS_WIRE_SIZE - 2);
    report[OPMS_WIRE_SIZE - 2] = (uint8_t)crc;
    report[OPMS_WIRE_SIZE - 1] = (uint8_t)(crc >> 8);
    memcpy(cells + 8, report, sizeof report);
}

static void check_save(uint32_t cut, uint32_t period_us)
{
    opms_settings_t before, after, wanted;
    opms_wire_default_settings(&wanted);
    wanted.period_us = period_us;
    const bool had = settings_store_load(&flash, &before);
    if (had) {
        require(opms_wire_check_settings(&before) == NULL);
    }
    power_left = cut;
    const bool kept = settings_store_save(&flash, &wanted);
    power_left = UINT32_MAX;
    const bool has = settings_store_load(&flash, &after);
    if (kept) {
        require(has && same(&after, &wanted));
    } else if (has) {
        require(same(&after, &wanted) || (had && same(&after, &before)));
    } else {
        require(!had);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < SETUP) {
        return 0;
    }
    const uint32_t cut = (uint32_t)data[0] << 5 | data[1];
    fill_flash(data + SETUP, size - SETUP, data[2]);
    if (data[3] % 2 != 0) {
        plant_report(data + SETUP, size - SETUP);
    }
    check_save(cut, 200000);
    check_save(UINT32_MAX, 300000);
    for (uint32_t i = 0; i < (data[3] & 0x1FU); i++) { /* to the sector's end and over it */
        check_save(cut * i, 300001 + i);
    }
    return 0;
}
