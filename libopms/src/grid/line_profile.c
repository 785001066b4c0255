/* SPDX-License-Identifier: Apache-2.0 */
#include "grid/line_profile.h"

#include <math.h>

#include "algebra/normal_lanes.h"

#define STEPS_PER_E 32.f /* 3 % */
#define TAIL 4.2f        /* blurs: what is beyond is less than 2e-5, */
#define CLEAR 2.5f       /* but fits look at some white on both sides, too: */
#define WHITE_PX 2.2f

/* Integral of the normal distribution. */
static lanes_t ramp_at(lanes_t z, const normal_lanes_t *normal)
{
    return z * normal->step + normal->pulse;
}

static void fill(line_profile_t *profile)
{
    const float half = 0.5f * expf((float)profile->width_step / STEPS_PER_E);
    const float blur = expf((float)profile->blur_step / STEPS_PER_E);
    const float reach = half + fmaxf(TAIL * blur, CLEAR * blur + WHITE_PX);
    const float step = 2.f * reach / (PROFILE_ENTRIES - 2);
    profile->reach = reach;
    profile->per_px = 1.f / step;
    lanes_t x = {-reach, step - reach, 2.f * step - reach, 3.f * step - reach};
    for (int i = 0; i < PROFILE_ENTRIES; i += LANES, x += (float)LANES * step) {
        const lanes_t from = (x + half) / blur, to = (x - half) / blur;
        const normal_lanes_t before = normal_lanes(from), after = normal_lanes(to);
        const lanes_t area = blur * (ramp_at(from, &before) - ramp_at(to, &after));
        const lanes_t level = before.step - after.step;
        for (int l = 0; l < LANES; ++l) {
            profile->at[i + l].area = area[l];
            profile->at[i + l].level = level[l];
        }
    }
}

const line_profile_t *profile_of(profile_store_t *store, float width, float blur)
{
    const int width_step = (int)lrintf(STEPS_PER_E * logf(width));
    const int blur_step = (int)lrintf(STEPS_PER_E * logf(blur));
    line_profile_t *profile =
        &store->kept[(unsigned)width_step % WIDTHS_KEPT + WIDTHS_KEPT *
                     ((unsigned)blur_step % BLURS_KEPT)];
    const int is_it = profile->per_px > 0.f && profile->width_step == width_step &&
                      profile->blur_step == blur_step;
    if (!is_it) {
        profile->width_step = width_step;
        profile->blur_step = blur_step;
        fill(profile);
    }
    return profile;
}
