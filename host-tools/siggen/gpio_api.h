/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What each of libgpiod's two APIs must give so that gpio_open.c can open the lines. */
#ifndef OPMS_SIGGEN_GPIO_API_H
#define OPMS_SIGGEN_GPIO_API_H

#include "gpio_lines.h"

#define GPIO_CONSUMER "opms siggen" /* who has the lines, as others see it */

/** Open the chip, without a line yet. @return NULL, and errno, where it cannot be. */
gpio_lines_t *gpio_api_open(const char *chip_path);

/** How many lines the chip has. */
unsigned gpio_api_line_count(gpio_lines_t *lines);

/** Request a line that the chip has. @return 0, or an errno. */
int gpio_api_request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config);

#endif
