/* SPDX-License-Identifier: Apache-2.0 */
/* The lines over libgpiod's API of 1.x. Its kernel interface keeps 16 edges and does not say when
 * it has lost one. */
#include "gpio_lines.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <gpiod.h>

#define READ_MAX 16

static const char *const ROLE_NAMES[GPIO_ROLES] = {"START", "STROBE", "TRIG"};

struct gpio_lines {
    struct gpiod_chip *chip;
    struct gpiod_line *lines[GPIO_ROLES]; /* NULL where there is none */
};

static int request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config,
                   char *error, uint32_t error_size)
{
    const unsigned count = gpiod_chip_num_lines(lines->chip);
    if (config->offset < 0 || (unsigned)config->offset >= count) {
        snprintf(error, error_size, "%s: there is no line %d, the chip has lines 0 to %u",
                 ROLE_NAMES[role], config->offset, count - 1);
        return -1;
    }
    const struct gpiod_line_request_config how = {
        .consumer = "opms siggen",
        .request_type = role == GPIO_TRIG ? GPIOD_LINE_REQUEST_EVENT_RISING_EDGE
                                          : GPIOD_LINE_REQUEST_DIRECTION_OUTPUT,
        .flags = config->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0};
    struct gpiod_line *const line = gpiod_chip_get_line(lines->chip, (unsigned)config->offset);
    if (!line || gpiod_line_request(line, &how, 0) != 0) {
        snprintf(error, error_size, "%s: line %d cannot be had: %s", ROLE_NAMES[role],
                 config->offset, strerror(errno));
        return -1;
    }
    lines->lines[role] = line;
    return 0;
}

int gpio_lines_open(const gpio_config_t *config, gpio_lines_t **lines, char *error,
                    uint32_t error_size)
{
    gpio_lines_t *const made = calloc(1, sizeof *made);
    if (made) {
        made->chip = gpiod_chip_open(config->chip_path);
    }
    if (!made || !made->chip) {
        snprintf(error, error_size, "%s cannot be opened as a GPIO chip: %s", config->chip_path,
                 strerror(errno));
        free(made);
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

int gpio_lines_set(gpio_lines_t *lines, gpio_role_t output, bool active)
{
    return gpiod_line_set_value(lines->lines[output], active) == 0 ? 0 : errno;
}

int gpio_lines_wait(gpio_lines_t *lines, int64_t timeout_ns, gpio_edge_t *edges, uint32_t capacity)
{
    struct gpiod_line *const trig = lines->lines[GPIO_TRIG];
    const struct timespec timeout = {.tv_sec = (time_t)(timeout_ns / 1000000000),
                                     .tv_nsec = (long)(timeout_ns % 1000000000)};
    const int ready = gpiod_line_event_wait(trig, &timeout);
    if (ready <= 0) {
        return ready == 0 || errno == EINTR ? 0 : -errno;
    }
    struct gpiod_line_event events[READ_MAX];
    const int count = gpiod_line_event_read_multiple(trig, events,
                                                     capacity < READ_MAX ? capacity : READ_MAX);
    for (int i = 0; i < count; ++i) {
        edges[i].t_ns = (int64_t)events[i].ts.tv_sec * 1000000000 + events[i].ts.tv_nsec;
        edges[i].dropped = 0;
    }
    return count >= 0 ? count : -errno;
}

void gpio_lines_close(gpio_lines_t *lines)
{
    if (!lines) {
        return;
    }
    for (int i = 0; i < GPIO_ROLES; ++i) {
        if (lines->lines[i] && i != GPIO_TRIG) {
            gpiod_line_set_value(lines->lines[i], 0);
        }
    }
    gpiod_chip_close(lines->chip); /* gives the lines back, too */
    free(lines);
}

const char *gpio_lines_library(void)
{
    static char name[40];
    snprintf(name, sizeof name, "libgpiod %s", gpiod_version_string());
    return name;
}

bool gpio_lines_sees_dropped(void)
{
    return false;
}
