/* SPDX-License-Identifier: Apache-2.0 */
/* Cameras of all kinds, drawn at random: nearly all are calibrated, and none wrongly without a
 * word.
 *
 *   test_calib_cameras                    20 cameras, as a test
 *   test_calib_cameras CAMERAS [SEED]     any number; 200 take 3 s (docs/calibrate.md) */
#include <stdio.h>

#include "calib_scene.h"

#define CHI2_8_9999 31.83 /* one in 10,000 lies beyond */

typedef struct tally {
    uint32_t cameras, good, warned, failed, silent;
} tally_t;

static scene_t scene;
static uint32_t cameras_wanted = 20;
static uint64_t first_seed = 1;

void setUp(void)
{
}

void tearDown(void)
{
}

/* From 640 x 360 to 4000 x 3200, f 400 to 1,500 px, distortion strong either way. */
static opms_lens_t any_lens(uint64_t *random)
{
    static const double aspects[3] = {4.0 / 3.0, 16.0 / 9.0, 5.0 / 4.0};
    opms_lens_t lens, wider;
    do {
        lens.width_px = 2 * (int32_t)truth_uniform(random, 320.0, 2000.0);
        lens.height_px = (int32_t)(lens.width_px / aspects[truth_random(random) % 3]);
        lens.fx_px = truth_uniform(random, 400.0, 1500.0);
        lens.fy_px = lens.fx_px * truth_uniform(random, 0.98, 1.02);
        lens.cx_px = lens.width_px * truth_uniform(random, 0.46, 0.54);
        lens.cy_px = lens.height_px * truth_uniform(random, 0.46, 0.54);
        lens.k1 = truth_uniform(random, -0.4, 0.3);
        lens.k2 = truth_uniform(random, -0.05, 0.2);
        lens.p1 = truth_uniform(random, -0.002, 0.002);
        lens.p2 = truth_uniform(random, -0.002, 0.002);
        wider = lens; /* one that only just folds outside is no lens that is made */
        wider.width_px += lens.width_px / 10;
        wider.height_px += lens.height_px / 10;
    } while (opms_lens_check(&wider, NULL) != OPMS_OK);
    return lens;
}

static void take_pictures(uint64_t seed)
{
    uint64_t random = seed;
    scene_plan_t plan = scene_usual_plan();
    plan.pictures = 8 + (uint32_t)(truth_random(&random) % 8);
    plan.sigma_px = truth_uniform(&random, 0.02, 0.1);
    plan.step = 1;
    const opms_lens_t lens = any_lens(&random);
    scene_take_with(&scene, &lens, &plan, &random);
}

static void calibrate(uint64_t seed, tally_t *tally)
{
    opms_calib_result_t result;
    opms_error_t err = {0};
    double off[8];
    take_pictures(seed);
    opms_calibrator_t *calibrator = scene_calibrator(&scene, 0.0);
    const opms_status_t status = opms_calibrator_solve(calibrator, &result, &err);
    opms_calibrator_destroy(calibrator);
    const opms_lens_t *lens = &scene.lens;
    ++tally->cameras;
    if (status != OPMS_OK) {
        ++tally->failed;
        printf("seed %llu: %d x %d px, f %.0f px, k1 %.3f, k2 %.3f: failed and told: %s\n",
               (unsigned long long)seed, lens->width_px, lens->height_px, lens->fx_px, lens->k1,
               lens->k2, err.message);
        return;
    }
    scene_lens_error(&scene, &result.lens, off);
    const double chi2 = truth_chi2(result.covariance, 8, off, 8);
    tally->warned += result.warnings != 0;
    if (chi2 < CHI2_8_9999) {
        ++tally->good;
        return;
    }
    ++tally->failed;
    tally->silent += result.warnings == 0;
    printf("seed %llu: %d x %d px, f %.0f px, k1 %.3f, k2 %.3f: chi2 %.1f of 8, warnings %u\n",
           (unsigned long long)seed, lens->width_px, lens->height_px, lens->fx_px, lens->k1,
           lens->k2, chi2, result.warnings);
}

static void of_200_random_cameras_one_fails_and_none_silently(void)
{
    tally_t tally = {0};
    for (uint32_t i = 0; i < cameras_wanted; ++i)
        calibrate(first_seed + i, &tally);
    printf("%u cameras: %u within their stated region (%u with a warning), %u failed, "
           "%u of them silently\n",
           tally.cameras, tally.good, tally.warned, tally.failed, tally.silent);
    TEST_ASSERT_EQUAL_UINT32(0, tally.silent);
    TEST_ASSERT_TRUE(tally.failed <= (tally.cameras + 199) / 200);
}

int main(int argc, char **argv)
{
    cameras_wanted = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : cameras_wanted;
    first_seed = argc > 2 ? strtoull(argv[2], NULL, 10) : first_seed;
    if (argc > 3 || cameras_wanted == 0) {
        fprintf(stderr, "usage: test_calib_cameras [CAMERAS [SEED]]\n");
        return 2;
    }
    UNITY_BEGIN();
    RUN_TEST(of_200_random_cameras_one_fails_and_none_silently);
    return UNITY_END();
}
