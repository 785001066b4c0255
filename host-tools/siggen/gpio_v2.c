/* SPDX-License-Identifier: Apache-2.0 */
/* The lines over libgpiod's API of 2.x. Its kernel interface numbers the edges of a line, so that
 * lost ones are noticed, and keeps as many as are asked for. */
#include "gpio_api.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include <gpiod.h>

#define KERNEL_EDGES 1024
#define READ_MAX 64

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
    gpiod_request_config_set_consumer(setup->request, GPIO_CONSUMER);
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

gpio_lines_t *gpio_api_open(const char *chip_path)
{
    gpio_lines_t *const lines = calloc(1, sizeof *lines);
    if (!lines) {
        return NULL;
    }
    lines->events = gpiod_edge_event_buffer_new(READ_MAX);
    lines->chip = lines->events ? gpiod_chip_open(chip_path) : NULL;
    if (!lines->chip) {
        const int code = errno;
        gpio_lines_close(lines);
        errno = code;
        return NULL;
    }
    return lines;
}

unsigned gpio_api_line_count(gpio_lines_t *lines)
{
    struct gpiod_chip_info *const info = gpiod_chip_get_info(lines->chip);
    const unsigned count = info ? (unsigned)gpiod_chip_info_get_num_lines(info) : 0;
    gpiod_chip_info_free(info);
    return count;
}

int gpio_api_request(gpio_lines_t *lines, gpio_role_t role, const gpio_line_config_t *config)
{
    struct setup setup = {0};
    if (make_setup(&setup, role, config) == 0) {
        lines->requests[role] =
            gpiod_chip_request_lines(lines->chip, setup.request, setup.lines);
    }
    const int code = errno;
    free_setup(&setup);
    lines->offsets[role] = (unsigned)config->offset;
    return lines->requests[role] ? 0 : code;
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
