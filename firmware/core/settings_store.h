/* SPDX-License-Identifier: Apache-2.0 */
/* Settings in NOR flash, safe against a power cut at any byte.
 *
 * Two sectors hold a log of pages, one record each. A record goes into the next blank page; only
 * when its sector is full is the other one erased. So the last good record is never touched while
 * the next is written, and a torn one is told by its CRC-32. */
#ifndef FIRMWARE_CORE_SETTINGS_STORE_H
#define FIRMWARE_CORE_SETTINGS_STORE_H

#include <stdbool.h>

#include <opms/wire.h>

#define STORE_PAGE_SIZE 256
#define STORE_SECTOR_SIZE 4096
#define STORE_SECTORS 2

/* The flash under the store; offsets count from its first sector. */
typedef struct store_flash {
    void *context;
    void (*read)(void *context, uint32_t offset, uint8_t *bytes, uint32_t size);
    void (*erase)(void *context, uint32_t offset);                        /* one sector, to 0xFF */
    void (*program)(void *context, uint32_t offset, const uint8_t *page); /* only clears bits */
} store_flash_t;

/* The newest record. @return false where none is good; `settings` is then untouched. */
bool settings_store_load(const store_flash_t *flash, opms_settings_t *settings);

/* Write a record and read it back; nothing is written where the newest says the same.
 * @return false where the flash did not keep it: what was there before still holds. */
bool settings_store_save(const store_flash_t *flash, const opms_settings_t *settings);

#endif
