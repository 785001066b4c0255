/* SPDX-License-Identifier: Apache-2.0 */
/* From the camera's pose to the detector's, and the check of cameras. */
#include <unity.h>

#include <opms/pose.h>

#include "truth_scene.h"

static opms_error_t err;
static opms_pose_result_t view;
static opms_camera_t camera;

void setUp(void)
{
    memset(&err, 0, sizeof err);
    memset(&view, 0, sizeof view);
    memset(&camera, 0, sizeof camera);
    camera.lens = truth_lens();
    camera.detector_camera = truth_mounting();
    camera.has_detector_camera = 1;
    view.state = OPMS_POSE_FOUND;
    const opms_transform_t overhead = {{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0.1, 0.2, 0.5}};
    view.bar_camera.transform = overhead;
}

void tearDown(void)
{
}

/* One rendered picture's truth (tests/data has others), written down by the renderer: bar tilted by
 * 19.3 degrees. */
static const opms_transform_t rendered_bar_camera = {
    {-0.6997323867809594, -0.24724086285638724, -0.6702585640063474, -0.2002273485535612,
     0.9684740662074797, -0.14821265794378413, 0.6857722623298733, 0.030494898222154333,
     -0.7271770523066496},
    {0.5171083240454053, -0.3179125772605719, 0.27534054323084256}};
static const opms_transform_t rendered_ground_detector = {
    {0.969725794952489, -0.2434251644008639, -0.01939257435658829, 0.24410498103996495,
     0.9684740662074797, 0.049706552033195774, 0.006681379740875182, -0.05293554968036912,
     0.9985755788846408},
    {0.5017729251082759, -0.31338469996985374, 0.032016316819763434}};

static void test_the_detectors_pose_is_the_renderers_with_a_tilted_bar(void)
{
    opms_pose_t found;
    uint32_t includes = 0;
    view.bar_camera.transform = rendered_bar_camera;

    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 19.3 * 3.141592653589793 / 180.0,
                                                  &found, &includes, &err));

    TEST_ASSERT_EQUAL_UINT32(OPMS_COVARIANCE_IMAGE, includes);
    for (int i = 0; i < 9; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, rendered_ground_detector.R[i], found.transform.R[i]);
    }
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, rendered_ground_detector.t_m[i], found.transform.t_m[i]);
    }
}

static void test_a_positive_tilt_turns_the_printed_face_away_from_the_operator(void)
{
    opms_pose_t flat, tilted;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.0, &flat, NULL, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.3, &tilted, NULL, &err));
    /* A camera that hangs over the face swings with it: to -X, away from the operator. */
    TEST_ASSERT_TRUE(tilted.transform.t_m[0] < flat.transform.t_m[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, flat.transform.t_m[1], tilted.transform.t_m[1]);
}

/* The covariance of one small change, seen through numeric differences of the transform. */
static opms_transform_t perturbed(const opms_transform_t *transform, const double change[6])
{
    opms_transform_t other;
    double turn[9];
    truth_rotation(change, turn);
    truth_multiply(transform->R, turn, other.R);
    for (int i = 0; i < 3; ++i) {
        other.t_m[i] = transform->t_m[i] + change[3 + i];
    }
    return other;
}

static void difference(const opms_pose_t *from, const opms_pose_t *to, double change[6])
{
    truth_small_rotation(from->transform.R, to->transform.R, change);
    for (int i = 0; i < 3; ++i) {
        change[3 + i] = to->transform.t_m[i] - from->transform.t_m[i];
    }
}

/* `varied` is either the view's or the camera's transform, `covariance` its covariance. */
static void expect_propagated(opms_transform_t *varied, double covariance[36], double base)
{
    uint64_t random = 1;
    double factor[6][6], slope[6][6];
    const double step = 1e-5;
    opms_pose_t here, there;
    for (int i = 0; i < 36; ++i) {
        factor[i / 6][i % 6] = 1e-3 * truth_gauss(&random);
    }
    for (int i = 0; i < 36; ++i) {
        covariance[i] = 0.0;
        for (int k = 0; k < 6; ++k) {
            covariance[i] += factor[i / 6][k] * factor[i % 6][k];
        }
    }
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_pose_detector(&view, &camera, 0.3, &here, NULL, &err),
                              err.message);
    const opms_transform_t middle = *varied;
    for (int k = 0; k < 6; ++k) {
        double change[6] = {0}, moved[6];
        change[k] = step;
        *varied = perturbed(&middle, change);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.3, &there, NULL, &err));
        difference(&here, &there, moved);
        for (int i = 0; i < 6; ++i) {
            slope[i][k] = moved[i] / step;
        }
    }
    *varied = middle;
    for (int i = 0; i < 36; ++i) {
        double expected = base;
        for (int a = 0; a < 6; ++a) {
            for (int b = 0; b < 6; ++b) {
                expected += slope[i / 6][a] * covariance[6 * a + b] * slope[i % 6][b];
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, expected, here.covariance[i]);
    }
}

static void test_the_views_covariance_goes_through_exact_gradients(void)
{
    view.bar_camera.transform = rendered_bar_camera;
    expect_propagated(&view.bar_camera.transform, view.bar_camera.covariance, 0.0);
}

static void test_the_mountings_covariance_goes_through_exact_gradients(void)
{
    view.bar_camera.transform = rendered_bar_camera;
    camera.has_covariance_detector_camera = 1;
    expect_propagated(&camera.detector_camera, camera.covariance_detector_camera, 0.0);
}

static void test_the_intrinsics_covariance_is_added_when_the_camera_holds_it(void)
{
    opms_pose_t without, with;
    uint32_t includes;
    for (int i = 0; i < 6; ++i) {
        view.intrinsics_jacobian[8 * i + 4] = 0.1 * (i + 1); /* by k1 */
        view.bar_camera.covariance[7 * i] = 1e-6;
    }
    camera.covariance_intrinsics[4 * 8 + 4] = 1e-4;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.0, &without, &includes, &err));
    TEST_ASSERT_EQUAL_UINT32(OPMS_COVARIANCE_IMAGE, includes);
    camera.has_covariance_intrinsics = 1;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.0, &with, &includes, &err));
    TEST_ASSERT_EQUAL_UINT32(OPMS_COVARIANCE_IMAGE | OPMS_COVARIANCE_INTRINSICS, includes);
    double grown = 0.0;
    for (int i = 0; i < 3; ++i) { /* rotations keep the trace: (0.1^2 + 0.2^2 + 0.3^2) 1e-4 */
        grown += with.covariance[7 * i] - without.covariance[7 * i];
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.14e-4, grown);
}

/* dm = A dk of the mounting and dy = J dk of the view, by the same dk. */
static void test_what_mounting_and_lens_share_counts_with_its_sign(void)
{
    opms_pose_t apart, together;
    view.bar_camera.transform = rendered_bar_camera;
    camera.has_covariance_intrinsics = camera.has_covariance_detector_camera = 1;
    camera.covariance_intrinsics[0] = 1.0; /* of fx alone */
    for (int i = 0; i < 6; ++i) {
        view.intrinsics_jacobian[8 * i] = 1e-4 * (i + 1);
        camera.covariance_detector_camera_intrinsics[8 * i] = 1e-4 * (i + 1);
        for (int j = 0; j < 6; ++j) {
            camera.covariance_detector_camera[6 * i + j] = 1e-8 * (i + 1) * (j + 1);
        }
    }
    TEST_ASSERT_EQUAL(OPMS_OK, opms_pose_detector(&view, &camera, 0.3, &apart, NULL, &err));
    camera.has_covariance_detector_camera_intrinsics = 1;
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK,
                              opms_pose_detector(&view, &camera, 0.3, &together, NULL, &err),
                              err.message);
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_TRUE(apart.covariance[7 * i] > 1e-9);
        /* turned alike, camera and mounting leave the detector where it was */
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, together.covariance[7 * i]);
    }
}

static void expect_refused(double tilt_rad, const char *what)
{
    opms_pose_t found;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_pose_detector(&view, &camera, tilt_rad, &found, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("pose", err.stage);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, what), err.message);
}

static void test_each_wrong_argument_of_the_detectors_pose_is_named(void)
{
    opms_pose_t found;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_detector(NULL, &camera, 0.0, &found, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("bar_camera is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_detector(&view, NULL, 0.0, &found, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("camera is NULL", err.message);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_pose_detector(&view, &camera, 0.0, NULL, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("ground_detector is NULL", err.message);
    expect_refused(1.6, "bar_tilt_rad");
    expect_refused(NAN, "bar_tilt_rad");
    view.bar_camera.transform.R[0] = 1.1;
    expect_refused(0.0, "bar_camera.R is not orthonormal");
    setUp();
    view.state = OPMS_POSE_AMBIGUOUS;
    expect_refused(0.0, "holds no pose");
    setUp();
    camera.has_detector_camera = 0;
    expect_refused(0.0, "where it sits");
    setUp();
    camera.detector_camera.t_m[1] = INFINITY;
    expect_refused(0.0, "camera->detector_camera is not finite");
}

static void expect_camera_error(opms_status_t status, const char *what)
{
    TEST_ASSERT_EQUAL(status, opms_camera_check(&camera, &err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, what), err.message);
    setUp();
}

static void test_a_good_camera_passes(void)
{
    TEST_ASSERT_EQUAL(OPMS_OK, opms_camera_check(&camera, &err));
    camera.has_covariance_intrinsics = camera.has_covariance_detector_camera = 1;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_camera_check(&camera, &err)); /* zero: exactly known */
    for (int i = 0; i < 8; ++i) {
        camera.covariance_intrinsics[9 * i] = i < 4 ? 0.04 : 1e-8;
    }
    camera.covariance_intrinsics[1] = camera.covariance_intrinsics[8] = 0.0399;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_camera_check(&camera, &err));
}

static void test_each_wrong_part_of_a_camera_is_named(void)
{
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_camera_check(NULL, &err));
    TEST_ASSERT_EQUAL_STRING("camera is NULL", err.message);
    camera.lens.fx_px = NAN;
    expect_camera_error(OPMS_ERR_ARG, "fx_px");
    camera.lens.k1 = -0.9;
    expect_camera_error(OPMS_ERR_DOMAIN, "folds");
    camera.detector_camera.R[4] = 1.0 + 3e-6;
    expect_camera_error(OPMS_ERR_ARG, "not orthonormal");
    for (int i = 0; i < 9; ++i) {
        camera.detector_camera.R[i] = -camera.detector_camera.R[i];
    }
    expect_camera_error(OPMS_ERR_ARG, "left-handed");
    camera.has_covariance_intrinsics = 1;
    camera.covariance_intrinsics[9] = -1.0;
    expect_camera_error(OPMS_ERR_ARG, "covariance_intrinsics has a negative variance");
    camera.has_covariance_intrinsics = 1;
    camera.covariance_intrinsics[3] = NAN;
    expect_camera_error(OPMS_ERR_ARG, "covariance_intrinsics is not finite");
    camera.has_covariance_detector_camera = 1;
    for (int i = 0; i < 6; ++i) {
        camera.covariance_detector_camera[7 * i] = 1.0;
    }
    camera.covariance_detector_camera[1] = 0.1;
    expect_camera_error(OPMS_ERR_ARG, "covariance_detector_camera is not symmetric");
    camera.has_covariance_detector_camera = 1;
    for (int i = 0; i < 6; ++i) {
        camera.covariance_detector_camera[7 * i] = 1.0;
    }
    camera.covariance_detector_camera[1] = camera.covariance_detector_camera[6] = 1.1;
    expect_camera_error(OPMS_ERR_ARG, "correlation above 1");
    camera.has_covariance_detector_camera = 1;
    for (int i = 0; i < 36; ++i) { /* correlations of -0.9 each way cannot be */
        camera.covariance_detector_camera[i] = i % 7 ? (i / 6 < 3 && i % 6 < 3 ? -0.9 : 0.0) : 1.0;
    }
    expect_camera_error(OPMS_ERR_ARG, "negative variance in some direction");
}

static void fill_sound_covariances(void)
{
    camera.has_covariance_intrinsics = camera.has_covariance_detector_camera = 1;
    camera.has_covariance_detector_camera_intrinsics = 1;
    for (int i = 0; i < 8; ++i) {
        camera.covariance_intrinsics[9 * i] = i < 4 ? 0.04 : 1e-8;
    }
    for (int i = 0; i < 6; ++i) {
        camera.covariance_detector_camera[7 * i] = 1e-6;
    }
}

static void test_what_mounting_and_lens_share_must_fit_both(void)
{
    double *const shared = camera.covariance_detector_camera_intrinsics;
    fill_sound_covariances();
    shared[8 * 1 + 2] = 0.9 * 1e-3 * 0.2; /* a correlation of 0.9 */
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_camera_check(&camera, &err), err.message);
    shared[8 * 1 + 3] = 0.9 * 1e-3 * 0.2; /* with two that are independent of each other */
    expect_camera_error(OPMS_ERR_ARG, "covariance_detector_camera_intrinsics, joined with");
    fill_sound_covariances();
    shared[8 * 4 + 0] = 1.1 * 1e-3 * 0.2;
    expect_camera_error(OPMS_ERR_ARG, "correlation above 1");
    fill_sound_covariances();
    shared[47] = NAN;
    expect_camera_error(OPMS_ERR_ARG, "is not finite");
    fill_sound_covariances();
    camera.has_covariance_intrinsics = 0;
    expect_camera_error(OPMS_ERR_ARG, "stands without covariance_intrinsics");
    fill_sound_covariances();
    camera.has_covariance_detector_camera = 0;
    expect_camera_error(OPMS_ERR_ARG, "stands without covariance_detector_camera");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_detectors_pose_is_the_renderers_with_a_tilted_bar);
    RUN_TEST(test_a_positive_tilt_turns_the_printed_face_away_from_the_operator);
    RUN_TEST(test_the_views_covariance_goes_through_exact_gradients);
    RUN_TEST(test_the_mountings_covariance_goes_through_exact_gradients);
    RUN_TEST(test_the_intrinsics_covariance_is_added_when_the_camera_holds_it);
    RUN_TEST(test_what_mounting_and_lens_share_counts_with_its_sign);
    RUN_TEST(test_each_wrong_argument_of_the_detectors_pose_is_named);
    RUN_TEST(test_a_good_camera_passes);
    RUN_TEST(test_each_wrong_part_of_a_camera_is_named);
    RUN_TEST(test_what_mounting_and_lens_share_must_fit_both);
    return UNITY_END();
}
