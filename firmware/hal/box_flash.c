/* SPDX-License-Identifier: Apache-2.0 */
#include "box_flash.h"

#include <string.h>

#include "hardware/flash.h"
#include "hardware/sync.h"

#define STORE_OFFSET (PICO_FLASH_SIZE_BYTES - STORE_SECTORS * STORE_SECTOR_SIZE)

_Static_assert(STORE_SECTOR_SIZE == FLASH_SECTOR_SIZE, "erased at once");
_Static_assert(STORE_PAGE_SIZE == FLASH_PAGE_SIZE, "programmed at once");

static void read_flash(void *context, uint32_t offset, uint8_t *bytes, uint32_t size)
{
    (void)context;
    memcpy(bytes, (const uint8_t *)XIP_BASE + STORE_OFFSET + offset, size);
}

/* The program itself lies in this flash: nothing may run from there meanwhile. */
static void erase_flash(void *context, uint32_t offset)
{
    (void)context;
    uint32_t status = save_and_disable_interrupts();
    flash_range_erase(STORE_OFFSET + offset, STORE_SECTOR_SIZE);
    restore_interrupts(status);
}

static void program_flash(void *context, uint32_t offset, const uint8_t *page)
{
    (void)context;
    uint32_t status = save_and_disable_interrupts();
    flash_range_program(STORE_OFFSET + offset, page, STORE_PAGE_SIZE);
    restore_interrupts(status);
}

const store_flash_t box_flash = {
    .context = NULL, .read = read_flash, .erase = erase_flash, .program = program_flash};
