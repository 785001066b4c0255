/* SPDX-License-Identifier: Apache-2.0 */
/* The handle, and what follows from one picture. */
#include <math.h>
#include <string.h>

#include "base/fail.h"
#include "base/memory.h"
#include "exposure/exposure_state.h"

#define STAGE "exposure"
#define TRUST_UNSEEN 10    /* frames in which the place of a bar not located is still believed */
#define CONTRAST_START 6.0
#define SPREAD_START 1.1
#define OVER_PICTURE_START 1.5 /* a bar is whiter than most ground */
#define SPEED_KEPT 0.8     /* from picture to picture: a sweep stops and starts again */
#define STEP_MOST 16.0     /* of one picture to the next */

void opms_exposure_options_init(opms_exposure_options_t *options)
{
    if (options) {
        memset(options, 0, sizeof *options);
        options->struct_size = sizeof *options;
        options->exposure_min_us = 20.0;
        options->exposure_max_us = 30000.0;
        options->gain_max_db = 24.0;
        options->white_low = 0.70;
        options->white_high = 0.80;
        options->saturated_most = 0.005;
        options->blur_most_px = 2.0;
    }
}

static int is_within(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

static opms_status_t check_options(const opms_exposure_options_t *options, opms_error_t *err)
{
    if (options->struct_size != sizeof *options) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "options->struct_size is %u: fill in by opms_exposure_options_init()",
                         (unsigned)options->struct_size);
    }
    if (!is_within(options->exposure_min_us, 0.1, 1e7) ||
        !is_within(options->exposure_max_us, options->exposure_min_us, 1e7)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "exposures of %g to %g us, not 0.1 to 1e7",
                         options->exposure_min_us, options->exposure_max_us);
    }
    if (!is_within(options->gain_min_db, -20.0, 80.0) ||
        !is_within(options->gain_max_db, options->gain_min_db, 80.0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "gains of %g to %g dB, not -20 to 80",
                         options->gain_min_db, options->gain_max_db);
    }
    if (!is_within(options->white_low, 0.05, 0.95) ||
        !is_within(options->white_high, options->white_low, 0.98)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "white of %g to %g, not 0.05 to 0.98",
                         options->white_low, options->white_high);
    }
    if (!is_within(options->saturated_most, 0.0, 1.0) ||
        !is_within(options->blur_most_px, 0.01, 1000.0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "saturated_most is %g, not 0 to 1, or blur_most_px %g, not 0.01 to 1000",
                         options->saturated_most, options->blur_most_px);
    }
    return opms_check_allocator(&options->allocator, STAGE, err);
}

opms_status_t opms_exposure_create(const opms_exposure_options_t *options,
                                   opms_exposure_t **exposure, opms_error_t *err)
{
    if (!exposure) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "exposure is NULL");
    }
    opms_exposure_options_t chosen;
    opms_exposure_options_init(&chosen);
    if (options) {
        OPMS_TRY(check_options(options, err));
        chosen = *options;
    }
    opms_exposure_t *fresh = opms_take(&chosen.allocator, sizeof *fresh);
    if (!fresh) {
        return opms_fail(err, OPMS_ERR_MEMORY, STAGE, -1, "no memory for a control (%zu bytes)",
                         sizeof *fresh);
    }
    fresh->options = chosen;
    fresh->light.contrast = CONTRAST_START;
    fresh->light.spread = SPREAD_START;
    fresh->light.over_picture = OVER_PICTURE_START;
    fresh->trial.offset = 1.0;
    fresh->trial.way = -1;
    fresh->unseen = TRUST_UNSEEN;
    *exposure = fresh;
    return OPMS_OK;
}

void opms_exposure_destroy(opms_exposure_t *exposure)
{
    if (exposure) {
        opms_give_back(&exposure->options.allocator, exposure);
    }
}

static opms_status_t check_frame(const opms_exposure_frame_t *frame, opms_error_t *err)
{
    const opms_exposure_light_t *light = &frame->light;
    if (!is_within(frame->exposure_us, 1e-3, 1e8) || !is_within(frame->gain_db, -60.0, 120.0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "the frame reports an exposure of %g us and a gain of %g dB",
                         frame->exposure_us, frame->gain_db);
    }
    if (!is_within(light->white, 0.0, 1.0) || !is_within(light->white_high, 0.0, 1.0) ||
        !is_within(light->black, 0.0, 1.0) || !is_within(light->saturated, 0.0, 1.0) ||
        !is_within(light->picture_white, 0.0, 1.0) || !is_within(light->picture_black, 0.0, 1.0)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "light levels are parts of the saturation level, 0 to 1");
    }
    if (!is_within(frame->speed_px_s, 0.0, 1e9)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "speed_px_s is %g", frame->speed_px_s);
    }
    return OPMS_OK;
}

/* Is the white of this picture where it shall be? */
static int is_settled(const opms_exposure_t *exposure, const opms_exposure_light_t *light,
                      double aim)
{
    const opms_exposure_options_t *options = &exposure->options;
    const double middle = 0.5 * (options->white_low + options->white_high);
    return light->saturated <= options->saturated_most &&
           is_within(light->white, aim * options->white_low / middle,
                     aim * options->white_high / middle);
}

/* The product that brings the white to its aim. One that serves is kept. */
static double next_product(opms_exposure_t *exposure, const opms_exposure_frame_t *frame)
{
    const double taken_with = exposure_product(frame);
    exposure_learn(&exposure->light, frame);
    const double aim = exposure_aim(&exposure->options, &exposure->light);
    const double asked = exposure->product > 0.0 ? exposure->product : taken_with;
    const int trying = exposure->trial.way >= 0 || exposure->trial.offset != 1.0;
    const int settled = is_settled(exposure, &frame->light, aim);
    const double offset = exposure_try(&exposure->trial, frame, asked, settled);
    exposure->command.state = settled ? OPMS_EXPOSURE_HOLDING : OPMS_EXPOSURE_MOVING;
    /* What was asked for since then may serve already, or no longer. */
    const double white_then = exposure->light.rate * asked;
    const opms_exposure_options_t *options = &exposure->options;
    const double middle = 0.5 * (options->white_low + options->white_high);
    if (!trying && offset == 1.0 && frame->light.saturated <= options->saturated_most &&
        is_within(white_then, aim * options->white_low / middle,
                  aim * options->white_high / middle)) {
        return asked;
    }
    const double wanted = offset * aim / exposure->light.rate;
    return fmin(fmax(wanted, taken_with / STEP_MOST), taken_with * STEP_MOST);
}

opms_status_t opms_exposure_push(opms_exposure_t *exposure, const opms_exposure_frame_t *frame,
                                 opms_exposure_command_t *command, opms_error_t *err)
{
    if (!exposure || !frame || !command) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !exposure ? "exposure" : !frame ? "frame" : "command");
    }
    OPMS_TRY(check_frame(frame, err));
    exposure->speed_px_s = fmax(frame->speed_px_s, SPEED_KEPT * exposure->speed_px_s);
    exposure->unseen = frame->squares_located > 0 ? 0 : exposure->unseen + 1;
    if (frame->squares_located > 0) {
        exposure->bracket.around = 0.0;
    }
    if (frame->light.squares > 0 && exposure->unseen < TRUST_UNSEEN) {
        exposure->product = next_product(exposure, frame);
    } else {
        exposure->product = exposure_search(exposure, frame);
        exposure->command.state = OPMS_EXPOSURE_SEARCHING;
    }
    exposure_share(&exposure->options, exposure->product, exposure->speed_px_s,
                   &exposure->command);
    *command = exposure->command;
    return OPMS_OK;
}
