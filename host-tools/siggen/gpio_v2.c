/* SPDX-License-Identifier: Apache-2.0 */
/* The lines over libgpiod's API of 2.x. Its kernel interface numbers the edges of a line, so that
 * lost ones are noticed, and keeps as many as are asked for. */
#include "gpio_lines.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gpiod.h>

#define KERNEL_EDGES 1024
#define READ_MAX 64

static const char *const ROLE_NAMES[GPIO_ROLES] = {"START", "STROBE", "TRIG"};

struct gpio_lines {
    struct gpiod_chip *chip;
    struct gpiod_line_request *requests[GPIO_ROLES]; /* one a line; NULL where there is none */
    unsigned offsets[GPIO_ROLES];
    struct gpiod_edge_event_buffer *events;
    unsigned long last_number; /* of an edge; the kernel counts from 1 */
};

/* What libgpiod needs to know for one request. */
struct setup {
    struct gpiod_line_settings *settings;
    struct gpiod_line_config *lines;
    struct gpiod_request_config *request;
};

static void free_setup(struct setup *setup)
{
    gpiod_line_settings_free(setup->settings);
    gpiod_line_config_free(setup->lines);
    gpiod_request_config_free(setup->request);
}

static int make_setup(struct setup *setup, gpio_role_t role, const gpio_line_config_t *config)
{
    const unsigned offset = (unsigned)config->offset;
    setup->settings = gpiod_line_settings_new();
    setup->lines = gpiod_line_config_new();
    setup->request = gpiod_request_config_new();
    if (!setup->settings || !setup->lines || !setup->request) {
        return -1;
    }
    gpiod_line_settings_set_active_low(setup->settings, config->active_low);
    gpiod_request_config_set_consumer(setup->request, "opms siggen");
    if (role == GPIO_TRIG) {
        gpiod_line_settings_set_direction(setup->settings, GPIOD_LINE_DIRECTION_INPUT);
        gpiod_line_settings_set_edge_detection(setup->settings, GPIOD_LINE_EDGE_RISING);
        gpiod_request_config_set_event_buffer_size(setup->request, KERNEL_EDGES);
    } else {
        gpiod_line_settings_set_direction(setup->settings, GPIOD_LINE_DIRECTION_OUTPUT);
        gpiod_line_settings_set_output_value(setup->settings, GPIOD_LINE_VALUE_INACTIVE);
    }
    return gpiod_line_config_add_line_settings(setup->lines, &offset, 1, setup->settings);
}

static unsigned line_count(struct gpiod_chip *chip)
{
    struct gpiod_chip_info *const info = gpiod_chip_get_info(chip);
    const unsigned count = info ? (unsigned)gpiod_chip_info_get_num_lines(info) : 0;
    gpiod_chip_info_free(info);
    return count;
}

static int request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config,
                   char *error, uint32_t error_size)
{
    const unsigned count = line_count(lines->chip);
    if (config->offset < 0 || (unsigned)config->offset >= count) {
        snprintf(error, error_size, "%s: there is no line %d, the chip has lines 0 to %u",
                 ROLE_NAMES[role], config->offset, count - 1);
        return -1;
    }
    struct setup setup = {0};
    if (make_setup(&setup, role, config) == 0) {
        lines->requests[role] =
            gpiod_chip_request_lines(lines->chip, setup.request, setup.lines);
    }
    const int code = errno;
    free_setup(&setup);
    lines->offsets[role] = (unsigned)config->offset;
    if (!lines->requests[role]) {
        snprintf(error, error_size, "%s: line %d cannot be had: %s", ROLE_NAMES[role],
                 config->offset, strerror(code));
        return -1;
    }
    return 0;
}

int gpio_lines_open(const gpio_config_t *config, gpio_lines_t **lines, char *error,
                    uint32_t error_size)
{
    gpio_lines_t *const made = calloc(1, sizeof *made);
    if (made) {
        made->events = gpiod_edge_event_buffer_new(READ_MAX);
        made->chip = made->events ? gpiod_chip_open(config->chip_path) : NULL;
    }
    if (!made || !made->chip) {
        snprintf(error, error_size, "%s cannot be opened as a GPIO chip: %s", config->chip_path,
                 strerror(errno));
        gpio_lines_close(made);
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
    const enum gpiod_line_value value =
        active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
    const int result =
        gpiod_line_request_set_value(lines->requests[output], lines->offsets[output], value);
    return result == 0 ? 0 : errno;
}

static void take_edge(gpio_lines_t *lines, unsigned long index, gpio_edge_t *edge)
{
    struct gpiod_edge_event *const event =
        gpiod_edge_event_buffer_get_event(lines->events, index);
    const unsigned long number = gpiod_edge_event_get_line_seqno(event);
    edge->t_ns = (int64_t)gpiod_edge_event_get_timestamp_ns(event);
    /* The kernel's number has 32 bits. */
    edge->dropped = (uint32_t)(number - lines->last_number - 1);
    lines->last_number = number;
}

int gpio_lines_wait(gpio_lines_t *lines, int64_t timeout_ns, gpio_edge_t *edges, uint32_t capacity)
{
    struct gpiod_line_request *const trig = lines->requests[GPIO_TRIG];
    const int ready = gpiod_line_request_wait_edge_events(trig, timeout_ns);
    if (ready <= 0) {
        return ready == 0 || errno == EINTR ? 0 : -errno;
    }
    const size_t most = capacity < READ_MAX ? capacity : READ_MAX;
    const int count = gpiod_line_request_read_edge_events(trig, lines->events, most);
    for (int i = 0; i < count; ++i) {
        take_edge(lines, (unsigned long)i, &edges[i]);
    }
    return count >= 0 ? count : -errno;
}

void gpio_lines_close(gpio_lines_t *lines)
{
    if (!lines) {
        return;
    }
    for (int i = 0; i < GPIO_ROLES; ++i) {
        if (!lines->requests[i]) {
            continue;
        }
        if (i != GPIO_TRIG) {
            gpiod_line_request_set_value(lines->requests[i], lines->offsets[i],
                                         GPIOD_LINE_VALUE_INACTIVE);
        }
        gpiod_line_request_release(lines->requests[i]);
    }
    if (lines->chip) {
        gpiod_chip_close(lines->chip);
    }
    gpiod_edge_event_buffer_free(lines->events);
    free(lines);
}

const char *gpio_lines_library(void)
{
    static char name[40];
    snprintf(name, sizeof name, "libgpiod %s", gpiod_api_version());
    return name;
}

bool gpio_lines_sees_dropped(void)
{
    return true;
}
