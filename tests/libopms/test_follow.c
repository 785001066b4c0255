/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include <unity.h>

#include <opms/locate.h>

#include "bar_scene.h"
#include "truth_project.h"

#define DEGREE 0.017453292519943295

static uint8_t picture[BAR_SCENE_PIXELS];
static bar_scene_t scene;
static opms_image_t image;
static opms_locator_t *locator;

/** Everything that a picture gives, to be compared with another time. */
typedef struct outcome {
    opms_location_t location;
    uint32_t squares, edges;
    opms_square_t square[OPMS_BAR_SQUARES];
    opms_edge_t edge[OPMS_BAR_EDGES_MAX];
} outcome_t;

static outcome_t cold, hinted;

void setUp(void)
{
    scene = bar_scene();
    image = (opms_image_t){picture,         BAR_SCENE_WIDTH,  BAR_SCENE_HEIGHT,
                           BAR_SCENE_WIDTH, OPMS_PIXEL_GREY8, 0};
    opms_camera_t camera;
    memset(&camera, 0, sizeof camera);
    camera.lens = scene.lens;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_create(&camera, NULL, &locator, NULL));
}

void tearDown(void)
{
    opms_locator_destroy(locator);
    locator = NULL;
}

static void locate(const opms_transform_t *hint, outcome_t *outcome)
{
    opms_error_t err = {OPMS_OK, 0, "", ""};
    memset(outcome, 0, sizeof *outcome);
    const opms_status_t status =
        opms_locator_locate(locator, &image, NULL, hint, &outcome->location, &err);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, status, err.message);
    const opms_square_t *squares = opms_locator_squares(locator, &outcome->squares);
    const opms_edge_t *edges = opms_locator_edges(locator, &outcome->edges);
    memcpy(outcome->square, squares, outcome->squares * sizeof *squares);
    memcpy(outcome->edge, edges, outcome->edges * sizeof *edges);
}

static void render_and_locate(void)
{
    bar_render8(&scene, picture);
    locate(NULL, &cold);
}

/** The hint did not lead to the bar, and nothing of it is left. */
static void assert_as_without_hint(const opms_transform_t *hint)
{
    locate(hint, &hinted);
    TEST_ASSERT_EQUAL_UINT32(0, hinted.location.followed);
    TEST_ASSERT_EQUAL_MEMORY(&cold, &hinted, sizeof cold);
}

/** The hint led to the bar, to the same squares and, within what noise leaves, the same pose. Gives
 * the sum of squares, over the axes, of how far the position is off, in standard deviations. */
static double assert_followed(const opms_transform_t *hint)
{
    locate(hint, &hinted);
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, hinted.location.state);
    TEST_ASSERT_EQUAL_UINT32(1, hinted.location.followed);
    TEST_ASSERT_EQUAL_UINT32(1, hinted.location.bar.followed);
    TEST_ASSERT_EQUAL_UINT32(cold.squares, hinted.squares);
    for (uint32_t i = 0; i < cold.squares; ++i) {
        TEST_ASSERT_EQUAL_INT32(cold.square[i].index, hinted.square[i].index);
    }
    const opms_pose_t *a = &cold.location.pose.bar_camera, *b = &hinted.location.pose.bar_camera;
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const double sigma_m = sqrt(a->covariance[7 * (3 + i)]);
        const double off = (b->transform.t_m[i] - a->transform.t_m[i]) / sigma_m;
        TEST_ASSERT_DOUBLE_WITHIN(0.4, 0, off);
        sum += off * off;
    }
    return sum;
}

/** Turn the hint's camera by small angles. */
static void turn(opms_transform_t *hint, double x_deg, double y_deg, double z_deg)
{
    const double w[3] = {x_deg * DEGREE, y_deg * DEGREE, z_deg * DEGREE};
    double by[9], R[9];
    truth_rotation(w, by);
    truth_multiply(hint->R, by, R);
    memcpy(hint->R, R, sizeof R);
}

static void a_hint_that_is_about_right_is_followed(void)
{
    static const double moved_m[6][3] = {{0, 0, 0},           {0.01, 0.0, 0.0},
                                         {0, 0.011, 0},       {-0.006, -0.009, 0.006},
                                         {0.02, 0.004, 0.01}, {-0.012, 0.008, -0.01}};
    double sum = 0;
    for (int i = 0; i < 6; ++i) {
        scene = bar_scene();
        scene.seed = (uint64_t)(5 + i);
        bar_scene_roll(&scene, 0.9 * i);
        render_and_locate();
        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, cold.location.state);
        TEST_ASSERT_EQUAL_UINT32(0, cold.location.followed);
        opms_transform_t hint = scene.bar_camera;
        for (int axis = 0; axis < 3; ++axis) {
            hint.t_m[axis] += moved_m[i][axis];
        }
        turn(&hint, 0.1 * (i - 3), 0.1 * (2 - i), 0.6 * (i % 3 - 1));
        sum += assert_followed(&hint);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, sqrt(sum / 18));
}

static void a_hint_off_by_whole_squares_is_found_out_by_the_codes(void)
{
    render_and_locate();
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, cold.location.state);
    for (int squares = -OPMS_BAR_SQUARES; squares <= OPMS_BAR_SQUARES; ++squares) {
        if (squares != 0) {
            opms_transform_t hint = scene.bar_camera;
            hint.t_m[1] += OPMS_BAR_PITCH_M * squares;
            assert_as_without_hint(&hint);
        }
    }
}

static void a_hint_turned_by_half_a_turn_is_found_out(void)
{
    render_and_locate();
    for (int squares = -16; squares <= 16; ++squares) {
        /* The same picture of a bar that lies the other way round. */
        opms_transform_t hint = scene.bar_camera;
        for (int i = 0; i < 6; ++i) {
            hint.R[i] = -hint.R[i];
        }
        hint.t_m[0] = -hint.t_m[0];
        hint.t_m[1] = -hint.t_m[1] + OPMS_BAR_PITCH_M * squares;
        assert_as_without_hint(&hint);
    }
}

static void hints_that_are_nowhere_near_change_nothing(void)
{
    render_and_locate();
    static const double height[4] = {0.5, 0.7, 1.4, -1.0};
    for (int i = 0; i < 4; ++i) {
        opms_transform_t hint = scene.bar_camera;
        hint.t_m[2] *= height[i];
        assert_as_without_hint(&hint);
    }
    for (int i = 0; i < 6; ++i) {
        opms_transform_t hint = scene.bar_camera;
        hint.t_m[i % 3] += i < 3 ? 5.0 : -1e300;
        assert_as_without_hint(&hint);
    }
    opms_transform_t hint = scene.bar_camera;
    turn(&hint, 0, 0, 90);
    assert_as_without_hint(&hint);
    memset(&hint, 0, sizeof hint);
    assert_as_without_hint(&hint);
    for (int i = 0; i < 9; ++i) {
        hint.R[i] = i % 2 ? 1e200 : -1e-200;
    }
    assert_as_without_hint(&hint);
}

static void a_hint_finds_no_bar_where_there_is_none(void)
{
    const opms_transform_t hint = scene.bar_camera;
    memset(picture, 90, sizeof picture);
    locate(NULL, &cold);
    TEST_ASSERT_EQUAL(OPMS_BAR_ABSENT, cold.location.state);
    assert_as_without_hint(&hint);

    /* A bar with one code throughout is no bar that could be labelled. */
    for (int k = 0; k < BAR_SCENE_SQUARES; ++k) {
        scene.codes[k] = 21;
    }
    render_and_locate();
    TEST_ASSERT_NOT_EQUAL(OPMS_BAR_LOCATED, cold.location.state);
    assert_as_without_hint(&hint);
}

static void a_covered_square_and_saturated_white_are_followed(void)
{
    opms_transform_t hint = scene.bar_camera;
    hint.t_m[1] += 0.008;
    scene.hidden_m[0] = -0.0125; /* square 16 and the cells next to it */
    scene.hidden_m[1] = 0.0175;
    render_and_locate();
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, cold.location.state);
    assert_followed(&hint);

    scene = bar_scene();
    scene.white = 400;
    render_and_locate();
    TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, cold.location.state);
    TEST_ASSERT_TRUE(cold.location.bar.white_fraction_saturated > 0.3);
    assert_followed(&hint);
}

static void the_same_hint_twice_gives_the_same_bits(void)
{
    opms_transform_t hint = scene.bar_camera;
    hint.t_m[0] += 0.004;
    bar_render8(&scene, picture);
    locate(&hint, &cold);
    TEST_ASSERT_EQUAL_UINT32(1, cold.location.followed);
    locate(NULL, &hinted);
    locate(&hint, &hinted);
    TEST_ASSERT_EQUAL_MEMORY(&cold, &hinted, sizeof cold);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_hint_that_is_about_right_is_followed);
    RUN_TEST(a_hint_off_by_whole_squares_is_found_out_by_the_codes);
    RUN_TEST(a_hint_turned_by_half_a_turn_is_found_out);
    RUN_TEST(hints_that_are_nowhere_near_change_nothing);
    RUN_TEST(a_hint_finds_no_bar_where_there_is_none);
    RUN_TEST(a_covered_square_and_saturated_white_are_followed);
    RUN_TEST(the_same_hint_twice_gives_the_same_bits);
    return UNITY_END();
}
