/* SPDX-License-Identifier: Apache-2.0 */
/* White tells the light as long as it is not cut off. Where it is, black still does: on one bar the
 * one is a fixed multiple of the other. Where even black is white, only a guess is left. */
#include <math.h>

#include "exposure/exposure_state.h"

#define CUT_OFF 0.25       /* of the white saturated: its median is not to be trusted long */
#define CLEAR 0.95         /* levels below are not cut off */
#define WHITE_LEAST 0.01   /* less is noise */
#define BLACK_LEAST 0.01
#define BLACK_MOST 0.9
#define GUESS_ALL_WHITE 4.0
#define CONTRAST_MOST 20.0
#define SPREAD_MOST 3.0
#define SPREAD_STEP 1.15   /* while it is not seen how far the brightest is above */
#define AIM_OF_HIGH 0.96

double exposure_product(const opms_exposure_frame_t *frame)
{
    return frame->exposure_us * pow(10.0, frame->gain_db / 20.0);
}

static double white_of(const light_model_t *model, const opms_exposure_light_t *light)
{
    if (light->saturated < CUT_OFF) {
        return fmax(light->white, WHITE_LEAST);
    }
    return light->black < BLACK_MOST ? fmax(model->contrast * light->black, 1.1)
                                     : GUESS_ALL_WHITE;
}

void exposure_learn(light_model_t *model, const opms_exposure_frame_t *frame)
{
    const opms_exposure_light_t *light = &frame->light;
    model->rate = white_of(model, light) / exposure_product(frame);
    if (light->white_high < CLEAR && light->white > 10.0 * WHITE_LEAST) {
        model->contrast =
            fmin(fmax(light->white / fmax(light->black, BLACK_LEAST), 1.5), CONTRAST_MOST);
        model->spread = fmin(fmax(light->white_high / light->white, 1.0), SPREAD_MOST);
        if (light->picture_white < CLEAR && light->picture_white > WHITE_LEAST) {
            model->over_picture = light->white / light->picture_white;
        }
    } else if (light->saturated < CUT_OFF && light->white > 10.0 * WHITE_LEAST) {
        const double least = fmax(SPREAD_STEP * model->spread, 1.0 / light->white);
        model->spread = fmin(least, SPREAD_MOST);
    }
}

double exposure_aim(const opms_exposure_options_t *options, const light_model_t *model)
{
    return fmin(0.5 * (options->white_low + options->white_high), AIM_OF_HIGH / model->spread);
}
