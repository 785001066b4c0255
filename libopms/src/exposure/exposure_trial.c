/* SPDX-License-Identifier: Apache-2.0 */
/* Grey levels cannot decide between the sunny half of a bar and the one in the shade; what shows
 * more squares can. */
#include <math.h>

#include "exposure/exposure_state.h"

#define MISSING_PART 0.8  /* of the squares expected: fewer are too few */
#define MISSING_FRAMES 5
#define FRAMES 5          /* of each way */
#define REST 100          /* frames: the light may have changed by then */
#define OBEYED 0.1        /* relative */
#define BETTER 1.0        /* squares in the mean: less is chance */

static const double OFFSETS[TRIAL_WAYS] = {1.0, 2.0, 0.5};

static void finish(trial_t *trial)
{
    int best = 0;
    for (int way = 1; way < TRIAL_WAYS; ++way) {
        best = trial->seen[way] > trial->seen[best] + BETTER ? way : best;
    }
    trial->offset = OFFSETS[best];
    trial->way = -1;
    trial->rest = REST;
    trial->missing = 0;
}

static void begin_way(trial_t *trial, int way)
{
    trial->way = way;
    trial->frames = 0;
    trial->seen[way] = 0.0;
    trial->offset = OFFSETS[way];
}

double exposure_try(trial_t *trial, const opms_exposure_frame_t *frame, double asked, int steady)
{
    const int known = frame->squares_expected > 0;
    const int few = known && frame->squares_located < MISSING_PART * frame->squares_expected;
    if (trial->way >= 0) {
        if (fabs(exposure_product(frame) / asked - 1.0) < OBEYED) {
            trial->seen[trial->way] += (double)frame->squares_located / FRAMES;
            if (++trial->frames == FRAMES && trial->way + 1 < TRIAL_WAYS) {
                begin_way(trial, trial->way + 1);
            } else if (trial->frames == FRAMES) {
                finish(trial);
            }
        }
        return trial->offset;
    }
    if (trial->rest > 0 && --trial->rest == 0) {
        trial->offset = 1.0;
    }
    trial->missing = few && steady ? trial->missing + 1 : 0;
    if (trial->missing >= MISSING_FRAMES && trial->rest == 0) {
        begin_way(trial, 0);
    }
    return trial->offset;
}
