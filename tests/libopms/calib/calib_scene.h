/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Random cameras that look at a grid of nodes: what a perfect extraction would measure, plus
 * noise. */
#ifndef CALIB_SCENE_H
#define CALIB_SCENE_H

#include <stdlib.h>

#include <unity.h>

#include <opms/calib.h>
#include <opms/lens.h>

#include "../truth_chi2.h"
#include "../truth_project.h"

#define SCENE_PICTURES 40
#define SCENE_POINTS 1485

/** A camera, where it stood, and what it saw. */
typedef struct scene {
    opms_lens_t lens;
    uint32_t picture_count;
    opms_transform_t target_camera[SCENE_PICTURES];
    uint32_t point_count[SCENE_PICTURES];
    opms_calib_point_t points[SCENE_PICTURES][SCENE_POINTS];
} scene_t;

/** How the pictures are taken. */
typedef struct scene_plan {
    uint32_t pictures;
    double sigma_px;   /**< of the noise */
    double tilt_rad;   /**< most that the camera leans */
    double cockle_m;   /**< height of the target's middle above its ends */
    int step;          /**< every step-th line of the grid */
} scene_plan_t;

static inline scene_plan_t scene_usual_plan(void)
{
    const scene_plan_t plan = {12, 0.02, 0.7, 0.0, 2};
    return plan;
}

/** A lens from wide to long, strongly distorted, one-to-one over its picture. */
static inline opms_lens_t scene_lens(uint64_t *random)
{
    static const int widths[5] = {640, 1024, 1280, 1920, 4000};
    opms_lens_t lens;
    do {
        lens.width_px = widths[truth_random(random) % 5];
        lens.height_px = lens.width_px * 3 / 4;
        lens.fx_px = lens.width_px * truth_uniform(random, 0.45, 1.5);
        lens.fy_px = lens.fx_px * truth_uniform(random, 0.98, 1.02);
        lens.cx_px = lens.width_px * truth_uniform(random, 0.46, 0.54);
        lens.cy_px = lens.height_px * truth_uniform(random, 0.46, 0.54);
        lens.k1 = truth_uniform(random, -0.35, 0.25);
        lens.k2 = truth_uniform(random, -0.05, 0.15);
        lens.p1 = truth_uniform(random, -0.002, 0.002);
        lens.p2 = truth_uniform(random, -0.002, 0.002);
        /* A lens that only just folds is as hard to state as to calibrate. */
        opms_lens_t wider = lens;
        wider.width_px += lens.width_px / 10;
        wider.height_px += lens.height_px / 10;
        if (opms_lens_check(&wider, NULL) == OPMS_OK)
            return lens;
    } while (1);
}

/** A camera above some place of the target, leaning, turned any way about its axis. */
static inline opms_transform_t scene_pose(uint64_t *random, double tilt_rad)
{
    const double down[3] = {3.141592653589793, 0.0, 0.0};
    const double turn[3] = {0.0, 0.0, truth_uniform(random, -3.1, 3.1)};
    const double way = truth_uniform(random, 0.0, 6.283), lean = truth_uniform(random, 0, tilt_rad);
    const double leaning[3] = {lean * cos(way), lean * sin(way), 0.0};
    const double distance = truth_uniform(random, 0.25, 0.6);
    double a[9], b[9], c[9], d[9];
    opms_transform_t pose;
    truth_rotation(down, a);
    truth_rotation(turn, b);
    truth_rotation(leaning, c);
    truth_multiply(a, b, d);
    truth_multiply(d, c, pose.R);
    for (int i = 0; i < 3; ++i)
        pose.t_m[i] = -distance * pose.R[3 * i + 2];
    pose.t_m[0] += truth_uniform(random, -0.15, 0.15);
    pose.t_m[1] += truth_uniform(random, -0.25, 0.25);
    return pose;
}

/** Is this far from the axis (tangent) on the near side of the fold? */
static inline int scene_before_fold(const opms_lens_t *lens, double radius)
{
    const double s = radius * radius, turn = -0.3 * lens->k1 / lens->k2;
    const double least = turn > 0.0 && turn < s ? turn : s; /* of the slope, if it has one there */
    return 1.0 + 3.0 * lens->k1 * s + 5.0 * lens->k2 * s * s > 0.0 &&
           1.0 + 3.0 * lens->k1 * least + 5.0 * lens->k2 * least * least > 0.0;
}

static inline void scene_look(scene_t *scene, uint32_t k, const scene_plan_t *plan,
                              uint64_t *random)
{
    const opms_lens_t *lens = &scene->lens;
    const double reach = 0.6 * hypot(lens->width_px, lens->height_px) / lens->fx_px;
    scene->point_count[k] = 0;
    for (int i = -16; i <= 16; i += plan->step) {
        for (int j = -22; j <= 22; j += plan->step) {
            const double X = 0.025 * i, Y = 0.025 * j;
            const double part = (X * X + Y * Y) / (0.55 * 0.55);
            const double node[3] = {X, Y, plan->cockle_m * (1.0 - part)};
            double p[3], px[2];
            truth_apply_inverse(&scene->target_camera[k], node, p);
            if (!(p[2] > 0.05) || hypot(p[0], p[1]) > reach * p[2] ||
                !scene_before_fold(lens, hypot(p[0], p[1]) / p[2]))
                continue;
            truth_project_camera(lens, p, px);
            if (px[0] < 3 || px[1] < 3 || px[0] > lens->width_px - 4 ||
                px[1] > lens->height_px - 4)
                continue;
            opms_calib_point_t *point = &scene->points[k][scene->point_count[k]++];
            point->target_m[0] = X;
            point->target_m[1] = Y;
            point->px[0] = px[0] + plan->sigma_px * truth_gauss(random);
            point->px[1] = px[1] + plan->sigma_px * truth_gauss(random);
            point->sigma_px = plan->sigma_px;
        }
    }
}

/** Pictures of a camera. */
static inline void scene_take_with(scene_t *scene, const opms_lens_t *lens,
                                   const scene_plan_t *plan, uint64_t *random)
{
    scene->lens = *lens;
    scene->picture_count = plan->pictures;
    for (uint32_t k = 0; k < plan->pictures; ++k) {
        do {
            scene->target_camera[k] = scene_pose(random, plan->tilt_rad);
            scene_look(scene, k, plan, random);
        } while (scene->point_count[k] < 30);
    }
}

/** Pictures of some camera. */
static inline void scene_take(scene_t *scene, const scene_plan_t *plan, uint64_t *random)
{
    const opms_lens_t lens = scene_lens(random);
    scene_take_with(scene, &lens, plan, random);
}

/** A calibrator that holds the pictures. */
static inline opms_calibrator_t *scene_calibrator(const scene_t *scene, double cockle_sigma_m)
{
    opms_calib_options_t options;
    opms_calibrator_t *calibrator = NULL;
    opms_calib_options_init(&options);
    options.width_px = scene->lens.width_px;
    options.height_px = scene->lens.height_px;
    options.cockle_sigma_m = cockle_sigma_m;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_create(&options, &calibrator, NULL));
    for (uint32_t k = 0; k < scene->picture_count; ++k) {
        uint32_t index = 99;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, scene->points[k],
                                                       scene->point_count[k], &index, NULL));
        TEST_ASSERT_EQUAL_UINT32(k, index);
    }
    return calibrator;
}

/** Truth less the lens that was found. */
static inline void scene_lens_error(const scene_t *scene, const opms_lens_t *found, double off[8])
{
    opms_lens_t truth = scene->lens, copy = *found;
    for (int i = 0; i < 8; ++i)
        off[i] = *truth_intrinsic(&truth, i) - *truth_intrinsic(&copy, i);
}

#endif
