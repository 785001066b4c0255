/* SPDX-License-Identifier: Apache-2.0 */
/* The lines over libgpiod's API of 1.x. Its kernel interface keeps 16 edges and does not say when
 * it has lost one. */
#include "gpio_api.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <gpiod.h>

#define READ_MAX 16

struct gpio_lines {
    struct gpiod_chip *chip;
    struct gpiod_line *lines[GPIO_ROLES]; /* NULL where there is none */
};

gpio_lines_t *gpio_api_open(const char *chip_path)
{
    gpio_lines_t *const lines = calloc(1, sizeof *lines);
    if (!lines) {
        return NULL;
    }
    lines->chip = gpiod_chip_open(chip_path);
    if (!lines->chip) {
        const int code = errno;
        free(lines);
        errno = code;
        return NULL;
    }
    return lines;
}

unsigned gpio_api_line_count(gpio_lines_t *lines)
{
    return gpiod_chip_num_lines(lines->chip);
}

int gpio_api_request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config)
{
    const struct gpiod_line_request_config how = {
        .consumer = GPIO_CONSUMER,
        .request_type = role == GPIO_TRIG ? GPIOD_LINE_REQUEST_EVENT_RISING_EDGE
                                          : GPIOD_LINE_REQUEST_DIRECTION_OUTPUT,
        .flags = config->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0};
    struct gpiod_line *const line = gpiod_chip_get_line(lines->chip, (unsigned)config->offset);
    if (!line || gpiod_line_request(line, &how, 0) != 0) {
        return errno;
    }
    lines->lines[role] = line;
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
