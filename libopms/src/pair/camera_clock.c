/* SPDX-License-Identifier: Apache-2.0 */
/* A tracker of offset and drift (an alpha-beta filter). Between frames one period apart the gains
 * are small, because there the jitter of stamps is what differs; after a pause of seconds it is the
 * drift, and the gains are near 1. The tolerance is that of the jitter plus what two quartz
 * clocks can drift while no pair was seen; it narrows when the drift is known. */
#include "pair/camera_clock.h"

#include <math.h>
#include <stdlib.h>

#define GAIN_OFFSET 0.25
#define GAIN_HALF_NS 3e9        /* pause after which a difference is half drift */
#define DRIFT_MAX 300e-6        /* no two quartz clocks drift more */
#define DRIFT_UNLEARNT 300e-6   /* of what is not learnt yet */
#define DRIFT_LEARNT 30e-6
#define PAIRS_TO_LEARN 60
#define JITTER_NS 400000

void pair_camera_clock_start(pair_camera_clock_t *clock, int64_t camera_ns, int64_t box_ns)
{
    clock->valid = 1;
    ++clock->epoch;
    clock->pairs = 1;
    clock->camera_ns = camera_ns;
    clock->box_ns = box_ns;
}

int64_t pair_camera_clock_box(const pair_camera_clock_t *clock, int64_t camera_ns)
{
    const double since = (double)(camera_ns - clock->camera_ns);
    return clock->box_ns + (camera_ns - clock->camera_ns) + llround(since * clock->drift);
}

void pair_camera_clock_learn(pair_camera_clock_t *clock, int64_t camera_ns, int64_t box_ns)
{
    const int64_t since = camera_ns - clock->camera_ns;
    if (since <= 0) {
        return;
    }
    const int64_t expected = pair_camera_clock_box(clock, camera_ns);
    const double off = (double)(box_ns - expected);
    const double gain = (double)since / ((double)since + GAIN_HALF_NS);
    clock->drift += gain * off / (double)since;
    clock->drift = fmin(fmax(clock->drift, -DRIFT_MAX), DRIFT_MAX);
    clock->camera_ns = camera_ns;
    clock->box_ns = expected + llround((fabs(off) > JITTER_NS / 4.0 ? 1 : GAIN_OFFSET) * off);
    ++clock->pairs;
}

int64_t pair_camera_clock_tolerance(const pair_camera_clock_t *clock, int64_t camera_ns,
                                    int64_t min_gap_ns)
{
    const double drift = clock->pairs < PAIRS_TO_LEARN ? DRIFT_UNLEARNT : DRIFT_LEARNT;
    const double since = fabs((double)(camera_ns - clock->camera_ns));
    return (int64_t)fmin(JITTER_NS + drift * since, (double)min_gap_ns / 8);
}
