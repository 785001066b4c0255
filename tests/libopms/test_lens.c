/* SPDX-License-Identifier: Apache-2.0 */
/* The camera model: against an independent projection, against numeric gradients, out and back. */
#include <unity.h>

#include <opms/lens.h>

#include "lens/lens_fast.h"
#include "lens/lens_fold.h"
#include "truth_scene.h"

static opms_error_t err;

void setUp(void)
{
    memset(&err, 0, sizeof err);
}

void tearDown(void)
{
}

/* A lens drawn from mild to as strong as still passes the check. */
static opms_lens_t random_lens(uint64_t *random)
{
    for (;;) {
        opms_lens_t lens = {640, 480, 0, 0, 0, 0, 0, 0, 0, 0};
        lens.fx_px = truth_uniform(random, 250.0, 1500.0);
        lens.fy_px = lens.fx_px * truth_uniform(random, 0.9, 1.1);
        lens.cx_px = truth_uniform(random, 200.0, 440.0);
        lens.cy_px = truth_uniform(random, 150.0, 330.0);
        lens.k1 = truth_uniform(random, -0.5, 0.5);
        lens.k2 = truth_uniform(random, -0.3, 0.5);
        lens.p1 = truth_uniform(random, -0.02, 0.02);
        lens.p2 = truth_uniform(random, -0.02, 0.02);
        if (opms_lens_check(&lens, NULL) == OPMS_OK) {
            return lens;
        }
    }
}

static void test_projection_is_the_papers_model(void)
{
    uint64_t random = 1;
    for (int i = 0; i < 200; ++i) {
        const opms_lens_t lens = random_lens(&random);
        double point[3] = {0, 0, 0}, px[2], truth[2];
        point[2] = truth_uniform(&random, 0.1, 3.0);
        point[0] = point[2] * truth_uniform(&random, -0.1, 0.1);
        point[1] = point[2] * truth_uniform(&random, -0.1, 0.1);

        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, point, px, NULL, NULL, &err));

        truth_project_camera(&lens, point, truth);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, truth[0], px[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, truth[1], px[1]);
    }
}

static void test_gradients_by_the_point_agree_with_numeric_ones(void)
{
    uint64_t random = 2;
    for (int i = 0; i < 100; ++i) {
        const opms_lens_t lens = random_lens(&random);
        const double point[3] = {0.11, -0.08, 0.7};
        double px[2], jac[6];
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, point, px, jac, NULL, &err));
        for (int k = 0; k < 3; ++k) {
            const double step = 1e-6;
            double low[3], high[3], u0[2], u1[2];
            memcpy(low, point, sizeof low);
            memcpy(high, point, sizeof high);
            low[k] -= step;
            high[k] += step;
            truth_project_camera(&lens, low, u0);
            truth_project_camera(&lens, high, u1);
            for (int row = 0; row < 2; ++row) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, (u1[row] - u0[row]) / (2 * step), jac[3 * row + k]);
            }
        }
    }
}

static void test_gradients_by_the_intrinsics_agree_with_numeric_ones(void)
{
    uint64_t random = 3;
    for (int i = 0; i < 100; ++i) {
        const opms_lens_t lens = random_lens(&random);
        const double point[3] = {-0.09, 0.12, 0.8};
        double px[2], jac[16];
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, point, px, NULL, jac, &err));
        for (int k = 0; k < 8; ++k) {
            const double step = k < 4 ? 1e-3 : 1e-5;
            opms_lens_t low = lens, high = lens;
            *truth_intrinsic(&low, k) -= step;
            *truth_intrinsic(&high, k) += step;
            double u0[2], u1[2];
            truth_project_camera(&low, point, u0);
            truth_project_camera(&high, point, u1);
            for (int row = 0; row < 2; ++row) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, (u1[row] - u0[row]) / (2 * step), jac[8 * row + k]);
            }
        }
    }
}

/* Out and back for one pixel; 0 where no ray reaches it. */
static int round_trip(const opms_lens_t *lens, double u, double v)
{
    const double px[2] = {u, v};
    double ray[2], back[2];
    if (opms_lens_unproject(lens, px, ray, NULL, &err) != OPMS_OK) {
        TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, err.code);
        return 0;
    }
    const double point[3] = {ray[0], ray[1], 1.0};
    TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(lens, point, back, NULL, NULL, &err));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, u, back[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, v, back[1]);
    return 1;
}

static void test_unprojection_is_exact_at_and_inside_the_borders_of_any_good_lens(void)
{
    uint64_t random = 4;
    for (int i = 0; i < 400; ++i) {
        const opms_lens_t lens = random_lens(&random);
        for (int k = 0; k < 32; ++k) {
            const double u = truth_uniform(&random, -0.5, lens.width_px - 0.5);
            const double v = truth_uniform(&random, -0.5, lens.height_px - 0.5);
            TEST_ASSERT_TRUE(round_trip(&lens, u, v));
            TEST_ASSERT_TRUE(round_trip(&lens, u, k % 2 ? -0.5 : lens.height_px - 0.5));
            TEST_ASSERT_TRUE(round_trip(&lens, k % 2 ? -0.5 : lens.width_px - 0.5, v));
        }
        TEST_ASSERT_TRUE(round_trip(&lens, -0.5, -0.5));
        TEST_ASSERT_TRUE(round_trip(&lens, lens.width_px - 0.5, lens.height_px - 0.5));
    }
}

static void test_unprojection_beyond_the_borders_is_exact_or_refused(void)
{
    uint64_t random = 5;
    int reached = 0;
    for (int i = 0; i < 300; ++i) {
        const opms_lens_t lens = random_lens(&random);
        for (int k = 0; k < 20; ++k) {
            reached += round_trip(&lens, truth_uniform(&random, -320.0, 959.0),
                                  truth_uniform(&random, -240.0, 719.0));
        }
    }
    TEST_ASSERT_GREATER_THAN(4000, reached);
}

static void test_unprojection_gradients_are_the_inverse_of_the_projections(void)
{
    uint64_t random = 6;
    for (int i = 0; i < 100; ++i) {
        const opms_lens_t lens = random_lens(&random);
        const double px[2] = {truth_uniform(&random, 0, 639), truth_uniform(&random, 0, 479)};
        double ray[2], inverse[4], back[2], jac[6];
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_unproject(&lens, px, ray, inverse, &err));
        const double point[3] = {ray[0], ray[1], 1.0};
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, point, back, jac, NULL, &err));
        for (int a = 0; a < 2; ++a) {
            for (int b = 0; b < 2; ++b) {
                const double product = inverse[2 * a] * jac[b] + inverse[2 * a + 1] * jac[3 + b];
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, a == b ? 1.0 : 0.0, product);
            }
        }
    }
}

static void test_a_lens_that_folds_inside_the_picture_is_refused(void)
{
    opms_lens_t lens = truth_lens();
    lens.k1 = -0.5; /* folds at r = 0.816; the corner is at r = 1.09 */
    lens.k2 = 0.0;
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_check(&lens, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "folds inside the picture"));
}

static void test_a_lens_that_folds_by_its_tangential_part_is_refused(void)
{
    opms_lens_t lens = truth_lens();
    lens.k1 = lens.k2 = 0.0;
    lens.p2 = -0.25; /* 1 + 6 p2 x = 0 at x = 0.67 */
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_check(&lens, &err));
}

static void test_a_ray_beyond_the_fold_is_not_mirrored_back_into_the_picture(void)
{
    opms_lens_t lens = truth_lens();
    lens.k1 = -0.3;
    lens.k2 = lens.p1 = lens.p2 = 0.0;
    const double fold = sqrt(1.0 / 0.9); /* 1 + 3 k1 r^2 = 0 */
    const double inside[3] = {fold - 1e-6, 0.0, 1.0};
    const double beyond[3] = {fold + 1e-6, 0.0, 1.0};
    const double far_beyond[3] = {1.8257, 0.0, 1.0}; /* the model puts it next to the centre */
    double px[2];
    TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, inside, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, beyond, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, far_beyond, px, NULL, NULL, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "fold"));
}

static void test_the_fold_agrees_with_a_fine_walk_along_the_ray(void)
{
    uint64_t random = 7;
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
        opms_lens_t lens = truth_lens();
        lens.k1 = truth_uniform(&random, -1.0, 1.0);
        lens.k2 = truth_uniform(&random, -1.0, 1.0);
        lens.p1 = truth_uniform(&random, -0.2, 0.2);
        lens.p2 = truth_uniform(&random, -0.2, 0.2);
        const double x = truth_uniform(&random, -1.5, 1.5), y = truth_uniform(&random, -1.5, 1.5);
        double least = 1.0;
        for (int k = 0; k <= 500; ++k) {
            const lens_bend_t bend = lens_bend(&lens, x * k / 500.0, y * k / 500.0);
            least = fmin(least, bend.xx * bend.yy - bend.xy * bend.xy);
        }
        if (fabs(least) > 1e-3) { /* closer, the walk is too coarse to say */
            TEST_ASSERT_EQUAL(least > 0.0, lens_inside_fold(&lens, x, y));
            inside += least > 0.0;
        }
    }
    TEST_ASSERT_GREATER_THAN(1000, inside);
}

static void test_the_fast_calls_agree_with_the_checked_ones(void)
{
    uint64_t random = 8;
    const opms_lens_t lens = truth_lens();
    for (int i = 0; i < 500; ++i) {
        const double px[2] = {truth_uniform(&random, 0, 1023), truth_uniform(&random, 0, 767)};
        double ray[2], x = 0, y = 0, u, v, jac[4], full[6], back[2];
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_unproject(&lens, px, ray, NULL, &err));
        TEST_ASSERT_EQUAL(1, lens_unproject_fast(&lens, px[0], px[1], &x, &y));
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, ray[0], x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, ray[1], y);
        lens_project_ray(&lens, x, y, &u, &v);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, px[0], u);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, px[1], v);
        lens_project_ray_jac(&lens, x, y, &u, &v, jac);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, px[0], u);
        const double point[3] = {x, y, 1.0};
        TEST_ASSERT_EQUAL(OPMS_OK, opms_lens_project(&lens, point, back, full, NULL, &err));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, full[0], jac[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, full[1], jac[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, full[3], jac[2]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, full[4], jac[3]);
    }
}

static void expect_lens_error(const opms_lens_t *lens, const char *name)
{
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_check(lens, &err));
    TEST_ASSERT_EQUAL_STRING("lens", err.stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, name), err.message);
}

static void test_each_wrong_parameter_of_a_lens_is_named(void)
{
    static const char *const names[8] = {"fx_px", "fy_px", "cx_px", "cy_px",
                                         "k1",    "k2",    "p1",    "p2"};
    for (int k = 0; k < 8; ++k) {
        opms_lens_t lens = truth_lens();
        *truth_intrinsic(&lens, k) = k % 2 ? NAN : INFINITY;
        expect_lens_error(&lens, names[k]);
    }
    opms_lens_t lens = truth_lens();
    lens.width_px = 0;
    expect_lens_error(&lens, "width_px");
    lens = truth_lens();
    lens.height_px = 16385;
    expect_lens_error(&lens, "height_px");
    lens = truth_lens();
    lens.fx_px = -585.0;
    expect_lens_error(&lens, "fx_px");
    lens.fx_px = 51.0;
    expect_lens_error(&lens, "fx_px");
    lens = truth_lens();
    lens.fy_px = 102401.0;
    expect_lens_error(&lens, "fy_px");
    lens = truth_lens();
    lens.cx_px = 2049.0;
    expect_lens_error(&lens, "cx_px");
    lens = truth_lens();
    lens.cy_px = -769.0;
    expect_lens_error(&lens, "cy_px");
    expect_lens_error(NULL, "lens is NULL");
}

static void test_wrong_arguments_of_project_are_named(void)
{
    const opms_lens_t lens = truth_lens();
    const double good[3] = {0, 0, 1}, behind[3] = {0, 0, -1}, at[3] = {0, 0, 0};
    const double nan_depth[3] = {0, 0, NAN}, nan_x[3] = {NAN, 0, 1}, huge[3] = {1e300, 0, 1e-300};
    double px[2] = {7, 7};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_project(NULL, good, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("lens is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_project(&lens, NULL, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("point_m is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_project(&lens, good, NULL, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("px is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, behind, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, at, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, nan_depth, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, nan_x, px, NULL, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_DOMAIN, opms_lens_project(&lens, huge, px, NULL, NULL, NULL));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, px[0]); /* untouched */
}

static void test_wrong_arguments_of_unproject_are_named(void)
{
    const opms_lens_t lens = truth_lens();
    const double good[2] = {3, 4}, far_away[2] = {1537, 4}, not_finite[2] = {3, NAN};
    double ray[2] = {7, 7};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_unproject(NULL, good, ray, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("lens is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_unproject(&lens, NULL, ray, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("px is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_unproject(&lens, good, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("ray is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_unproject(&lens, far_away, ray, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_lens_unproject(&lens, not_finite, ray, NULL, &err));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, ray[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_projection_is_the_papers_model);
    RUN_TEST(test_gradients_by_the_point_agree_with_numeric_ones);
    RUN_TEST(test_gradients_by_the_intrinsics_agree_with_numeric_ones);
    RUN_TEST(test_unprojection_is_exact_at_and_inside_the_borders_of_any_good_lens);
    RUN_TEST(test_unprojection_beyond_the_borders_is_exact_or_refused);
    RUN_TEST(test_unprojection_gradients_are_the_inverse_of_the_projections);
    RUN_TEST(test_a_lens_that_folds_inside_the_picture_is_refused);
    RUN_TEST(test_a_lens_that_folds_by_its_tangential_part_is_refused);
    RUN_TEST(test_a_ray_beyond_the_fold_is_not_mirrored_back_into_the_picture);
    RUN_TEST(test_the_fold_agrees_with_a_fine_walk_along_the_ray);
    RUN_TEST(test_the_fast_calls_agree_with_the_checked_ones);
    RUN_TEST(test_each_wrong_parameter_of_a_lens_is_named);
    RUN_TEST(test_wrong_arguments_of_project_are_named);
    RUN_TEST(test_wrong_arguments_of_unproject_are_named);
    return UNITY_END();
}
