/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/locate.h>

#include "bar_scene.h"
#include "counting_allocator.h"
#include "truth_scene.h"

static uint8_t picture[BAR_SCENE_PIXELS];
static bar_scene_t scene;
static opms_camera_t camera;
static opms_image_t image;
static opms_locator_t *locator;
static opms_location_t location;

static void renew_locator(const opms_locator_options_t *options)
{
    opms_locator_destroy(locator);
    locator = NULL;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_create(&camera, options, &locator, NULL));
}

void setUp(void)
{
    scene = bar_scene();
    image = (opms_image_t){picture,         BAR_SCENE_WIDTH,  BAR_SCENE_HEIGHT,
                           BAR_SCENE_WIDTH, OPMS_PIXEL_GREY8, 0};
    memset(&camera, 0, sizeof camera);
    camera.lens = scene.lens;
    camera.has_detector_camera = 1;
    camera.detector_camera = truth_mounting();
    renew_locator(NULL);
}

void tearDown(void)
{
    opms_locator_destroy(locator);
    locator = NULL;
}

static void render_and_locate(void)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    bar_render8(&scene, picture);
    const opms_status_t status = opms_locator_locate(locator, &image, NULL, NULL, &location, &err);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, status, err.message);
}

/** Errors in units of the six standard deviations that the covariance states. */
static void normalised_errors(const opms_pose_t *pose, const opms_transform_t *truth, double z[6])
{
    double w[3], turned[3] = {0};
    truth_small_rotation(pose->transform.R, truth->R, w);
    for (int i = 0; i < 3; ++i) {
        turned[i] = truth->t_m[i] - pose->transform.t_m[i];
        z[i] = w[i] / sqrt(pose->covariance[7 * i]);
        z[3 + i] = turned[i] / sqrt(pose->covariance[7 * (3 + i)]);
    }
}

static void assert_near(const opms_transform_t *truth, const opms_transform_t *pose)
{
    double w[3];
    truth_small_rotation(pose->R, truth->R, w);
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, w[i]);
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, truth->t_m[i], pose->t_m[i]);
    }
}

static void the_pose_errs_as_much_as_its_covariance_says(void)
{
    const opms_transform_t detector = bar_scene_detector();
    double sum = 0.0;
    const int pictures = 8;
    for (int i = 0; i < pictures; ++i) {
        scene.seed = (uint64_t)(100 + i);
        render_and_locate();
        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
        TEST_ASSERT_EQUAL(OPMS_POSE_FOUND, location.pose.state);
        TEST_ASSERT_EQUAL_UINT32(1, location.has_ground_detector);
        TEST_ASSERT_EQUAL_UINT32(OPMS_COVARIANCE_IMAGE, location.covariance_includes);
        assert_near(&scene.bar_camera, &location.pose.bar_camera.transform);
        assert_near(&detector, &location.ground_detector.transform);
        TEST_ASSERT_DOUBLE_WITHIN(0.65, 0.95, location.pose.chi2_dof);
        double z[6];
        normalised_errors(&location.ground_detector, &detector, z);
        for (int k = 0; k < 6; ++k) {
            sum += z[k] * z[k];
        }
    }
    /* The six errors of a picture hang together: as good as two or three degrees of freedom. */
    TEST_ASSERT_TRUE(sum / (6 * pictures) < 2.2);
    TEST_ASSERT_TRUE(sum / (6 * pictures) > 0.2);
}

static void each_edge_has_its_residual(void)
{
    render_and_locate();
    uint32_t count;
    const opms_edge_t *edges = opms_locator_edges(locator, &count);
    const double *residuals = opms_locator_residuals_px(locator);
    TEST_ASSERT_NOT_NULL(residuals);
    TEST_ASSERT_EQUAL_UINT32(location.bar.edge_count, count);
    TEST_ASSERT_TRUE(location.pose.edges_used <= count);
    TEST_ASSERT_TRUE(location.pose.edges_used > count * 9 / 10);
    for (uint32_t k = 0; k < count; ++k) {
        const double bar_m[3] = {edges[k].bar_m[0], edges[k].bar_m[1], 0.0};
        double px[2];
        truth_project(&scene.lens, &location.pose.bar_camera.transform, bar_m, px);
        const double off_px = (edges[k].px[0] - px[0]) * edges[k].normal[0] +
                              (edges[k].px[1] - px[1]) * edges[k].normal[1];
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, off_px - edges[k].shift_gain * location.pose.edge_shift_px,
                                  residuals[k]);
    }
    uint32_t squares;
    TEST_ASSERT_NOT_NULL(opms_locator_squares(locator, &squares));
    TEST_ASSERT_EQUAL_UINT32(location.bar.square_count, squares);
}

static void edges_given_back_give_the_same_pose(void)
{
    static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
    render_and_locate();
    const opms_location_t first = location;
    const uint32_t count = first.bar.edge_count;
    memcpy(edges, opms_locator_edges(locator, NULL), count * sizeof *edges);

    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_solve(locator, edges, count, &location, NULL));

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
    TEST_ASSERT_EQUAL_MEMORY(&first.pose.bar_camera, &location.pose.bar_camera,
                             sizeof first.pose.bar_camera);
    TEST_ASSERT_EQUAL_MEMORY(&first.ground_detector, &location.ground_detector,
                             sizeof first.ground_detector);
    uint32_t edges_now, squares;
    const opms_edge_t *kept = opms_locator_edges(locator, &edges_now);
    TEST_ASSERT_EQUAL_UINT32(count, edges_now);
    TEST_ASSERT_EQUAL_MEMORY(edges, kept, count * sizeof *edges);
    const opms_square_t *square = opms_locator_squares(locator, &squares);
    TEST_ASSERT_EQUAL_UINT32(location.bar.square_count, squares);
    for (uint32_t i = 0; i < squares; ++i) {
        double px[2];
        bar_scene_corner(&scene, square[i].index, 2, px);
        TEST_ASSERT_DOUBLE_WITHIN(0.3, px[0], square[i].corners_px[2][0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.3, px[1], square[i].corners_px[2][1]);
    }
    /* The locator's own edges may be given back, too. */
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_solve(locator, kept, count, &location, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
}

static void too_few_edges_are_absent(void)
{
    static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
    render_and_locate();
    memcpy(edges, opms_locator_edges(locator, NULL), location.bar.edge_count * sizeof *edges);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_solve(locator, edges, 7, &location, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, location.state);
    TEST_ASSERT_NULL(opms_locator_residuals_px(locator));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_solve(locator, NULL, 0, &location, NULL));
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, location.state);
}

static void a_picture_without_a_bar_has_no_residuals(void)
{
    render_and_locate();
    memset(picture, 90, sizeof picture);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_locate(locator, &image, NULL, NULL, &location, NULL));
    uint32_t count = 1;
    opms_locator_edges(locator, &count);
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, location.state);
    TEST_ASSERT_EQUAL_UINT32(0, count);
    TEST_ASSERT_EQUAL_UINT32(0, location.has_ground_detector);
    TEST_ASSERT_NULL(opms_locator_residuals_px(locator));
}

static void the_ground_pose_takes_the_tilt_of_the_bar(void)
{
    const double tilt_rad = 19.3 * 0.017453292519943295;
    const opms_transform_t detector = bar_scene_detector();
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar_tilt_rad = tilt_rad;
    scene.bar_camera = truth_bar_camera(&detector, &camera.detector_camera, tilt_rad);
    renew_locator(&options);

    render_and_locate();

    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
    assert_near(&detector, &location.ground_detector.transform);
}

static void a_camera_that_is_not_mounted_gives_the_bar_pose_alone(void)
{
    camera.has_detector_camera = 0;
    renew_locator(NULL);
    render_and_locate();
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
    TEST_ASSERT_EQUAL_UINT32(0, location.has_ground_detector);
    assert_near(&scene.bar_camera, &location.pose.bar_camera.transform);
}

static void the_last_pose_is_a_hint_that_is_followed(void)
{
    render_and_locate();
    const opms_transform_t last = location.pose.bar_camera.transform;
    TEST_ASSERT_EQUAL_UINT32(0, location.followed);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_locate(locator, &image, NULL, &last, &location, NULL));
    TEST_ASSERT_EQUAL_UINT32(1, location.followed);
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, last.t_m[i], location.pose.bar_camera.transform.t_m[i]);
    }
}

static void all_memory_is_taken_at_creation(void)
{
    count_t count = {0, 0, 0};
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar.allocator = (opms_allocator_t){counting_alloc, counting_free, &count};
    renew_locator(&options);
    const int calls = count.calls;
    TEST_ASSERT_GREATER_THAN_INT(0, calls);

    render_and_locate();

    TEST_ASSERT_EQUAL_INT(calls, count.calls);
    opms_locator_destroy(locator);
    locator = NULL;
    TEST_ASSERT_EQUAL_INT(0, count.live);
    for (int i = 1; i <= calls; ++i) {
        opms_error_t err = {OPMS_OK, 0, "", ""};
        count = (count_t){0, 0, i};
        TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, opms_locator_create(&camera, &options, &locator, &err));
        TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, err.code);
        TEST_ASSERT_NULL(locator);
        TEST_ASSERT_EQUAL_INT(0, count.live);
    }
}

static void assert_not_created(const opms_locator_options_t *options, const char *named)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    opms_locator_t *none = NULL;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_create(&camera, options, &none, &err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
    TEST_ASSERT_NULL(none);
}

static void wrong_options_and_cameras_are_refused_by_name(void)
{
    opms_locator_options_t options;
    const double tilts[] = {2.0, -2.0, NAN};
    for (int i = 0; i < 3; ++i) {
        opms_locator_options_init(&options);
        options.bar_tilt_rad = tilts[i];
        assert_not_created(&options, "tilt");
    }
    opms_locator_options_init(&options);
    options.struct_size = 3;
    assert_not_created(&options, "struct_size");
    opms_locator_options_init(&options);
    options.bar.min_square_px = 5;
    assert_not_created(&options, "min_square_px");
    camera.lens.fx_px = NAN;
    assert_not_created(NULL, "fx");
    camera.lens.fx_px = 585.0;
    camera.detector_camera.R[0] = 3.0;
    assert_not_created(NULL, "detector_camera");
    camera.detector_camera = truth_mounting();
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_create(&camera, NULL, NULL, NULL));
    opms_locator_t *none = NULL;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_create(NULL, NULL, &none, NULL));
    opms_locator_destroy(NULL);
}

static void assert_not_solved(const opms_edge_t *edges, uint32_t count, int32_t index,
                              const char *named)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_solve(locator, edges, count, &location, &err));
    TEST_ASSERT_EQUAL_INT32(index, err.index);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err.message, named), err.message);
}

static void wrong_arguments_are_refused_by_name(void)
{
    static opms_edge_t edges[OPMS_BAR_EDGES_MAX];
    opms_error_t err = {OPMS_OK, 0, "", ""};
    bar_render8(&scene, picture);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_locate(NULL, &image, NULL, NULL, &location, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "locator"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_locator_locate(locator, &image, NULL, NULL, NULL, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "location"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG,
                      opms_locator_locate(locator, NULL, NULL, NULL, &location, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "image"));
    assert_not_solved(NULL, 3, -1, "edges");
    assert_not_solved(edges, OPMS_BAR_EDGES_MAX + 1, -1, "count");
    const uint32_t count = truth_edges(&scene.lens, &scene.bar_camera, 12, 20, 2, edges);
    edges[5].square = 33;
    assert_not_solved(edges, count, 5, "square");
    edges[5].square = 14;
    edges[6].sigma_px = 0.0;
    assert_not_solved(edges, count, 6, "sigma");
    edges[6].sigma_px = 0.05;
    edges[7].px[1] = NAN;
    assert_not_solved(edges, count, 7, "px");
}

static void a_locator_that_is_null_has_nothing(void)
{
    uint32_t count = 1;
    TEST_ASSERT_NULL(opms_locator_squares(NULL, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
    count = 1;
    TEST_ASSERT_NULL(opms_locator_edges(NULL, &count));
    TEST_ASSERT_EQUAL_UINT32(0, count);
    TEST_ASSERT_NULL(opms_locator_residuals_px(NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_pose_errs_as_much_as_its_covariance_says);
    RUN_TEST(each_edge_has_its_residual);
    RUN_TEST(edges_given_back_give_the_same_pose);
    RUN_TEST(too_few_edges_are_absent);
    RUN_TEST(a_picture_without_a_bar_has_no_residuals);
    RUN_TEST(the_ground_pose_takes_the_tilt_of_the_bar);
    RUN_TEST(a_camera_that_is_not_mounted_gives_the_bar_pose_alone);
    RUN_TEST(the_last_pose_is_a_hint_that_is_followed);
    RUN_TEST(all_memory_is_taken_at_creation);
    RUN_TEST(wrong_options_and_cameras_are_refused_by_name);
    RUN_TEST(wrong_arguments_are_refused_by_name);
    RUN_TEST(a_locator_that_is_null_has_nothing);
    return UNITY_END();
}
