/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "exposure/exposure_state.h"

#define ENOUGH 0.9  /* of what was asked for */

static double decibels(double gain)
{
    return 20.0 * log10(gain);
}

static double linear(double gain_db)
{
    return pow(10.0, gain_db / 20.0);
}

void exposure_share(const opms_exposure_options_t *options, double product, double speed_px_s,
                    opms_exposure_command_t *command)
{
    const double least = options->exposure_min_us, most = options->exposure_max_us;
    const double smears =
        speed_px_s > 0.0 ? fmax(1e6 * options->blur_most_px / speed_px_s, least) : most;
    const double wanted = product / linear(options->gain_min_db);
    const double exposure = fmax(least, fmin(wanted, fmin(most, smears)));
    const double gain = fmin(fmax(product / exposure, linear(options->gain_min_db)),
                             linear(options->gain_max_db));
    command->exposure_us = exposure;
    command->gain_db = fmin(fmax(decibels(gain), options->gain_min_db), options->gain_max_db);
    command->blur_limited = smears < most && wanted > smears;
    if (exposure * gain < ENOUGH * product) {
        command->state = OPMS_EXPOSURE_TOO_DARK;
    } else if (exposure * gain * ENOUGH > product) {
        command->state = OPMS_EXPOSURE_TOO_BRIGHT;
    }
}
