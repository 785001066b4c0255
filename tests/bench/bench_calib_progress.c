/* SPDX-License-Identifier: Apache-2.0 */
/* Time of a calibration that grows: one picture is added to 11 and to 59 others and the solution
 * brought up to date, from nodes in hand; the same with 60 pictures of which the best dozen is in
 * use; and of asking what one more picture would do. One JSON object on the standard output,
 * medians in microseconds of CPU time, which a busy machine hardly changes. */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <opms/calib.h>
#include <opms/lens.h>

#define PICTURES 60
#define NODES 1485
#define RUNS 15
#define DOZEN 12
#define NOISE_PX 0.02

static const opms_lens_t LENS = {1024,  768,    585.0, 585.0,  517.3,
                                 379.6, -0.118, 0.031, 0.0011, -0.0007};

typedef struct picture {
    opms_transform_t target_camera;
    uint32_t count;
    opms_calib_point_t points[NODES];
} picture_t;

static picture_t pictures[PICTURES];
static double nodes[NODES][2];

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

/* Seeded, the same on every machine (splitmix64); uniform between -1 and 1. */
static double uniform(void)
{
    static uint64_t state = 7;
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) / 4503599627370496.0 - 1.0;
}

/* Above the target, looking down, leaning by up to 0.4 rad about X and about Y. */
static opms_transform_t pose(void)
{
    const double a = 0.4 * uniform(), b = 0.4 * uniform(), distance_m = 0.55 + 0.1 * uniform();
    const double ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b);
    opms_transform_t t = {{cb, sa * sb, ca * sb, 0.0, -ca, sa, sb, -sa * cb, -ca * cb}, {0}};
    for (int i = 0; i < 3; ++i)
        t.t_m[i] = -distance_m * t.R[3 * i + 2];
    return t;
}

static void take(picture_t *picture)
{
    picture->target_camera = pose();
    const double *R = picture->target_camera.R, *t = picture->target_camera.t_m;
    for (int n = 0; n < NODES; ++n) {
        const double d[3] = {nodes[n][0] - t[0], nodes[n][1] - t[1], -t[2]};
        double p[3], px[2];
        for (int i = 0; i < 3; ++i)
            p[i] = R[i] * d[0] + R[3 + i] * d[1] + R[6 + i] * d[2];
        if (opms_lens_project(&LENS, p, px, NULL, NULL, NULL) != OPMS_OK || px[0] < 3 ||
            px[1] < 3 || px[0] > LENS.width_px - 4 || px[1] > LENS.height_px - 4)
            continue;
        const opms_calib_point_t point = {
            {nodes[n][0], nodes[n][1]},
            {px[0] + 1.7 * NOISE_PX * uniform(), px[1] + 1.7 * NOISE_PX * uniform()},
            NOISE_PX};
        picture->points[picture->count++] = point;
    }
}

static void give_up(const opms_error_t *err)
{
    fprintf(stderr, "bench_calib_progress: %s\n", err->message);
    exit(EXIT_FAILURE);
}

static void add(opms_calibrator_t *calibrator, const picture_t *picture)
{
    opms_error_t err;
    if (opms_calibrator_add(calibrator, picture->points, picture->count, NULL, &err) != OPMS_OK)
        give_up(&err);
}

static void solve(opms_calibrator_t *calibrator)
{
    opms_error_t err;
    opms_calib_result_t result;
    if (opms_calibrator_solve(calibrator, &result, &err) != OPMS_OK)
        give_up(&err);
}

/* A solution of all but the last of `count` pictures. */
static opms_calibrator_t *start(uint32_t count)
{
    opms_calib_options_t options;
    opms_calibrator_t *calibrator;
    opms_error_t err;
    opms_calib_options_init(&options);
    options.width_px = LENS.width_px;
    options.height_px = LENS.height_px;
    if (opms_calibrator_create(&options, &calibrator, &err) != OPMS_OK)
        give_up(&err);
    for (uint32_t k = 0; k + 1 < count; ++k)
        add(calibrator, &pictures[k]);
    solve(calibrator);
    return calibrator;
}

static double grow(uint32_t count)
{
    opms_calibrator_t *calibrator = start(count);
    const double begin = now_us();
    add(calibrator, &pictures[count - 1]);
    solve(calibrator);
    const double took = now_us() - begin;
    opms_calibrator_destroy(calibrator);
    return took;
}

/* Leave only the best ones of those in use switched on. */
static void keep_best(opms_calibrator_t *calibrator, uint32_t taken, uint32_t count)
{
    uint32_t chosen[DOZEN], chosen_count;
    opms_error_t err;
    if (opms_calibrator_choose(calibrator, count, chosen, &chosen_count, &err) != OPMS_OK)
        give_up(&err);
    for (uint32_t k = 0; k < taken; ++k)
        opms_calibrator_use(calibrator, k, 0, NULL);
    for (uint32_t i = 0; i < chosen_count; ++i)
        opms_calibrator_use(calibrator, chosen[i], 1, NULL);
}

/* One picture more than a dozen less one; the one that is worth least goes. */
static double grow_dozen(uint32_t count)
{
    opms_calibrator_t *calibrator = start(count);
    keep_best(calibrator, count - 1, DOZEN - 1);
    solve(calibrator);
    const double begin = now_us();
    add(calibrator, &pictures[count - 1]);
    solve(calibrator);
    keep_best(calibrator, count, DOZEN - 1);
    const double took = now_us() - begin;
    opms_calibrator_destroy(calibrator);
    return took;
}

static double foresee(uint32_t count)
{
    opms_calibrator_t *calibrator = start(count);
    opms_calib_view_t view = {0};
    opms_calib_foresight_t foresight;
    opms_error_t err;
    view.target_camera = pictures[count - 1].target_camera;
    view.target_m = nodes[0];
    view.count = NODES;
    const double begin = now_us();
    if (opms_calibrator_foresee(calibrator, &view, &foresight, &err) != OPMS_OK)
        give_up(&err);
    const double took = now_us() - begin;
    opms_calibrator_destroy(calibrator);
    return took;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double (*measure)(uint32_t), uint32_t count)
{
    double took[RUNS];
    for (int i = 0; i < RUNS; ++i)
        took[i] = measure(count);
    qsort(took, RUNS, sizeof took[0], by_size);
    return took[RUNS / 2];
}

int main(void)
{
    uint32_t points = 0;
    for (int n = 0; n < NODES; ++n) {
        nodes[n][0] = 0.025 * (n / 45 - 16);
        nodes[n][1] = 0.025 * (n % 45 - 22);
    }
    for (int k = 0; k < PICTURES; ++k) {
        take(&pictures[k]);
        points += pictures[k].count;
    }
    printf("{\"nodes\": %u, \"picture_12_us\": %.0f, \"picture_60_us\": %.0f, "
           "\"dozen_of_60_us\": %.0f, \"foresee_us\": %.0f}\n",
           points / PICTURES, median(grow, 12), median(grow, 60), median(grow_dozen, 60),
           median(foresee, 12));
    return EXIT_SUCCESS;
}
