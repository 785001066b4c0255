/* SPDX-License-Identifier: Apache-2.0 */
/* The control of exposure and gain, against a camera that answers late. */
#include "exposure_world.h"

#include "../counting_allocator.h"

static world_t world;

void setUp(void)
{
    world_begin(&world, NULL);
}

void tearDown(void)
{
    opms_exposure_destroy(world.control);
}

static void begin_with(const opms_exposure_options_t *options)
{
    opms_exposure_destroy(world.control);
    world_begin(&world, options);
}

/* Frames until the white is where it shall be, and stays there. */
static int frames_to_settle(void)
{
    int settled = 0;
    for (int i = 1; i <= 60; ++i) {
        world_step(&world);
        settled = world_is_well_exposed(&world) ? (settled ? settled : i) : 0;
    }
    return settled;
}

static void a_step_of_three_stops_is_made_up_for_in_five_frames(void)
{
    for (int delay = 0; delay <= 6; ++delay) {
        for (int stops = -3; stops <= 3; ++stops) {
            begin_with(NULL);
            world.delay = delay;
            world_steps(&world, 40);
            TEST_ASSERT_TRUE(world_is_well_exposed(&world));
            world.light *= pow(2.0, stops);
            const int took = frames_to_settle();
            TEST_ASSERT_TRUE(took > 0);
            TEST_ASSERT_TRUE(took <= 5 + delay);
        }
    }
}

static void a_bar_out_of_reach_of_prediction_is_found_again(void)
{
    for (int stops = -3; stops <= 3; ++stops) {
        begin_with(NULL);
        world_steps(&world, 40);
        world.hidden = 1;
        world_steps(&world, 50);
        world.hidden = 0;
        world.known = 0;
        world.light *= pow(2.0, stops);
        int frames = 0;
        for (; frames < 60 && world.frame.squares_located == 0; ++frames) {
            world_step(&world);
        }
        TEST_ASSERT_TRUE(frames <= 5 + world.delay);
        world.known = 1;
        world_steps(&world, 8);
        TEST_ASSERT_TRUE(world_is_well_exposed(&world));
    }
}

/* Nothing is left in the picture to judge by but that it is white, or black. */
static void a_change_of_six_stops_is_found_out(void)
{
    for (int stops = -6; stops <= 6; stops += 12) {
        begin_with(NULL);
        world_steps(&world, 40);
        world.light *= pow(2.0, stops);
        TEST_ASSERT_TRUE(frames_to_settle() > 0);
    }
}

/* The ground is not always darker than the bar: dry grass, sand, snow. */
static void a_ground_unlike_the_last_is_searched_through(void)
{
    world_steps(&world, 40);
    world.hidden = 1;
    world.known = 0;
    world.ground = 1.5;
    world_steps(&world, 50);
    world.hidden = 0;
    int frames = 0;
    for (; frames < 60 && world.frame.squares_located == 0; ++frames) {
        world_step(&world);
    }
    TEST_ASSERT_TRUE(frames < 20);
}

static void the_first_picture_may_be_black_or_white(void)
{
    for (int stops = -6; stops <= 6; ++stops) {
        begin_with(NULL);
        world.known = 0;
        world.light *= pow(2.0, 0.5 * stops);
        for (int i = 0; i < 60 && world.frame.squares_located == 0; ++i) {
            world_step(&world);
        }
        TEST_ASSERT_TRUE(world.frame.squares_located > 0);
        world.known = 1;
        world_steps(&world, 10);
        TEST_ASSERT_TRUE(world_is_well_exposed(&world));
    }
}

static void under_a_steady_light_nothing_is_changed(void)
{
    world_steps(&world, 40);
    const opms_exposure_command_t before = world.command;
    for (int i = 0; i < 6000; ++i) {
        world_step(&world);
        TEST_ASSERT_EQUAL_DOUBLE(before.exposure_us, world.command.exposure_us);
        TEST_ASSERT_EQUAL_DOUBLE(before.gain_db, world.command.gain_db);
        TEST_ASSERT_EQUAL(OPMS_EXPOSURE_HOLDING, world.command.state);
    }
}

/* Ten minutes at 10 Hz of clouds: the light follows the sum of three slow waves, two stops up and
 * down, and a cloud's edge now and then. */
static void moving_clouds_are_followed_without_swinging(void)
{
    const double start = world.light;
    int well = 0, cut = 0, turns = 0, light_turns = 0;
    double last = 0.0, last_move = 0.0, last_light = start, last_light_move = 0.0;
    world_steps(&world, 40);
    for (int i = 0; i < 6000; ++i) {
        const double t = 0.1 * i;
        world.light = start * pow(2.0, 0.9 * sin(t / 7.1) + 0.7 * sin(t / 17.3) +
                                           0.4 * sin(t / 3.9) + (i / 450 % 2 ? 0.8 : 0.0));
        world_step(&world);
        well += world.frame.light.white > 0.62 && world.frame.light.white < 0.9;
        cut += world.frame.light.saturated > 0.005;
        const double product = world.command.exposure_us * pow(10, world.command.gain_db / 20);
        const double move = log(product / (last > 0.0 ? last : product));
        turns += move * last_move < 0.0;
        last_move = move != 0.0 ? move : last_move;
        last = product;
        const double light_move = log(world.light / last_light);
        light_turns += light_move * last_light_move < 0.0;
        last_light_move = light_move != 0.0 ? light_move : last_light_move;
        last_light = world.light;
    }
    TEST_ASSERT_TRUE(well > 5900);
    TEST_ASSERT_TRUE(cut < 60);
    /* It turns round when the light does, and hardly ever else. */
    TEST_ASSERT_TRUE(turns <= light_turns + 20);
}

static void a_fast_sweep_gets_a_short_shutter_and_gain_instead(void)
{
    world.light = 0.75 / 8000.0;
    world_steps(&world, 40);
    TEST_ASSERT_DOUBLE_WITHIN(800.0, 8000.0, world.command.exposure_us);
    TEST_ASSERT_FALSE(world.command.blur_limited);
    world.speed_px_s = 1000.0;
    world_steps(&world, 10);
    TEST_ASSERT_TRUE(world.command.exposure_us <= 2000.0);
    TEST_ASSERT_TRUE(world.command.blur_limited);
    TEST_ASSERT_TRUE(world_is_well_exposed(&world));
    world.speed_px_s = 0.0;
    world_steps(&world, 60);
    TEST_ASSERT_DOUBLE_WITHIN(800.0, 8000.0, world.command.exposure_us);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.command.gain_db);
}

static void the_cameras_limits_are_told(void)
{
    world.light = 0.75 / 3000000.0;
    world_steps(&world, 60);
    TEST_ASSERT_EQUAL(OPMS_EXPOSURE_TOO_DARK, world.command.state);
    TEST_ASSERT_EQUAL_DOUBLE(30000.0, world.command.exposure_us);
    TEST_ASSERT_EQUAL_DOUBLE(24.0, world.command.gain_db);
    world.light = 0.75 / 10.0;
    world_steps(&world, 60);
    TEST_ASSERT_EQUAL(OPMS_EXPOSURE_TOO_BRIGHT, world.command.state);
    TEST_ASSERT_EQUAL_DOUBLE(20.0, world.command.exposure_us);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, world.command.gain_db);
}

/* 60 % of the bar lies in the sun; the rest gets a tenth of the light, and is black by the grey
 * levels' rule. Twice the exposure shows it. */
static void squares_decide_where_grey_levels_cannot(void)
{
    world.shaded_part = 0.4;
    world.shade = 0.1;
    world_steps(&world, 120);
    TEST_ASSERT_EQUAL_UINT32(WORLD_SQUARES, world.frame.squares_located);
    TEST_ASSERT_TRUE(world.frame.light.saturated > 0.1);
}

static void what_cannot_be_mended_by_light_is_left_alone(void)
{
    world.shaded_part = 0.4;
    world.shade = 0.0; /* something lies on it */
    world_steps(&world, 60);
    int well = 0;
    for (int i = 0; i < 1000; ++i) {
        world_step(&world);
        well += world_is_well_exposed(&world);
    }
    TEST_ASSERT_TRUE(well > 700);
}

static void a_camera_that_does_not_obey_does_no_harm(void)
{
    for (int i = 0; i < 500; ++i) {
        world_step(&world);
        for (int k = 0; k <= WORLD_DELAY_MOST; ++k) {
            world.queue[k].exposure_us = 500.0; /* a quarter of what is needed */
            world.queue[k].gain_db = 0.0;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(200.0, 2000.0, world.command.exposure_us);
}

static void assert_refused(const opms_exposure_frame_t *frame, const char *what)
{
    opms_error_t err;
    opms_exposure_command_t command;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_push(world.control, frame, &command, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, what));
}

static void bad_calls_say_what_is_wrong(void)
{
    opms_error_t err;
    opms_exposure_t *none;
    opms_exposure_options_t options;
    world_steps(&world, 5);
    opms_exposure_frame_t frame = world.frame;
    frame.exposure_us = 0.0;
    assert_refused(&frame, "exposure");
    frame = world.frame;
    frame.light.white = NAN;
    assert_refused(&frame, "levels");
    frame = world.frame;
    frame.speed_px_s = -1.0;
    assert_refused(&frame, "speed");
    assert_refused(NULL, "frame");
    opms_exposure_options_init(&options);
    options.exposure_max_us = 1.0;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_create(&options, &none, &err));
    opms_exposure_options_init(&options);
    options.struct_size = 8;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_create(&options, &none, &err));
    opms_exposure_options_init(&options);
    options.white_low = 0.9;
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_create(&options, &none, &err));
    TEST_ASSERT_EQUAL(OPMS_ERR_ARG, opms_exposure_create(NULL, NULL, &err));
    opms_exposure_options_init(NULL);
    opms_exposure_destroy(NULL);
}

static void all_memory_comes_from_the_callers_allocator(void)
{
    opms_error_t err;
    opms_exposure_t *made;
    opms_exposure_options_t options;
    count_t count = {0, 0, 1};
    opms_exposure_options_init(&options);
    options.allocator.alloc = counting_alloc;
    options.allocator.free = counting_free;
    options.allocator.user = &count;
    TEST_ASSERT_EQUAL(OPMS_ERR_MEMORY, opms_exposure_create(&options, &made, &err));
    TEST_ASSERT_EQUAL(OPMS_OK, opms_exposure_create(&options, &made, &err));
    TEST_ASSERT_EQUAL(1, count.live);
    opms_exposure_destroy(made);
    TEST_ASSERT_EQUAL(0, count.live);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_step_of_three_stops_is_made_up_for_in_five_frames);
    RUN_TEST(a_bar_out_of_reach_of_prediction_is_found_again);
    RUN_TEST(a_change_of_six_stops_is_found_out);
    RUN_TEST(a_ground_unlike_the_last_is_searched_through);
    RUN_TEST(the_first_picture_may_be_black_or_white);
    RUN_TEST(under_a_steady_light_nothing_is_changed);
    RUN_TEST(moving_clouds_are_followed_without_swinging);
    RUN_TEST(a_fast_sweep_gets_a_short_shutter_and_gain_instead);
    RUN_TEST(the_cameras_limits_are_told);
    RUN_TEST(squares_decide_where_grey_levels_cannot);
    RUN_TEST(what_cannot_be_mended_by_light_is_left_alone);
    RUN_TEST(a_camera_that_does_not_obey_does_no_harm);
    RUN_TEST(bad_calls_say_what_is_wrong);
    RUN_TEST(all_memory_comes_from_the_callers_allocator);
    return UNITY_END();
}
