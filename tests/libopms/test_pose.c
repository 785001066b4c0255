/* SPDX-License-Identifier: Apache-2.0 */
/* From edges to the camera's pose: exact where the edges are, sure among outliers, honest where two
 * poses fit, and clear about wrong arguments. */
#include <unity.h>

#include <opms/pose.h>

#include "truth_scene.h"

static opms_error_t err;
static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
static double residuals[OPMS_BAR_EDGES_MAX];
static opms_pose_result_t result;

void setUp(void)
{
    memset(&err, 0, sizeof err);
    memset(&result, 0, sizeof result);
}

void tearDown(void)
{
}

static opms_transform_t scene(uint64_t *random, double tilt_rad)
{
    const opms_transform_t mounting = truth_mounting();
    const opms_transform_t detector = truth_detector(random, 0.1);
    return truth_bar_camera(&detector, &mounting, tilt_rad);
}

static opms_pose_state_t solve(const opms_lens_t *lens, uint32_t count)
{
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_pose_solve(lens, edges, count, residuals, &result, &err), err.message);
    return result.state;
}

static void expect_pose(const opms_transform_t *truth, double metres, double radians)
{
    double w[3];
    truth_small_rotation(result.bar_camera.transform.R, truth->R, w);
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(metres, truth->t_m[i], result.bar_camera.transform.t_m[i]);
        TEST_ASSERT_DOUBLE_WITHIN(radians, 0.0, w[i]);
    }
}

/* Within six of its own standard deviations. */
static void expect_stated(const opms_transform_t *truth)
{
    double w[3];
    truth_small_rotation(result.bar_camera.transform.R, truth->R, w);
    for (int i = 0; i < 3; ++i) {
        const double *const c = result.bar_camera.covariance;
        TEST_ASSERT_DOUBLE_WITHIN(6.0 * sqrt(c[7 * i]), 0.0, w[i]);
        TEST_ASSERT_DOUBLE_WITHIN(6.0 * sqrt(c[7 * i + 21]), truth->t_m[i],
                                  result.bar_camera.transform.t_m[i]);
    }
}

static void set_sigma(uint32_t count, double sigma_px)
{
    for (uint32_t k = 0; k < count; ++k) {
        edges[k].sigma_px = sigma_px;
    }
}

static void test_exact_edges_give_the_exact_pose_and_shift(void)
{
    uint64_t random = 1;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 200; ++i) {
        const opms_transform_t truth = scene(&random, i % 2 ? 0.3368 : 0.0);
        const uint32_t count = truth_edges(&lens, &truth, 0, 32, 2 + i % 7, edges);
        set_sigma(count, 0.01);

        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, solve(&lens, count));

        expect_pose(&truth, 1e-8, 1e-8);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.0, result.edge_shift_px);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, result.residual_px);
        TEST_ASSERT_EQUAL_UINT32(count, result.edges_used);
        for (uint32_t k = 0; k < count; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, residuals[k]);
        }
    }
}

static void test_a_common_shift_of_all_edges_does_not_move_the_pose(void)
{
    uint64_t random = 2;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 50; ++i) {
        const opms_transform_t truth = scene(&random, 0.0);
        const double shift = truth_uniform(&random, -0.5, 0.5);
        const uint32_t count = truth_edges(&lens, &truth, 0, 32, 4, edges);
        for (uint32_t k = 0; k < count; ++k) {
            truth_move_edge(&edges[k], shift);
        }
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, solve(&lens, count));
        expect_pose(&truth, 2e-6, 1e-5); /* the bend of the lens over the shift is left */
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, shift, result.edge_shift_px);
    }
}

static void test_a_point_anywhere_along_its_side_will_do(void)
{
    uint64_t random = 3;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t count = truth_edges(&lens, &truth, 0, 32, 4, edges);
    for (uint32_t k = 0; k < count; ++k) { /* the bar point moves, the measured one stays */
        edges[k].bar_m[edges[k].side % 2 ? 0 : 1] += truth_uniform(&random, -0.006, 0.006);
    }
    TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, solve(&lens, count));
    expect_pose(&truth, 1e-7, 1e-6);
}

static void test_three_squares_with_two_stretches_a_side_are_enough(void)
{
    uint64_t random = 4;
    const opms_lens_t lens = truth_lens();
    int found = 0;
    for (int i = 0; i < 200; ++i) {
        const opms_transform_t truth = scene(&random, 0.0);
        const uint32_t all = truth_edges(&lens, &truth, 0, 32, 2, edges);
        const int middle = edges[all / 2].square;
        const uint32_t count = truth_edges(&lens, &truth, middle - 1, middle + 1, 2, edges);
        if (count < 24) {
            continue; /* cut by the border */
        }
        set_sigma(count, 0.005);
        if (solve(&lens, count) == OPMS_POSE_FOUND) {
            expect_pose(&truth, 1e-7, 1e-7);
            ++found;
        }
    }
    TEST_ASSERT_GREATER_THAN(150, found);
}

static void test_outliers_of_one_edge_in_five_are_left_aside(void)
{
    uint64_t random = 5;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 200; ++i) {
        const opms_transform_t truth = scene(&random, 0.0);
        const uint32_t count = truth_edges(&lens, &truth, 0, 32, 4, edges);
        uint8_t moved[OPMS_BAR_EDGES_MAX] = {0};
        for (uint32_t k = 0; k < count; ++k) {
            truth_move_edge(&edges[k], 0.05 * truth_gauss(&random));
            if (truth_uniform(&random, 0, 1) < 0.2) {
                truth_move_edge(&edges[k], truth_uniform(&random, 1.0, 5.0) * (k % 2 ? 1 : -1));
                moved[k] = 1;
            }
        }
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, solve(&lens, count));
        expect_stated(&truth);
        for (uint32_t k = 0; k < count; ++k) {
            TEST_ASSERT_EQUAL(moved[k], fabs(residuals[k]) > 0.5);
        }
        TEST_ASSERT_LESS_THAN_UINT32((uint32_t)(0.9 * count), result.edges_used);
    }
}

static void test_edges_that_no_ray_reaches_are_left_aside(void)
{
    uint64_t random = 11;
    opms_lens_t lens = truth_lens();
    lens.k1 = -0.12; /* its rays turn back some 650 px from the axis */
    lens.k2 = 0.0;
    for (int i = 0; i < 50; ++i) {
        const opms_transform_t truth = scene(&random, 0.0);
        const uint32_t count = truth_edges(&lens, &truth, 0, 32, 4, edges);
        for (uint32_t k = 0; k < count; ++k) {
            truth_move_edge(&edges[k], 0.05 * truth_gauss(&random));
            if (k % 10 == 3) {
                edges[k].px[0] = 5000.0;
                edges[k].px[1] = -3000.0;
            }
        }
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, solve(&lens, count));
        expect_stated(&truth);
        for (uint32_t k = 0; k < count; ++k) {
            TEST_ASSERT_EQUAL(k % 10 == 3, fabs(residuals[k]) > 1e3);
        }
    }
}

static void test_a_pose_is_the_same_to_the_last_bit_each_time(void)
{
    uint64_t random = 6;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t count = truth_edges(&lens, &truth, 0, 32, 5, edges);
    for (uint32_t k = 0; k < count; ++k) {
        truth_move_edge(&edges[k], 0.05 * truth_gauss(&random));
    }
    solve(&lens, count);
    const opms_pose_result_t first = result;
    memset(&result, 0xff, sizeof result);
    solve(&lens, count);
    TEST_ASSERT_EQUAL_MEMORY(&first, &result, sizeof first);
}

/* The middles of the sides alone say where two lines and the squares along them are: seven numbers
 * for seven unknowns, which two poses share. */
static void test_middles_of_sides_alone_never_give_a_wrong_pose(void)
{
    uint64_t random = 15;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 100; ++i) {
        const opms_transform_t truth = scene(&random, 0.0);
        const uint32_t count = truth_edges(&lens, &truth, 0, 32, 1, edges);
        if (solve(&lens, count) == OPMS_POSE_FOUND) {
            expect_stated(&truth);
        }
    }
}

/* Three small squares far away, seen at a slant: hardly any perspective tells the poses apart. */
static void test_two_poses_that_fit_alike_are_called_ambiguous(void)
{
    uint64_t random = 7;
    opms_lens_t lens = truth_lens();
    lens.fx_px = lens.fy_px = 5850.0;
    lens.k1 = lens.k2 = lens.p1 = lens.p2 = 0.0;
    const double w[3] = {3.141592653589793, 0.0, 0.0}; /* looking down */
    const double lean[3] = {0.0, 0.45, 0.0};
    opms_transform_t down = {{0}, {0, 0, 0}}, truth = {{0}, {0, 0, 0}};
    double slant[9];
    truth_rotation(w, down.R);
    truth_rotation(lean, slant);
    truth_multiply(slant, down.R, truth.R);
    for (int i = 0; i < 3; ++i) { /* 5 m away on its own axis */
        truth.t_m[i] = -5.0 * truth.R[3 * i + 2];
    }
    const uint32_t count = truth_edges(&lens, &truth, 15, 17, 4, edges);
    TEST_ASSERT_EQUAL_UINT32(48, count);
    int ambiguous = 0;
    for (int run = 0; run < 20; ++run) {
        truth_edges(&lens, &truth, 15, 17, 4, edges);
        for (uint32_t k = 0; k < count; ++k) {
            edges[k].sigma_px = 0.1;
            truth_move_edge(&edges[k], 0.1 * truth_gauss(&random));
        }
        ambiguous += solve(&lens, count) == OPMS_POSE_AMBIGUOUS;
    }
    TEST_ASSERT_GREATER_THAN(15, ambiguous);
}

static void test_the_other_solution_of_a_plane_is_never_taken_for_the_right_one(void)
{
    uint64_t random = 8;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 300; ++i) {
        const opms_transform_t truth = scene(&random, i % 2 ? 0.3368 : 0.0);
        const uint32_t all = truth_edges(&lens, &truth, 0, 32, 4, edges);
        const int middle = edges[all / 2].square;
        const uint32_t count = truth_edges(&lens, &truth, middle - 3, middle + 3, 4, edges);
        for (uint32_t k = 0; k < count; ++k) {
            truth_move_edge(&edges[k], 0.05 * truth_gauss(&random));
        }
        if (solve(&lens, count) == OPMS_POSE_FOUND) {
            expect_stated(&truth);
            TEST_ASSERT_TRUE(result.chi2_other >= 16.0);
        }
    }
}

static void test_too_few_edges_or_squares_give_no_pose(void)
{
    uint64_t random = 9;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t count = truth_edges(&lens, &truth, 16, 16, 8, edges);
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, solve(&lens, 0));
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, solve(&lens, 7));
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, solve(&lens, count)); /* one square alone */
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_solve(&lens, NULL, 0, NULL, &result, &err));
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, result.state);
}

static void test_edges_of_one_direction_alone_give_no_pose(void)
{
    uint64_t random = 10;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t all = truth_edges(&lens, &truth, 0, 32, 4, edges);
    uint32_t count = 0;
    for (uint32_t k = 0; k < all; ++k) {
        if (edges[k].side % 2 == 0) {
            edges[count++] = edges[k]; /* the place along the bar is left open */
        }
    }
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, solve(&lens, count));
}

static void test_edges_that_agree_with_nothing_give_no_pose(void)
{
    uint64_t random = 11;
    const opms_lens_t lens = truth_lens();
    for (int run = 0; run < 50; ++run) {
        for (int k = 0; k < 200; ++k) {
            const double turn = truth_uniform(&random, 0.0, 6.28);
            const opms_edge_t edge = {
                k % 33,
                k % 4,
                {truth_uniform(&random, -0.01, 0.01), (k % 33 - 16) * 0.03},
                {truth_uniform(&random, 0, 1023), truth_uniform(&random, 0, 767)},
                {cos(turn), sin(turn)},
                0.05,
                1.0};
            edges[k] = edge;
        }
        TEST_ASSERT_NOT_EQUAL(OPMS_POSE_FOUND, solve(&lens, 200));
    }
}

static void test_a_bar_seen_from_behind_gives_no_pose(void)
{
    uint64_t random = 12;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t count = truth_edges(&lens, &truth, 0, 32, 4, edges);
    for (uint32_t k = 0; k < count; ++k) { /* the mirror image of a good view */
        edges[k].bar_m[0] = -edges[k].bar_m[0];
    }
    TEST_ASSERT_EQUAL(OPMS_POSE_NONE, solve(&lens, count));
}

static void test_wild_but_finite_numbers_do_no_harm(void)
{
    uint64_t random = 13;
    const opms_lens_t lens = truth_lens();
    const double sizes[5] = {1e-300, 1e-20, 1.0, 1e20, 1e150};
    for (int run = 0; run < 500; ++run) {
        const uint32_t count = 8 + (uint32_t)(truth_random(&random) % 300);
        for (uint32_t k = 0; k < count; ++k) {
            const double size = sizes[truth_random(&random) % 5];
            const opms_edge_t edge = {(int32_t)(k % 33),
                                      (int32_t)(k % 4),
                                      {size * truth_gauss(&random), size * truth_gauss(&random)},
                                      {size * truth_gauss(&random), truth_gauss(&random)},
                                      {0.6, run % 2 ? 0.8 : -0.8},
                                      k % 7 ? 0.05 : 1e-200,
                                      k % 5 ? 1.0 : 0.0};
            edges[k] = edge;
        }
        solve(&lens, count);
    }
}

static void expect_edge_error(uint32_t count, int32_t index, const char *what)
{
    const opms_lens_t lens = truth_lens();
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_solve(&lens, edges, count, NULL, &result, &err));
    TEST_ASSERT_EQUAL_STRING("pose", err.stage);
    TEST_ASSERT_EQUAL_INT32(index, err.index);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, what), err.message);
}

static void test_each_wrong_edge_is_named(void)
{
    uint64_t random = 14;
    const opms_lens_t lens = truth_lens();
    const opms_transform_t truth = scene(&random, 0.0);
    const uint32_t count = truth_edges(&lens, &truth, 0, 32, 2, edges);
    const opms_edge_t good = edges[5];
    edges[5].square = 33;
    expect_edge_error(count, 5, "square");
    edges[5] = good;
    edges[5].side = -1;
    expect_edge_error(count, 5, "side");
    edges[5] = good;
    edges[5].bar_m[1] = NAN;
    expect_edge_error(count, 5, "bar_m");
    edges[5] = good;
    edges[5].px[0] = INFINITY;
    expect_edge_error(count, 5, "px");
    edges[5] = good;
    edges[5].normal[0] = NAN;
    expect_edge_error(count, 5, "normal");
    edges[5].normal[0] = 2.0;
    expect_edge_error(count, 5, "normal");
    edges[5] = good;
    edges[5].sigma_px = 0.0;
    expect_edge_error(count, 5, "sigma_px");
    edges[5].sigma_px = NAN;
    expect_edge_error(count, 5, "sigma_px");
    edges[5] = good;
    expect_edge_error(OPMS_BAR_EDGES_MAX + 1, -1, "count");
}

static void test_null_and_wrong_lenses_are_named(void)
{
    opms_lens_t lens = truth_lens();
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_solve(NULL, edges, 0, NULL, &result, &err));
    TEST_ASSERT_EQUAL_STRING("lens is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_solve(&lens, edges, 0, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("result is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_solve(&lens, NULL, 1, NULL, &result, &err));
    TEST_ASSERT_EQUAL_STRING("edges is NULL", err.message);
    for (int k = 0; k < 8; ++k) {
        lens = truth_lens();
        *truth_intrinsic(&lens, k) = NAN;
        TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_solve(&lens, edges, 0, NULL, &result, &err));
        TEST_ASSERT_NOT_NULL(strstr(err.message, "lens"));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_exact_edges_give_the_exact_pose_and_shift);
    RUN_TEST(test_a_common_shift_of_all_edges_does_not_move_the_pose);
    RUN_TEST(test_a_point_anywhere_along_its_side_will_do);
    RUN_TEST(test_three_squares_with_two_stretches_a_side_are_enough);
    RUN_TEST(test_outliers_of_one_edge_in_five_are_left_aside);
    RUN_TEST(test_edges_that_no_ray_reaches_are_left_aside);
    RUN_TEST(test_a_pose_is_the_same_to_the_last_bit_each_time);
    RUN_TEST(test_middles_of_sides_alone_never_give_a_wrong_pose);
    RUN_TEST(test_two_poses_that_fit_alike_are_called_ambiguous);
    RUN_TEST(test_the_other_solution_of_a_plane_is_never_taken_for_the_right_one);
    RUN_TEST(test_too_few_edges_or_squares_give_no_pose);
    RUN_TEST(test_edges_of_one_direction_alone_give_no_pose);
    RUN_TEST(test_edges_that_agree_with_nothing_give_no_pose);
    RUN_TEST(test_a_bar_seen_from_behind_gives_no_pose);
    RUN_TEST(test_wild_but_finite_numbers_do_no_harm);
    RUN_TEST(test_each_wrong_edge_is_named);
    RUN_TEST(test_null_and_wrong_lenses_are_named);
    return UNITY_END();
}
