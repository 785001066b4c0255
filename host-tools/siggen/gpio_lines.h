/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The lines of a GPIO chip that the signal generator needs, over libgpiod.
 *
 * One interface, two makers: gpio_v1.c for libgpiod's old API (Debian 12), gpio_v2.c for the new
 * one (Debian 13); gpio_open.c is what they share. Which of them is built is decided when CMake has
 * seen gpiod.h. One handle, one thread at a time. */
#ifndef OPMS_SIGGEN_GPIO_LINES_H
#define OPMS_SIGGEN_GPIO_LINES_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GPIO_NO_LINE (-1)

/** What a line is for. START and STROBE go out, TRIG comes in. */
typedef enum gpio_role {
    GPIO_START = 0,
    GPIO_STROBE = 1,
    GPIO_TRIG = 2,
    GPIO_ROLES = 3
} gpio_role_t;

typedef struct gpio_line_config {
    int offset; /**< of the line in its chip, or GPIO_NO_LINE */
    bool active_low;
} gpio_line_config_t;

typedef struct gpio_config {
    const char *chip_path; /**< such as /dev/gpiochip0 */
    gpio_line_config_t lines[GPIO_ROLES];
} gpio_config_t;

/** TRIG became active. */
typedef struct gpio_edge {
    int64_t t_ns;     /**< the kernel's time stamp */
    uint32_t dropped; /**< edges before this one that the kernel had no room for */
} gpio_edge_t;

typedef struct gpio_lines gpio_lines_t;

/** Request the lines; outputs are inactive then. @return 0, or -1 with a text in @p error. */
int gpio_lines_open(const gpio_config_t *config, gpio_lines_t **lines, char *error,
                    uint32_t error_size);

/** Drive an output. @return 0, or an errno. */
int gpio_lines_set(gpio_lines_t *lines, gpio_role_t output, bool active);

/** Edges of TRIG, after waiting for the first one if there is none.
 * @return How many, 0 when none came in time, or a negative errno. */
int gpio_lines_wait(gpio_lines_t *lines, int64_t timeout_ns, gpio_edge_t *edges, uint32_t capacity);

/** Outputs become inactive; the lines are given back. NULL is allowed. */
void gpio_lines_close(gpio_lines_t *lines);

/** Such as "libgpiod 1.6.3". @return Static storage. */
const char *gpio_lines_library(void);

/** Does the kernel's numbering of edges reach us, so that `dropped` tells the truth? */
bool gpio_lines_sees_dropped(void);

#ifdef __cplusplus
}
#endif

#endif
