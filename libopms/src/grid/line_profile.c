/* SPDX-License-Identifier: Apache-2.0 */
#include "grid/line_profile.h"

#include <math.h>

#define STEPS_PER_E 32.f /* 3 % */
#define TAIL 4.2f        /* blurs: what is beyond is less than 2e-5 */

/* Step of unit height under a Gaussian blur, and its integral. */
static double step_at(double z)
{
    return 0.5 * erfc(-z * 0.70710678118654752);
}

static double ramp_at(double z)
{
    return z * step_at(z) + 0.39894228040143268 * exp(-0.5 * z * z);
}

static void fill(line_profile_t *profile)
{
    const double half = 0.5 * exp(profile->width_step / (double)STEPS_PER_E);
    const double blur = exp(profile->blur_step / (double)STEPS_PER_E);
    const double reach = half + (double)TAIL * blur;
    const double step = 2.0 * reach / (PROFILE_ENTRIES - 2);
    profile->reach = (float)reach;
    profile->per_px = (float)(1.0 / step);
    for (int i = 0; i < PROFILE_ENTRIES; ++i) {
        const double x = i * step - reach;
        const double from = (x + half) / blur, to = (x - half) / blur;
        profile->at[i].area = (float)(blur * (ramp_at(from) - ramp_at(to)));
        profile->at[i].level = (float)(step_at(from) - step_at(to));
    }
}

const line_profile_t *profile_of(profile_store_t *store, float width, float blur)
{
    const int width_step = (int)lrintf(STEPS_PER_E * logf(width));
    const int blur_step = (int)lrintf(STEPS_PER_E * logf(blur));
    line_profile_t *profile =
        &store->kept[(unsigned)(width_step + 64 * blur_step) % PROFILES_KEPT];
    const int is_it = profile->per_px > 0.f && profile->width_step == width_step &&
                      profile->blur_step == blur_step;
    if (!is_it) {
        profile->width_step = width_step;
        profile->blur_step = blur_step;
        fill(profile);
    }
    return profile;
}
