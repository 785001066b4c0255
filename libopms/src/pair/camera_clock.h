/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera's clock against the box's: learnt from pairs, and how far it may be off.
 *
 * Unlike the host's, it needs no round trips: a pair gives the same moment on both clocks to the
 * jitter of the camera's stamp. What is learnt is the constant from trigger to stamp, too. */
#ifndef OPMS_PAIR_CAMERA_CLOCK_H
#define OPMS_PAIR_CAMERA_CLOCK_H

#include <stdint.h>

typedef struct pair_camera_clock {
    int valid;
    uint32_t epoch;    /* another one after each restart of the camera */
    uint32_t pairs;    /* learnt from, since the restart */
    int64_t camera_ns, box_ns; /* the newest pair, smoothed: the trigger of a stamp */
    double drift;      /* box seconds per camera second, less 1 */
} pair_camera_clock_t;

/** Begin anew at one pair. The drift stays: it is the camera's quartz. */
void pair_camera_clock_start(pair_camera_clock_t *clock, int64_t camera_ns, int64_t box_ns);

/** Learn from a pair; one older than the newest changes nothing. */
void pair_camera_clock_learn(pair_camera_clock_t *clock, int64_t camera_ns, int64_t box_ns);

/** Time of the trigger that exposed a frame with this stamp. */
int64_t pair_camera_clock_box(const pair_camera_clock_t *clock, int64_t camera_ns);

/** Farthest that such a time may be off; at most an eighth of the shortest gap of triggers. */
int64_t pair_camera_clock_tolerance(const pair_camera_clock_t *clock, int64_t camera_ns,
                                    int64_t min_gap_ns);

#endif
