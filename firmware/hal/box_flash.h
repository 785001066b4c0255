/* SPDX-License-Identifier: Apache-2.0 */
/* The last two sectors of the flash, for core's settings_store.h. */
#ifndef FIRMWARE_HAL_BOX_FLASH_H
#define FIRMWARE_HAL_BOX_FLASH_H

#include "settings_store.h"

/* Erasing takes some 50 ms, up to 400, in which nothing else runs: for IDLE alone. */
extern const store_flash_t box_flash;

#endif
