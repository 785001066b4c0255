/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A camera under a changing light: it does what it was told some frames ago, and cuts off what is
 * too bright. */
#ifndef EXPOSURE_WORLD_H
#define EXPOSURE_WORLD_H

#include <math.h>
#include <string.h>

#include <unity.h>

#include <opms/exposure.h>

#include "../truth_project.h"

#define WORLD_SQUARES 20
#define WORLD_DELAY_MOST 8

typedef struct world {
    opms_exposure_t *control;
    double light;          /* white level per us at 0 dB */
    double shade;          /* light of the other part of the bar; 1: as bright */
    double shaded_part;    /* of the squares */
    double contrast;       /* white over black */
    double ground;         /* its bright parts over the bar's white */
    double speed_px_s;
    int delay;             /* frames from a command to the first picture taken with it */
    int hidden;            /* the bar is not in the picture */
    int known;             /* its place is predicted while it is not located */
    uint64_t random;
    opms_exposure_command_t queue[WORLD_DELAY_MOST + 1];
    opms_exposure_frame_t frame;
    opms_exposure_command_t command;
} world_t;

static inline void world_begin(world_t *world, const opms_exposure_options_t *options)
{
    opms_error_t err;
    memset(world, 0, sizeof *world);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_create(options, &world->control, &err));
    world->light = 0.75 / 2000.0;
    world->shade = 1.0;
    world->contrast = 8.0;
    world->ground = 0.4;
    world->delay = 2;
    world->known = 1;
    world->random = 11;
    for (int i = 0; i <= WORLD_DELAY_MOST; ++i) {
        world->queue[i].exposure_us = 1000.0;
    }
}

static inline double world_cut(double level)
{
    return level < 1.0 ? level : 1.0;
}

/* Squares can be read while black is not white and white is not black. */
static inline int world_reads(double white, double contrast)
{
    return white > 0.1 && white / contrast < 0.6;
}

static inline void world_step(world_t *world)
{
    opms_error_t err;
    opms_exposure_frame_t *frame = &world->frame;
    memset(frame, 0, sizeof *frame);
    frame->exposure_us = world->queue[0].exposure_us;
    frame->gain_db = world->queue[0].gain_db;
    frame->speed_px_s = world->speed_px_s;
    const double noise = 1.0 + 0.01 * truth_gauss(&world->random);
    const double white = noise * world->light * frame->exposure_us * pow(10, frame->gain_db / 20);
    const double dim = white * world->shade;
    const double sunny = 1.0 - world->shaded_part;
    opms_exposure_light_t *light = &frame->light;
    /* 5 % of the white is up to 8 % brighter than the rest. */
    light->white = world_cut(sunny >= 0.5 ? white : dim);
    light->white_high = world_cut(1.08 * (sunny > 0.05 ? white : dim));
    light->black = world_cut((sunny >= 0.5 ? white : dim) / world->contrast);
    light->saturated = white >= 1.0 ? sunny : 0.05 * sunny * (1.08 * white >= 1.0);
    light->saturated += dim >= 1.0 ? world->shaded_part : 0.0;
    light->picture_white = world_cut(world->ground * white);
    light->picture_black = world_cut(0.3 * world->ground * white);
    if (world->hidden) {
        light->white = light->white_high = light->black = light->saturated = 0.0;
    } else {
        const double seen = sunny * world_reads(white, world->contrast) +
                            world->shaded_part * world_reads(dim, world->contrast);
        frame->squares_located = (uint32_t)(WORLD_SQUARES * seen + 0.5);
        frame->squares_expected = world->known ? WORLD_SQUARES : 0;
        light->squares = world->known || frame->squares_located > 0 ? WORLD_SQUARES : 0;
    }
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_exposure_push(world->control, frame, &world->command, &err));
    for (int i = 0; i < WORLD_DELAY_MOST; ++i) {
        world->queue[i] = world->queue[i + 1];
    }
    for (int i = world->delay; i <= WORLD_DELAY_MOST; ++i) {
        world->queue[i] = world->command;
    }
}

static inline void world_steps(world_t *world, int count)
{
    for (int i = 0; i < count; ++i) {
        world_step(world);
    }
}

static inline int world_is_well_exposed(const world_t *world)
{
    const opms_exposure_light_t *light = &world->frame.light;
    return world->frame.squares_located > 0 && light->white >= 0.70 && light->white <= 0.80 &&
           light->saturated <= 0.005;
}

#endif
