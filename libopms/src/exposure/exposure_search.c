/* SPDX-License-Identifier: Apache-2.0 */
/* The ground around a lost bar tells the light on it: while the bar was seen, its white was a
 * certain multiple of the picture's bright parts. Products around what that says are tried, the
 * nearest first, each until a frame that was taken with it has come. */
#include <math.h>

#include "exposure/exposure_state.h"

#define STOP 2.0
#define OBEYED 0.05      /* relative: the frame was taken with it */
#define PATIENCE 10      /* frames, for a camera that does not do as asked */
#define CHANGED 1.3      /* of the light: begin again */
#define CLIPPED 0.95     /* a level that may stand for any higher one */
#define WHITE_LEAST 0.01 /* less is noise */
#define BRIGHT 2.0       /* guesses for levels that are cut off */
#define ALL_BRIGHT 8.0

static const double STEPS[] = {0.0, -1.0, 1.0, -2.0, 2.0};
#define STEP_COUNT ((int)(sizeof STEPS / sizeof *STEPS))

/* What brings the white of a bar to its aim, by the light of the whole picture. */
static double by_picture(const opms_exposure_t *exposure, const opms_exposure_frame_t *frame)
{
    const opms_exposure_light_t *light = &frame->light;
    const double level = light->picture_white < CLIPPED   ? fmax(light->picture_white, WHITE_LEAST)
                         : light->picture_black < CLIPPED ? BRIGHT
                                                          : ALL_BRIGHT;
    const double white = level * exposure->light.over_picture;
    return exposure_aim(&exposure->options, &exposure->light) / white * exposure_product(frame);
}

double exposure_search(opms_exposure_t *exposure, const opms_exposure_frame_t *frame)
{
    bracket_t *bracket = &exposure->bracket;
    const double around = by_picture(exposure, frame);
    if (!(bracket->around > 0.0) || around > CHANGED * bracket->around ||
        around * CHANGED < bracket->around) {
        bracket->around = around;
        bracket->step = 0;
        bracket->waited = 0;
        bracket->asked = around;
        return around;
    }
    /* What shutter and gain cannot do counts as tried. */
    const int out_of_reach = exposure->command.state == OPMS_EXPOSURE_TOO_DARK ||
                             exposure->command.state == OPMS_EXPOSURE_TOO_BRIGHT;
    const double off = fabs(exposure_product(frame) / bracket->asked - 1.0);
    if (off > OBEYED && ++bracket->waited < PATIENCE && !out_of_reach) {
        return bracket->asked;
    }
    bracket->waited = 0;
    bracket->step = (bracket->step + 1) % STEP_COUNT;
    bracket->asked = bracket->around * pow(STOP, STEPS[bracket->step]);
    return bracket->asked;
}
