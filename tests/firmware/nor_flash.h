/* SPDX-License-Identifier: Apache-2.0 */
/* NOR flash as the settings store sees it: erasing sets a sector to 0xFF, programming only clears
 * bits, and the power may fail at any byte of either. */
#ifndef TESTS_FIRMWARE_NOR_FLASH_H
#define TESTS_FIRMWARE_NOR_FLASH_H

#include "settings_store.h"

typedef struct nor_flash {
    uint8_t bytes[STORE_SECTORS * STORE_SECTOR_SIZE];
    uint32_t power_left; /* bytes until it fails; NOR_FLASH_STAYS_ON */
    uint64_t random;     /* for the byte in which it fails */
    uint32_t work;       /* bytes erased or programmed since nor_flash_blank() */
    uint32_t erases[STORE_SECTORS];
    uint32_t programs;
    uint32_t overwrites;                              /* programs of a page that was not blank */
    uint8_t stuck[STORE_SECTORS * STORE_SECTOR_SIZE]; /* bits that stay 1 */
} nor_flash_t;

#define NOR_FLASH_STAYS_ON UINT32_MAX

/* As it leaves the factory. */
void nor_flash_blank(nor_flash_t *flash);

/* The store's view of it. */
store_flash_t nor_flash_view(nor_flash_t *flash);

#endif
