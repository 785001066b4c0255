/* SPDX-License-Identifier: Apache-2.0 */
/* Opening the lines, alike over both of libgpiod's APIs, and saying which one cannot be had. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "gpio_api.h"

static const char *const ROLE_NAMES[GPIO_ROLES] = {"START", "STROBE", "TRIG"};

static int request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config,
                   char *error, uint32_t error_size)
{
    const unsigned count = gpio_api_line_count(lines);
    if (config->offset < 0 || (unsigned)config->offset >= count) {
        snprintf(error, error_size, "%s: there is no line %d, the chip has lines 0 to %u",
                 ROLE_NAMES[role], config->offset, count - 1);
        return -1;
    }
    const int code = gpio_api_request(lines, role, config);
    if (code != 0) {
        snprintf(error, error_size, "%s: line %d cannot be had: %s", ROLE_NAMES[role],
                 config->offset, strerror(code));
        return -1;
    }
    return 0;
}

int gpio_lines_open(const gpio_config_t *config, gpio_lines_t **lines, char *error,
                    uint32_t error_size)
{
    gpio_lines_t *const made = gpio_api_open(config->chip_path);
    if (!made) {
        snprintf(error, error_size, "%s cannot be opened as a GPIO chip: %s", config->chip_path,
                 strerror(errno));
        return -1;
    }
    for (int i = 0; i < GPIO_ROLES; ++i) {
        if (config->lines[i].offset != GPIO_NO_LINE &&
            request(made, (gpio_role_t)i, &config->lines[i], error, error_size) != 0) {
            gpio_lines_close(made);
            return -1;
        }
    }
    *lines = made;
    return 0;
}
