/* SPDX-License-Identifier: Apache-2.0 */
#include "box_reset.h"

#include "board_pins.h"
#include "hardware/structs/rosc.h"
#include "hardware/structs/vreg_and_chip_reset.h"
#include "hardware/timer.h"
#include "hardware/watchdog.h"
#include "pico/bootrom.h"
#include "pico/unique_id.h"

#define WATCHDOG_MS 8000U

/* Scratch 4 to 7 belong to the boot ROM and the SDK. */
#define SCRATCH_BOOTS 0

opms_reset_cause_t box_reset_cause(void)
{
    /* The ROM and the SDK restart through the watchdog, too: only ours has marked itself. */
    if (watchdog_enable_caused_reboot() && (watchdog_hw->reason & WATCHDOG_REASON_TIMER_BITS) != 0)
        return OPMS_RESET_WATCHDOG;
    if (watchdog_hw->reason != 0)
        return OPMS_RESET_SOFTWARE;
    uint32_t chip = vreg_and_chip_reset_hw->chip_reset;
    if ((chip & VREG_AND_CHIP_RESET_CHIP_RESET_HAD_RUN_BITS) != 0)
        return OPMS_RESET_PIN;
    if ((chip & VREG_AND_CHIP_RESET_CHIP_RESET_HAD_POR_BITS) != 0)
        return OPMS_RESET_POWER;
    return OPMS_RESET_UNKNOWN;
}

void box_unique_id(uint8_t id[8])
{
    pico_unique_board_id_t board;
    pico_get_unique_board_id(&board);
    for (int i = 0; i < 8; i++)
        id[i] = board.id[i];
}

/* FNV-1a, one byte. */
static uint32_t mix(uint32_t hash, uint8_t byte)
{
    return (hash ^ byte) * 16777619U;
}

static uint32_t mix32(uint32_t hash, uint32_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        hash = mix(hash, (uint8_t)(value >> shift));
    return hash;
}

/* One bit at a time, some time apart: neighbours are alike. */
static uint8_t noise_byte(void)
{
    uint8_t byte = 0;
    for (int bit = 0; bit < 8; bit++) {
        byte = (uint8_t)(byte << 1 | (rosc_hw->randombit & 1U));
        busy_wait_at_least_cycles(64);
    }
    return byte;
}

uint32_t box_new_boot_id(void)
{
    uint8_t id[8];
    uint32_t hash = 2166136261U;
    box_unique_id(id);
    for (int i = 0; i < 8; i++)
        hash = mix(hash, id[i]);
    for (int i = 0; i < 16; i++)
        hash = mix(hash, noise_byte());
    hash = mix32(hash, ++watchdog_hw->scratch[SCRATCH_BOOTS]);
    return hash != 0 ? hash : 1;
}

void box_reset_start_watchdog(void)
{
    watchdog_enable(WATCHDOG_MS, true);
}

void box_reset_feed_watchdog(void)
{
    watchdog_update();
}

void box_reset_to_bootloader(void)
{
    /* The reset that ends the bootloader is none of our watchdog. */
    watchdog_hw->scratch[4] = 0;
    rom_reset_usb_boot(1U << PIN_LED, 0);
}
