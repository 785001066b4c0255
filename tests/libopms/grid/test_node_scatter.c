/* SPDX-License-Identifier: Apache-2.0 */
/* Nodes of a distorted, slanted view, scattered by a known amount. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include "../truth_project.h"
#include "grid/node_scatter.h"

#define SIDE 30
#define SIGMA 0.01f

static opms_grid_detector_t *detector;

void setUp(void)
{
    detector = calloc(1, sizeof *detector);
    TEST_ASSERT_NOT_NULL(detector);
}

void tearDown(void)
{
    free(detector);
}

/* A plate seen at 50 degrees through a lens with 12 % of barrel distortion at the corner. */
static void place(int i, int j, double px[2])
{
    const double X = 0.025 * (i - SIDE / 2), Y = 0.025 * (j - SIDE / 2);
    const double c = cos(0.87), s = sin(0.87), depth = 0.6 + s * X;
    const double x = c * X / depth, y = Y / depth, gain = 1.0 - 0.12 * (x * x + y * y);
    px[0] = 512.0 + 600.0 * gain * x;
    px[1] = 384.0 + 600.0 * gain * y;
}

/* `wave_px` is an error that all nodes of a column share. */
static void scatter(int side, double sigma_px, double wave_px)
{
    uint64_t random = 7;
    double wave[SIDE];
    for (int i = 0; i < side; ++i) {
        wave[i] = wave_px * truth_gauss(&random);
    }
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            double px[2];
            place(i, j, px);
            const int at = lattice_index(20 + i, 30 + j);
            lattice_node_t *node = &detector->lattice[at];
            node->at.x = (float)(px[0] + sigma_px * truth_gauss(&random) + wave[i]);
            node->at.y = (float)(px[1] + sigma_px * truth_gauss(&random));
            node->sigma = SIGMA;
            node->state = NODE_FOUND;
            detector->queue[detector->queue_in++] = (uint16_t)at;
        }
    }
}

static double sigma_held(void)
{
    hold_sigmas_to_scatter(detector);
    for (int k = 1; k < detector->queue_in; ++k) {
        TEST_ASSERT_EQUAL_FLOAT(detector->lattice[detector->queue[0]].sigma,
                                detector->lattice[detector->queue[k]].sigma);
    }
    return (double)detector->lattice[detector->queue[0]].sigma;
}

static void sigmas_that_hold_are_left_alone(void)
{
    scatter(SIDE, (double)SIGMA, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.0008, 0.01, sigma_held());
}

static void sigmas_that_are_too_small_become_what_the_nodes_scatter(void)
{
    scatter(SIDE, 0.03, 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.03, sigma_held());
}

static void sigmas_are_never_made_smaller(void)
{
    scatter(SIDE, 0.002, 0.0);
    TEST_ASSERT_EQUAL_FLOAT(SIGMA, (float)sigma_held());
}

static void an_error_that_lines_share_is_seen_across_them(void)
{
    scatter(SIDE, (double)SIGMA, 0.03);
    TEST_ASSERT_TRUE(sigma_held() > 0.015);
}

static void some_spoilt_nodes_do_not_spoil_the_others(void)
{
    scatter(SIDE, (double)SIGMA, 0.0);
    for (int k = 0; k < detector->queue_in; k += 90) {
        detector->lattice[detector->queue[k]].at.x += 1.f;
    }
    TEST_ASSERT_TRUE(sigma_held() < 0.013);
}

static void too_few_nodes_say_nothing(void)
{
    scatter(7, 0.1, 0.0);
    TEST_ASSERT_EQUAL_FLOAT(SIGMA, (float)sigma_held());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sigmas_that_hold_are_left_alone);
    RUN_TEST(sigmas_that_are_too_small_become_what_the_nodes_scatter);
    RUN_TEST(sigmas_are_never_made_smaller);
    RUN_TEST(an_error_that_lines_share_is_seen_across_them);
    RUN_TEST(some_spoilt_nodes_do_not_spoil_the_others);
    RUN_TEST(too_few_nodes_say_nothing);
    return UNITY_END();
}
