/* SPDX-License-Identifier: Apache-2.0 */
#include "nor_flash.h"

#include <string.h>

#include <unity.h>

void nor_flash_blank(nor_flash_t *flash)
{
    memset(flash, 0, sizeof *flash);
    memset(flash->bytes, 0xFF, sizeof flash->bytes);
    flash->power_left = NOR_FLASH_STAYS_ON;
    flash->random = 1;
}

/* In the byte in which power fails some bits have changed and some have not. */
static uint8_t torn(nor_flash_t *flash, uint8_t before, uint8_t after)
{
    flash->random = flash->random * UINT64_C(6364136223846793005) + UINT64_C(1);
    const uint8_t done = (uint8_t)(flash->random >> 40);
    return (uint8_t)((before & ~done) | (after & done));
}

static void change(nor_flash_t *flash, uint32_t at, uint8_t after)
{
    if (flash->power_left == 0) {
        return;
    }
    if (flash->power_left != NOR_FLASH_STAYS_ON) {
        flash->power_left--;
    }
    const bool fails_here = flash->power_left == 0;
    flash->work++;
    flash->bytes[at] = fails_here ? torn(flash, flash->bytes[at], after) : after;
}

static void read(void *context, uint32_t offset, uint8_t *bytes, uint32_t size)
{
    const nor_flash_t *flash = context;
    TEST_ASSERT_TRUE(offset + size <= sizeof flash->bytes);
    memcpy(bytes, flash->bytes + offset, size);
}

static void erase(void *context, uint32_t offset)
{
    nor_flash_t *flash = context;
    TEST_ASSERT_EQUAL(0, offset % STORE_SECTOR_SIZE);
    TEST_ASSERT_TRUE(offset < sizeof flash->bytes);
    flash->erases[offset / STORE_SECTOR_SIZE]++;
    for (uint32_t at = offset; at < offset + STORE_SECTOR_SIZE; at++) {
        change(flash, at, 0xFF);
    }
}

static void program(void *context, uint32_t offset, const uint8_t *page)
{
    nor_flash_t *flash = context;
    TEST_ASSERT_EQUAL(0, offset % STORE_PAGE_SIZE);
    TEST_ASSERT_TRUE(offset < sizeof flash->bytes);
    flash->programs++;
    bool blank = true;
    for (uint32_t i = 0; i < STORE_PAGE_SIZE; i++) {
        const uint32_t at = offset + i;
        blank = blank && flash->bytes[at] == 0xFF;
        change(flash, at, (uint8_t)(flash->bytes[at] & (page[i] | flash->stuck[at])));
    }
    flash->overwrites += !blank;
}

store_flash_t nor_flash_view(nor_flash_t *flash)
{
    const store_flash_t view = {flash, read, erase, program};
    return view;
}
