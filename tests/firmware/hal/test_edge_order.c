/* SPDX-License-Identifier: Apache-2.0 */
/* From edges to inputs: which pulse is the run's first, what is a START, and in which order. */
#include <unity.h>

#include "edge_bench.h"

#define MS(ms) ((box_cycles_t)(ms)*BOX_CYCLES_PER_MS)
#define T0 MS(5000)    /* armed */
#define FIRST (T0 + 90) /* the preamble's first pulse, or where it would be */
#define D ((box_cycles_t)settings.debounce_cycles)

void setUp(void)
{
    edge_bench_init();
}

void tearDown(void)
{
}

static void arm(void)
{
    edge_order_armed(&order, &settings, T0);
}

/* The default preamble: pulses at 0, 100, 300, 400, 700 and 800 ms. */
static void preamble(uint32_t pulses)
{
    static const uint32_t at_ms[] = {0, 100, 300, 400, 700, 800};
    for (uint32_t i = 0; i < pulses; i++)
        edge_bench_pulse(FIRST + MS(at_ms[i]));
}

static void start(box_cycles_t edge, box_cycles_t length)
{
    edge_bench_high(EDGE_LINE_START, edge, edge + length);
    edge_bench_pulse(edge + D + OPMS_BOX_START_CYCLES);
}

static void test_a_run_after_the_preamble_is_told_with_its_edge_to_the_cycle(void)
{
    for (box_cycles_t odd = 0; odd < 2; odd++) {
        edge_bench_init();
        arm();
        preamble(6);
        box_cycles_t edge = T0 + MS(2000) + odd;
        start(edge, MS(3));
        edge_bench_pulse(edge + D + 4 + MS(100));
        edge_bench_tell(T0 + MS(3000));
        TEST_ASSERT_EQUAL_STRING("APPPPPPTPP", edge_bench_kinds());
        TEST_ASSERT_EQUAL_UINT64(edge, edge_bench_the(BOX_INPUT_START)->time);
        TEST_ASSERT_EQUAL(7, told[8].number);
    }
}

static void test_numbers_begin_at_1_with_each_arming_though_hardware_counts_on_over_its_wrap(void)
{
    for (int session = 0; session < 3; session++) {
        arm();
        preamble(6);
        edge_bench_tell(T0 + MS(1000));
        for (uint32_t i = 0; i < 6; i++)
            TEST_ASSERT_EQUAL(i + 1, told[told_count - 6 + i].number);
        edge_order_stopped(&order, T0 + MS(1000));
        edge_bench_tell(T0 + MS(1000));
    }
}

static void test_a_start_within_the_preamble_makes_the_next_pulse_the_runs_first(void)
{
    for (uint32_t sent = 1; sent < 6; sent++) {
        edge_bench_init();
        arm();
        preamble(sent);
        box_cycles_t edge = FIRST + MS(100 * sent + 33) + 1;
        if (sent > 1)
            edge = FIRST + MS(800) - MS(3);
        start(edge, MS(20));
        edge_bench_tell(T0 + MS(2000));
        TEST_ASSERT_EQUAL_UINT64(edge, edge_bench_the(BOX_INPUT_START)->time);
        TEST_ASSERT_EQUAL(sent + 1, told[told_count - 1].number);
        TEST_ASSERT_EQUAL(BOX_INPUT_START, told[told_count - 2].kind);
    }
}

static void test_a_start_whose_pulse_leaves_just_when_one_of_the_preamble_was_due_is_a_start(void)
{
    arm();
    preamble(1);
    box_cycles_t edge = FIRST + MS(100) - D - OPMS_BOX_START_CYCLES;
    start(edge, MS(5));
    edge_bench_pulse(edge + D + OPMS_BOX_START_CYCLES + MS(100));
    edge_bench_tell(T0 + MS(2000));
    TEST_ASSERT_EQUAL_STRING("APTPP", edge_bench_kinds());
    TEST_ASSERT_EQUAL_UINT64(edge, edge_bench_the(BOX_INPUT_START)->time);
}

static void test_a_glitch_within_the_preamble_makes_no_run(void)
{
    arm();
    preamble(2);
    edge_bench_high(EDGE_LINE_START, FIRST + MS(150), FIRST + MS(150) + D - 1);
    edge_bench_pulse(FIRST + MS(300));
    edge_bench_tell(T0 + MS(399));
    TEST_ASSERT_EQUAL_STRING("APPGP", edge_bench_kinds());
    const box_input_t *glitch = edge_bench_the(BOX_INPUT_GLITCH);
    TEST_ASSERT_UINT64_WITHIN(1, FIRST + MS(150), glitch->time);
    TEST_ASSERT_UINT_WITHIN(1, D - 1, glitch->length_cycles);
}

static void test_a_glitch_is_never_told_as_long_as_the_debounce(void)
{
    arm();
    preamble(6);
    for (box_cycles_t phase = 0; phase < 2; phase++) {
        box_cycles_t rise = FIRST + MS(1000 + 100 * phase) + phase;
        edge_bench_high(EDGE_LINE_START, rise, rise + D - 1);
    }
    edge_bench_tell(T0 + MS(3000));
    TEST_ASSERT_EQUAL_STRING("APPPPPPGG", edge_bench_kinds());
    for (uint32_t i = 7; i < 9; i++)
        TEST_ASSERT_LESS_THAN(D, told[i].length_cycles);
}

static void test_a_noisy_start_is_one_start(void)
{
    arm();
    preamble(6);
    box_cycles_t edge = FIRST + MS(1500);
    edge_bench_rise(EDGE_LINE_START, edge);
    edge_bench_pulse(edge + D + OPMS_BOX_START_CYCLES);
    edge_bench_tell(edge + D + 300);
    TEST_ASSERT_EQUAL_STRING("APPPPPPTP", edge_bench_kinds());
    /* Its end comes later, and tells nothing. */
    edge_bench_fall(EDGE_LINE_START, edge + MS(50));
    edge_bench_tell(edge + MS(60));
    TEST_ASSERT_EQUAL_STRING("APPPPPPTP", edge_bench_kinds());
}

static void test_a_start_while_running_is_told_when_its_debounce_has_passed(void)
{
    settings.preamble_gap_ms[0] = 0;
    arm();
    start(T0 + MS(10), MS(5));
    edge_bench_tell(T0 + MS(20));
    edge_bench_rise(EDGE_LINE_START, T0 + MS(30));
    edge_bench_tell(T0 + MS(30) + D - 1);
    TEST_ASSERT_EQUAL_STRING("ATP", edge_bench_kinds());
    edge_bench_tell(T0 + MS(30) + D + 1);
    TEST_ASSERT_EQUAL_STRING("ATPT", edge_bench_kinds());
    TEST_ASSERT_EQUAL_UINT64(T0 + MS(30), told[3].time);
    edge_bench_fall(EDGE_LINE_START, T0 + MS(33));
    edge_bench_high(EDGE_LINE_START, T0 + MS(40), T0 + MS(40) + 20);
    edge_bench_tell(T0 + MS(50));
    TEST_ASSERT_EQUAL_STRING("ATPTG", edge_bench_kinds());
}

static void test_a_start_that_was_high_before_arming_is_told_before_it(void)
{
    edge_bench_rise(EDGE_LINE_START, T0 - 10);
    arm();
    preamble(6);
    edge_bench_tell(T0 + MS(1000));
    TEST_ASSERT_EQUAL_STRING("TAPPPPPP", edge_bench_kinds());
}

static void test_a_long_high_without_a_pulse_is_no_start_while_the_box_waits(void)
{
    /* A drop that the generator saw and the tagger did not. */
    arm();
    preamble(6);
    edge_bench_high(EDGE_LINE_START, FIRST + MS(1000), FIRST + MS(1000) + D + 60);
    edge_bench_tell(T0 + MS(3000));
    TEST_ASSERT_EQUAL_STRING("APPPPPPG", edge_bench_kinds());
}

static void test_stopped_comes_after_all_pulses_and_a_start_after_it_is_told_as_such(void)
{
    settings.preamble_gap_ms[0] = 0;
    arm();
    start(T0 + MS(10), MS(5));
    edge_bench_pulse(T0 + MS(110) + D + 4);
    edge_order_stopped(&order, T0 + MS(150));
    edge_bench_high(EDGE_LINE_START, T0 + MS(160), T0 + MS(170));
    edge_bench_tell(T0 + MS(200));
    TEST_ASSERT_EQUAL_STRING("ATPPST", edge_bench_kinds());
}

static void test_exposures_are_told_at_their_end_with_their_begin_and_length(void)
{
    settings.preamble_gap_ms[0] = 0;
    arm();
    start(T0 + MS(10), MS(5));
    box_cycles_t pulse = T0 + MS(10) + D + 4;
    edge_bench_high(EDGE_LINE_STROBE, pulse + 1001, pulse + 1001 + MS(8));
    edge_bench_pulse(pulse + MS(100));
    edge_bench_rise(EDGE_LINE_STROBE, pulse + MS(100) + 1000);
    edge_bench_tell(pulse + MS(101));
    TEST_ASSERT_EQUAL_STRING("ATPEP", edge_bench_kinds());
    const box_input_t *exposure = edge_bench_the(BOX_INPUT_STROBE);
    TEST_ASSERT_UINT64_WITHIN(1, pulse + 1001, exposure->time);
    TEST_ASSERT_UINT_WITHIN(1, MS(8), exposure->length_cycles);
}

static void test_with_no_debounce_a_cut_pulse_and_the_runs_first_may_share_a_tag(void)
{
    settings.debounce_cycles = 0;
    arm();
    preamble(2);
    /* START rises with the preamble's third pulse: TRIG falls and rises within 4 cycles. */
    box_cycles_t third = FIRST + MS(300);
    edge_bench_high(EDGE_LINE_START, third, third + MS(1));
    edge_bench_pulse(third);
    edge_bench_pulse(third + 4 + MS(100));
    edge_bench_tell(T0 + MS(1000));
    TEST_ASSERT_EQUAL_STRING("APPTPP", edge_bench_kinds());
    TEST_ASSERT_UINT64_WITHIN(4, third, edge_bench_the(BOX_INPUT_START)->time);
}

static void test_with_no_debounce_two_tags_close_together_are_two_pulses(void)
{
    settings.debounce_cycles = 0;
    arm();
    preamble(2);
    box_cycles_t third = FIRST + MS(300);
    edge_bench_high(EDGE_LINE_START, third, third + MS(1));
    edge_bench_pulse(third);
    edge_bench_pulse(third + 4);
    edge_bench_tell(T0 + MS(1000));
    TEST_ASSERT_EQUAL_STRING("APPPTP", edge_bench_kinds());
    TEST_ASSERT_EQUAL_UINT64(third, edge_bench_the(BOX_INPUT_START)->time);
}

static void test_lost_pulses_leave_a_gap_in_the_numbers_and_the_run_is_still_found(void)
{
    arm();
    preamble(1);
    edge_bench_lose_pulses(2);
    edge_bench_pulse(FIRST + MS(400));
    edge_bench_tell(T0 + MS(450));
    TEST_ASSERT_EQUAL_STRING("APP", edge_bench_kinds());
    TEST_ASSERT_EQUAL(4, told[2].number);
    edge_bench_lose_pulses(10);
    edge_bench_pulse(T0 + MS(5000));
    edge_bench_tell(T0 + MS(5001));
    TEST_ASSERT_EQUAL_STRING("APPTP", edge_bench_kinds());
    TEST_ASSERT_EQUAL(15, told[4].number);
}

static void test_edges_of_a_change_of_polarity_are_forgotten(void)
{
    edge_bench_rise(EDGE_LINE_START, MS(1));
    edge_bench_rise(EDGE_LINE_STROBE, MS(1));
    edge_bench_pulse(MS(1));
    edge_order_set_lines(&order, &settings);
    edge_bench_fall(EDGE_LINE_START, MS(2));
    edge_bench_fall(EDGE_LINE_STROBE, MS(2));
    edge_bench_tell(MS(100));
    TEST_ASSERT_EQUAL_STRING("", edge_bench_kinds());
    arm();
    preamble(1);
    edge_bench_tell(T0 + MS(1));
    TEST_ASSERT_EQUAL_STRING("AP", edge_bench_kinds());
    TEST_ASSERT_EQUAL(1, told[1].number);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_run_after_the_preamble_is_told_with_its_edge_to_the_cycle);
    RUN_TEST(test_numbers_begin_at_1_with_each_arming_though_hardware_counts_on_over_its_wrap);
    RUN_TEST(test_a_start_within_the_preamble_makes_the_next_pulse_the_runs_first);
    RUN_TEST(test_a_start_whose_pulse_leaves_just_when_one_of_the_preamble_was_due_is_a_start);
    RUN_TEST(test_a_glitch_within_the_preamble_makes_no_run);
    RUN_TEST(test_a_glitch_is_never_told_as_long_as_the_debounce);
    RUN_TEST(test_a_noisy_start_is_one_start);
    RUN_TEST(test_a_start_while_running_is_told_when_its_debounce_has_passed);
    RUN_TEST(test_a_start_that_was_high_before_arming_is_told_before_it);
    RUN_TEST(test_a_long_high_without_a_pulse_is_no_start_while_the_box_waits);
    RUN_TEST(test_stopped_comes_after_all_pulses_and_a_start_after_it_is_told_as_such);
    RUN_TEST(test_exposures_are_told_at_their_end_with_their_begin_and_length);
    RUN_TEST(test_with_no_debounce_a_cut_pulse_and_the_runs_first_may_share_a_tag);
    RUN_TEST(test_with_no_debounce_two_tags_close_together_are_two_pulses);
    RUN_TEST(test_lost_pulses_leave_a_gap_in_the_numbers_and_the_run_is_still_found);
    RUN_TEST(test_edges_of_a_change_of_polarity_are_forgotten);
    return UNITY_END();
}
