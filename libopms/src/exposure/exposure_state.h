/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The control while it works. A *product* is exposure (us) times gain (linear): what, with the
 * light, makes the grey levels. */
#ifndef OPMS_EXPOSURE_EXPOSURE_STATE_H
#define OPMS_EXPOSURE_EXPOSURE_STATE_H

#include <opms/exposure.h>

#define TRIAL_WAYS 3

/** What was learnt of the light on the bar. */
typedef struct light_model {
    double rate;     /**< white level per unit of product; 0: not known */
    double contrast; /**< white over black, from pictures in which neither is cut off */
    double spread;   /**< 95th percentile of the white over its median */
    double over_picture; /**< white over the 90th percentile of the picture */
} light_model_t;

/** Looking for a lost bar. */
typedef struct bracket {
    double around;  /**< product; 0: not begun */
    double asked;
    int step;
    int waited;     /**< frames since it was asked for */
} bracket_t;

/** Trying brighter and darker for more squares. */
typedef struct trial {
    double offset;  /**< factor on the product that is in use */
    int missing;    /**< frames in a row with squares missing */
    int way;        /**< which is being tried, or -1 */
    int rest;       /**< frames until the next trial may begin */
    int frames;
    double seen[TRIAL_WAYS]; /**< squares located, mean of the frames */
} trial_t;

struct opms_exposure {
    opms_exposure_options_t options;
    light_model_t light;
    bracket_t bracket;
    trial_t trial;
    double product;  /**< asked for; 0 before the first picture */
    double speed_px_s;
    int unseen;      /**< frames in a row without the bar */
    opms_exposure_command_t command;
};

/** Exposure times gain of a frame. */
double exposure_product(const opms_exposure_frame_t *frame);

/** Learn from a picture's light. */
void exposure_learn(light_model_t *model, const opms_exposure_frame_t *frame);

/** White level to aim at: the middle of the band, or less where the light is so uneven that the
 * brightest of the white would saturate. */
double exposure_aim(const opms_exposure_options_t *options, const light_model_t *model);

/** Product of the next picture while the bar is lost. */
double exposure_search(opms_exposure_t *exposure, const opms_exposure_frame_t *frame);

/** Factor on the product that shows most squares. */
double exposure_try(trial_t *trial, const opms_exposure_frame_t *frame, double asked, int steady);

/** Share a product out to shutter and gain. */
void exposure_share(const opms_exposure_options_t *options, double product, double speed_px_s,
                    opms_exposure_command_t *command);

#endif
