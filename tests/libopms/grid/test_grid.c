/* SPDX-License-Identifier: Apache-2.0 */
/* Nodes of rendered grids against where the tests' own camera model has them. */
#include "grid_scene.h"

static grid_scene_t scene;
static opms_grid_detector_t *detector;
static opms_grid_summary_t summary;
static opms_error_t err;

/** How the nodes of the last picture compare with the truth. */
static struct {
    double rms_px, worst_px, rms_sigmas, found;
    int wrong;
} got;

void setUp(void)
{
    opms_grid_options_t options;
    opms_grid_options_init(&options);
    options.width_px = SCENE_WIDTH;
    options.height_px = SCENE_HEIGHT;
    memset(&err, 0, sizeof err);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_grid_detector_create(&options, &detector, &err));
    scene_usual(&scene);
}

void tearDown(void)
{
    opms_grid_detector_destroy(detector);
}

static void detect(uint64_t seed)
{
    scene_draw(&scene, seed);
    const opms_image_t image = scene_image(&scene);
    TEST_ASSERT_EQUAL(OPMS_OK, opms_grid_detect(detector, &image, &summary, &err));
}

static uint32_t nodes_in_picture(double margin)
{
    uint32_t count = 0;
    for (int32_t x = 34; x <= 66; ++x) {
        for (int32_t y = 28; y <= 72; ++y) {
            const int32_t label[2] = {x, y};
            double px[2];
            count += (uint32_t)scene_node(&scene, label, margin, px);
        }
    }
    return count;
}

static void compare(void)
{
    uint32_t count, whole = 0;
    double sum = 0.0, sigmas = 0.0;
    const opms_node_t *nodes = opms_grid_nodes(detector, &count);
    memset(&got, 0, sizeof got);
    TEST_ASSERT_EQUAL_UINT32(summary.node_count, count);
    for (uint32_t i = 0; i < count; ++i) {
        double px[2];
        whole += (uint32_t)scene_node(&scene, nodes[i].label, 5.0, px);
        const double off = hypot(nodes[i].px[0] - px[0], nodes[i].px[1] - px[1]);
        if (off > 3.0) {
            ++got.wrong;
            continue;
        }
        sum += off * off;
        sigmas += off * off / (2.0 * nodes[i].sigma_px * nodes[i].sigma_px);
        got.worst_px = off > got.worst_px ? off : got.worst_px;
    }
    got.rms_px = sqrt(sum / count);
    got.rms_sigmas = sqrt(sigmas / count);
    got.found = (double)whole / nodes_in_picture(5.0);
}

static void detect_and_compare(uint64_t seed)
{
    detect(seed);
    TEST_ASSERT_EQUAL(OPMS_GRID_LABELLED, summary.state);
    compare();
    TEST_ASSERT_EQUAL(0, got.wrong);
}

static void all_nodes_are_found_within_hundredths_of_a_pixel(void)
{
    detect_and_compare(1);
    TEST_ASSERT_TRUE(got.found >= 0.98);
    TEST_ASSERT_TRUE(got.rms_px < 0.03);
    TEST_ASSERT_TRUE(got.rms_sigmas > 0.6 && got.rms_sigmas < 1.4);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 2.0, summary.noise);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, 0.6, summary.blur_px);
}

static void the_grid_may_be_turned_any_way(void)
{
    for (int k = 0; k < 6; ++k) {
        scene_place(&scene, -0.03, 0.05, 0.4, 1.0472 * k, 0.3, 0.7 * k);
        detect_and_compare((uint64_t)k);
        TEST_ASSERT_TRUE(got.found >= 0.97);
        TEST_ASSERT_TRUE(got.rms_px < 0.03);
    }
}

static void an_oblique_plate_is_read(void)
{
    scene_place(&scene, 0.0, 0.0, 0.4, 0.2, 1.0, 0.4); /* 57 degrees */
    detect_and_compare(3);
    TEST_ASSERT_TRUE(summary.node_count > 150);
    TEST_ASSERT_TRUE(got.rms_px < 0.04);
}

static void near_and_far_lines_are_read(void)
{
    scene_place(&scene, 0.0, 0.0, 0.18, 0.4, 0.2, 0.0); /* 6 px wide */
    detect_and_compare(4);
    TEST_ASSERT_TRUE(got.rms_px < 0.03);
    scene_place(&scene, 0.0, 0.0, 0.62, 0.4, 0.2, 0.0); /* 1.4 px */
    detect_and_compare(5);
    TEST_ASSERT_TRUE(got.found > 0.97);
    TEST_ASSERT_TRUE(got.rms_px < 0.04);
}

static void uneven_light_does_not_pull_the_nodes(void)
{
    scene.sheet.slope = 2.0;
    scene.noise = 0.5;
    detect_and_compare(6);
    TEST_ASSERT_TRUE(got.rms_px < 0.03);
}

static void a_shadow_edge_harms_few_nodes(void)
{
    scene.sheet.shadow = 0.5;
    detect_and_compare(7);
    TEST_ASSERT_TRUE(got.found > 0.9);
    TEST_ASSERT_TRUE(got.rms_px < 0.1);
}

static void blur_does_not_pull_the_nodes(void)
{
    scene.blur_px = 1.5;
    detect_and_compare(8);
    TEST_ASSERT_TRUE(got.rms_px < 0.04);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1.5, summary.blur_px);
}

static void nodes_around_a_hand_are_still_found(void)
{
    const double hand[3] = {-0.1, 0.1, 0.06};
    memcpy(scene.sheet.hand_m, hand, sizeof hand);
    detect_and_compare(9);
    TEST_ASSERT_TRUE(got.found > 0.85);
    TEST_ASSERT_TRUE(got.rms_px < 0.06);
}

static void without_its_marker_a_grid_has_no_labels(void)
{
    scene.sheet.marker = 0;
    detect(10);
    TEST_ASSERT_EQUAL(OPMS_GRID_UNLABELLED, summary.state);
    TEST_ASSERT_TRUE(summary.node_count > 0.9 * nodes_in_picture(5.0));
}

static void a_neighbouring_picture_lends_its_labels_where_the_camera_hardly_moved(void)
{
    static opms_node_t known[OPMS_GRID_NODES_MAX], nodes[OPMS_GRID_NODES_MAX];
    uint32_t known_count, count, certain = 9;
    detect_and_compare(11);
    memcpy(known, opms_grid_nodes(detector, &known_count), sizeof known);
    scene.sheet.marker = 0;
    scene_place(&scene, 0.023, -0.028, 0.452, 0.303, 0.35, 1.0);
    detect(12);
    memcpy(nodes, opms_grid_nodes(detector, &count), sizeof nodes);
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_grid_relabel(known, known_count, nodes, count, &certain, &err));
    TEST_ASSERT_EQUAL_UINT32(1, certain);
    for (uint32_t i = 0; i < count; ++i) {
        double px[2];
        scene_node(&scene, nodes[i].label, 0.0, px);
        TEST_ASSERT_TRUE(hypot(px[0] - nodes[i].px[0], px[1] - nodes[i].px[1]) < 1.0);
    }
    /* Moved by half a pitch: it could be either. */
    scene_place(&scene, 0.0325, -0.03, 0.45, 0.3, 0.35, 1.0);
    detect(13);
    memcpy(nodes, opms_grid_nodes(detector, &count), sizeof nodes);
    TEST_ASSERT_EQUAL(OPMS_OK,
                      opms_grid_relabel(known, known_count, nodes, count, &certain, &err));
    TEST_ASSERT_EQUAL_UINT32(0, certain);
}

static double stripes(int x, int y)
{
    (void)y;
    return x % 20 < 3 ? 30.0 : 200.0;
}

static double chessboard(int x, int y)
{
    return (x / 25 + y / 25) % 2 ? 30.0 : 200.0;
}

static double white(int x, int y)
{
    (void)x;
    (void)y;
    return 255.0;
}

static double noise(int x, int y)
{
    uint64_t state = (uint64_t)(x + 4096 * y);
    return truth_uniform(&state, 0.0, 255.0);
}

static double black(int x, int y)
{
    (void)x;
    (void)y;
    return 0.0;
}

static void where_no_grid_is_none_is_found(void)
{
    double (*const pictures[])(int, int) = {stripes, chessboard, white, noise, black};
    for (size_t k = 0; k < sizeof pictures / sizeof *pictures; ++k) {
        for (int i = 0; i < SCENE_WIDTH * SCENE_HEIGHT; ++i)
            scene.grey[i] = (uint8_t)pictures[k](i % SCENE_WIDTH, i / SCENE_WIDTH);
        const opms_image_t image = scene_image(&scene);
        TEST_ASSERT_EQUAL(OPMS_OK, opms_grid_detect(detector, &image, &summary, &err));
        TEST_ASSERT_NOT_EQUAL(OPMS_GRID_LABELLED, summary.state);
    }
}

static void sixteen_bit_pictures_give_the_same_nodes(void)
{
    uint32_t count, again;
    detect_and_compare(14);
    static opms_node_t nodes[OPMS_GRID_NODES_MAX];
    memcpy(nodes, opms_grid_nodes(detector, &count), sizeof nodes);
    for (int i = 0; i < SCENE_WIDTH * SCENE_HEIGHT; ++i)
        scene.wide[i] = (uint16_t)(scene.grey[i] * 16);
    opms_image_t image = scene_image(&scene);
    image.pixels = scene.wide;
    image.stride_bytes = 2 * SCENE_WIDTH;
    image.format = OPMS_PIXEL_GREY16;
    image.white_level = 4095;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_grid_detect(detector, &image, &summary, &err));
    const opms_node_t *wide = opms_grid_nodes(detector, &again);
    TEST_ASSERT_EQUAL_UINT32(count, again);
    for (uint32_t i = 0; i < count; ++i)
        TEST_ASSERT_DOUBLE_WITHIN(0.002, nodes[i].px[0], wide[i].px[0]);
}

static void bad_calls_say_what_is_wrong(void)
{
    opms_grid_options_t options;
    opms_grid_detector_t *none = NULL;
    opms_image_t image = scene_image(&scene);
    opms_grid_options_init(&options);
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detector_create(&options, &none, &err));
    options.width_px = options.height_px = 100;
    options.min_pitch_px = 3.0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detector_create(&options, &none, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "min_pitch_px"));
    image.width_px = 639;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detect(detector, &image, &summary, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "639"));
    image = scene_image(&scene);
    image.stride_bytes = 10;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detect(detector, &image, &summary, &err));
    image = scene_image(&scene);
    image.white_level = 256;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detect(detector, &image, &summary, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, "white_level"));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_grid_detect(detector, NULL, &summary, &err));
    opms_grid_detector_destroy(NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_nodes_are_found_within_hundredths_of_a_pixel);
    RUN_TEST(the_grid_may_be_turned_any_way);
    RUN_TEST(an_oblique_plate_is_read);
    RUN_TEST(near_and_far_lines_are_read);
    RUN_TEST(uneven_light_does_not_pull_the_nodes);
    RUN_TEST(a_shadow_edge_harms_few_nodes);
    RUN_TEST(blur_does_not_pull_the_nodes);
    RUN_TEST(nodes_around_a_hand_are_still_found);
    RUN_TEST(without_its_marker_a_grid_has_no_labels);
    RUN_TEST(a_neighbouring_picture_lends_its_labels_where_the_camera_hardly_moved);
    RUN_TEST(where_no_grid_is_none_is_found);
    RUN_TEST(sixteen_bit_pictures_give_the_same_nodes);
    RUN_TEST(bad_calls_say_what_is_wrong);
    return UNITY_END();
}
