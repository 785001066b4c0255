/* SPDX-License-Identifier: Apache-2.0 */
/* The signal generator without hardware: plan, run and report in a time that tests make. */
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <unity.h>

#include "edge_report.hpp"
#include "siggen_plan.hpp"
#include "siggen_run.hpp"

using namespace opms::siggen;

constexpr std::int64_t MS = 1000000, US = 1000;

void setUp(void)
{
}

void tearDown(void)
{
}

/** Time passes when somebody sleeps or waits, and a little at each look at it. */
class FakeClock : public Clock {
public:
    std::int64_t now_ns() override { return t_ns += 100; }
    void sleep_until_ns(std::int64_t until_ns) override
    {
        t_ns = std::max(t_ns, until_ns) + wake_up_ns;
    }

    std::int64_t t_ns = 5000 * MS;
    std::int64_t wake_up_ns = 0; /**< how long the system takes to wake us */
};

/** A box on the other end: it rejects what is shorter than its debounce, and then runs. */
class FakeBox : public Lines {
public:
    explicit FakeBox(FakeClock &clock) : clock_(clock) {}

    void set(gpio_role_t output, bool active) override
    {
        if (output == GPIO_STROBE) {
            exposures += active && !strobe_;
            strobe_ = active;
            return;
        }
        const std::int64_t held_ns = clock_.t_ns - rise_ns_;
        if (start_ && !active && held_ns < debounce_ns) {
            ++glitches;
        } else if (start_ && !active && !runs()) {
            first_ns_ = rise_ns_ + debounce_ns + 32;
        }
        if (active && !start_) {
            rise_ns_ = clock_.t_ns;
        }
        start_ = active;
    }

    std::vector<gpio_edge_t> wait(std::int64_t timeout_ns) override
    {
        std::vector<gpio_edge_t> edges;
        if (!runs()) {
            clock_.t_ns += timeout_ns;
            return edges;
        }
        const std::int64_t next_ns = first_ns_ + sent_ * period_ns;
        clock_.t_ns = std::min(clock_.t_ns + timeout_ns, std::max(clock_.t_ns, next_ns));
        for (; first_ns_ + sent_ * period_ns <= clock_.t_ns; ++sent_) {
            edges.push_back({first_ns_ + sent_ * period_ns, 0});
        }
        return edges;
    }

    std::int64_t debounce_ns = 10 * US, period_ns = 10 * MS;
    int glitches = 0, exposures = 0;

private:
    bool runs() const { return first_ns_ > 0; }

    FakeClock &clock_;
    bool start_ = false, strobe_ = false;
    std::int64_t rise_ns_ = 0, first_ns_ = 0, sent_ = 0;
};

static RunOptions options(std::int64_t count, std::int64_t period_ns, std::int64_t width_ns)
{
    RunOptions made;
    made.plan.count = count;
    made.plan.period_ns = period_ns;
    made.plan.width_ns = width_ns;
    made.listens = true;
    return made;
}

static bool go_on(void)
{
    return false;
}

static void test_pulses_stand_a_period_apart(void)
{
    const Plan plan = plan_make(options(3, 50 * MS, 2 * MS).plan);
    TEST_ASSERT_EQUAL(6, plan.changes.size());
    for (std::size_t i = 0; i < 6; ++i) {
        const std::int64_t wanted = plan.changes[0].t_ns + 50 * MS * (std::int64_t(i) / 2) +
                                    (i % 2 ? 2 * MS : 0);
        TEST_ASSERT_TRUE(plan.changes[i].t_ns == wanted && plan.changes[i].active == (i % 2 == 0));
    }
    TEST_ASSERT_TRUE(plan.end_ns == plan.changes[0].t_ns + 150 * MS);
}

static void test_glitches_take_turns_half_a_period_before_each_start(void)
{
    PlanOptions with = options(3, 50 * MS, 2 * MS).plan;
    with.glitch_ns = {3 * US, 7 * US};
    const Plan plan = plan_make(with);
    TEST_ASSERT_EQUAL(12, plan.changes.size());
    for (std::size_t i = 0; i < 3; ++i) {
        const Change *const c = &plan.changes[4 * i];
        TEST_ASSERT_TRUE(c[0].glitch && c[1].glitch && !c[2].glitch && !c[3].glitch);
        TEST_ASSERT_TRUE(c[2].t_ns - c[0].t_ns == 25 * MS);
        TEST_ASSERT_TRUE(c[1].t_ns - c[0].t_ns == (i % 2 ? 7 * US : 3 * US));
    }
}

static void test_signals_that_would_overlap_are_refused(void)
{
    TEST_ASSERT_EQUAL_STRING("", plan_check(options(1, 5 * MS, 4 * MS).plan).c_str());
    TEST_ASSERT_NOT_EQUAL(0, plan_check(options(0, 5 * MS, 4 * MS).plan).size());
    TEST_ASSERT_NOT_EQUAL(0, plan_check(options(1, 5 * MS, 5 * MS).plan).size());
    TEST_ASSERT_NOT_EQUAL(0, plan_check(options(1, 5 * MS, 0).plan).size());
    TEST_ASSERT_NOT_EQUAL(0, plan_check(options(1, -5 * MS, 1 * MS).plan).size());
    PlanOptions with = options(1, 6 * MS, 3 * MS).plan;
    with.glitch_ns = {1 * MS};
    TEST_ASSERT_NOT_EQUAL(0, plan_check(with).size());
    with.width_ns = 2 * MS;
    TEST_ASSERT_EQUAL_STRING("", plan_check(with).c_str());
    with.glitch_ns.push_back(3 * MS);
    TEST_ASSERT_NOT_EQUAL(0, plan_check(with).size());
}

static void test_chips_are_found_by_name_number_and_path(void)
{
    TEST_ASSERT_EQUAL_STRING("/dev/gpiochip0", chip_path("gpiochip0").c_str());
    TEST_ASSERT_EQUAL_STRING("/dev/gpiochip12", chip_path("12").c_str());
    TEST_ASSERT_EQUAL_STRING("/dev/my-chip", chip_path("/dev/my-chip").c_str());
}

static void test_a_run_measures_the_box_exactly(void)
{
    FakeClock clock;
    FakeBox box(clock);

    const Run done = run(options(1, 1000 * MS, 1 * MS), box, clock, go_on);
    const EdgeReport report = report_edges(done, {});

    /* The box answers at the end of START here, and then each 10 ms to the end of the second. */
    TEST_ASSERT_EQUAL(100, report.edges);
    TEST_ASSERT_EQUAL(99, report.period_us.count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10000, report.period_us.mean);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, report.jitter_us);
    TEST_ASSERT_EQUAL(0, report.missed + report.extra);
    TEST_ASSERT_EQUAL(1, report.start_to_edge_us.count);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 10.032, report.first_edge_delay_us);
    TEST_ASSERT_FALSE(judge(report, {10000, 0.001}).lost);
    TEST_ASSERT_EQUAL(0, judge(report, {10000, 0.001}).failures.size());
}

static void test_a_box_with_enough_debounce_starts_only_at_start(void)
{
    for (const std::int64_t debounce_ns : {10 * US, 1 * US}) {
        FakeClock clock;
        FakeBox box(clock);
        box.debounce_ns = debounce_ns;
        RunOptions with = options(1, 100 * MS, 1 * MS);
        with.plan.glitch_ns = {5 * US};

        const Run done = run(with, box, clock, go_on);
        const EdgeReport report = report_edges(done, {});

        const bool rejects = debounce_ns > 5 * US;
        TEST_ASSERT_EQUAL(rejects, box.glitches);
        TEST_ASSERT_EQUAL(rejects ? 0 : 5, report.before_start);
        TEST_ASSERT_EQUAL(1, done.glitches);
    }
}

static void test_each_trig_is_answered_with_one_exposure_until_the_end(void)
{
    FakeClock clock;
    FakeBox box(clock);
    RunOptions with = options(1, 200 * MS, 1 * MS);
    with.strobe = {true, 1 * MS, 3 * MS};
    const Run done = run(with, box, clock, go_on);
    TEST_ASSERT_EQUAL(20, done.edges.size());
    TEST_ASSERT_EQUAL(20, box.exposures);
    for (std::size_t i = 0; i < done.strobes.size(); ++i) {
        TEST_ASSERT_TRUE(done.strobes[i].planned_ns == done.edges[i].t_ns + 1 * MS);
    }
}

static void test_lateness_is_what_the_system_took_to_wake_us(void)
{
    FakeClock clock;
    clock.wake_up_ns = 80 * US;
    FakeBox box(clock);
    const Run done = run(options(5, 100 * MS, 1 * MS), box, clock, go_on);
    TEST_ASSERT_EQUAL(5, done.starts.size());
    for (const Sent &sent : done.starts) {
        TEST_ASSERT_INT64_WITHIN(1 * US, 80 * US, sent.late_ns());
    }
}

static void test_a_run_can_be_stopped_between_pulses(void)
{
    FakeClock clock;
    FakeBox box(clock);
    const std::int64_t began_ns = clock.t_ns;
    const Run done = run(options(100, 1000 * MS, 1 * MS), box, clock,
                         [&] { return clock.t_ns > began_ns + 3500 * MS; });
    TEST_ASSERT_TRUE(done.stopped);
    TEST_ASSERT_EQUAL(4, done.starts.size());
    TEST_ASSERT_TRUE(done.end_ns < began_ns + 3700 * MS);
    TEST_ASSERT_EQUAL(0, report_edges(done, {}).missed);
}

/** A run whose first START was at 1 s, with edges at these times in us after it. */
static Run run_of(const std::vector<double> &edges_us, double end_us)
{
    Run run;
    run.begin_ns = 900 * MS;
    run.starts.push_back({1000 * MS, 1000 * MS, 1000 * MS + 500});
    run.end_ns = 1000 * MS + static_cast<std::int64_t>(end_us * 1e3);
    for (const double t_us : edges_us) {
        run.edges.push_back({1000 * MS + std::llround(t_us * 1e3), 0});
    }
    return run;
}

static void test_missing_pulses_are_counted_wherever_they_are(void)
{
    const Limits known = {100, 0};
    /* One in the middle, two in a row, none at the end. */
    TEST_ASSERT_EQUAL(3, report_edges(run_of({1, 101, 301, 401, 701}, 799), known).missed);
    TEST_ASSERT_EQUAL(2, report_edges(run_of({1, 101, 201}, 420), known).missed);
    /* All of them: at 0, 100, 200 and 300. */
    TEST_ASSERT_EQUAL(4, report_edges(run_of({}, 350), known).missed);
    TEST_ASSERT_TRUE(judge(report_edges(run_of({}, 350), {}), {}).lost);
    /* Without a known period the median stands for it. */
    TEST_ASSERT_EQUAL(1, report_edges(run_of({1, 101, 201, 401, 501}, 550), {}).missed);
}

static void test_bounces_are_extra_edges_and_fail_a_known_period(void)
{
    const Limits known = {100, 0};
    const EdgeReport report = report_edges(run_of({1, 101, 105, 201, 301}, 350), known);
    TEST_ASSERT_EQUAL(1, report.extra);
    TEST_ASSERT_EQUAL(0, report.missed);
    TEST_ASSERT_EQUAL(1, judge(report, known).failures.size());
}

static void test_edges_before_start_are_the_preamble_and_not_measured(void)
{
    const EdgeReport report =
        report_edges(run_of({-900, -700, -650, 1, 101, 201}, 250), {100, 0.01});
    TEST_ASSERT_EQUAL(3, report.before_start);
    TEST_ASSERT_EQUAL(2, report.period_us.count);
    TEST_ASSERT_EQUAL(0, judge(report, {100, 0.01}).failures.size());
}

static void test_period_and_jitter_of_noisy_stamps_are_those_of_the_noise(void)
{
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 5);
    std::vector<double> edges_us;
    for (int i = 0; i < 5000; ++i) {
        edges_us.push_back(100 + 1000.05 * i + noise(random));
    }
    const EdgeReport report = report_edges(run_of(edges_us, 5000 * 1000.05), {});
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1000.05, report.period_us.mean);
    /* Two stamps an interval; the error of a deviation of n values is about sd / sqrt(2 n). */
    TEST_ASSERT_DOUBLE_WITHIN(0.4, 5 * std::sqrt(2.0), report.period_us.sd);
    TEST_ASSERT_TRUE(report.jitter_us > 3 * report.period_us.sd);
    TEST_ASSERT_EQUAL(1, judge(report, {0, report.jitter_us - 0.1}).failures.size());
    TEST_ASSERT_EQUAL(0, judge(report, {0, report.jitter_us + 0.1}).failures.size());
}

static void test_a_wrong_period_fails_and_crystals_may_differ(void)
{
    std::vector<double> edges_us;
    for (int i = 0; i < 1000; ++i) {
        edges_us.push_back(1000.1 * i);
    }
    const Run run = run_of(edges_us, 1000 * 1000.1);
    TEST_ASSERT_EQUAL(0, judge(report_edges(run, {1000, 0}), {1000, 0}).failures.size());
    TEST_ASSERT_EQUAL(1, judge(report_edges(run, {1000.5, 0}), {1000.5, 0}).failures.size());
}

static void test_stamps_of_another_clock_give_periods_but_no_delays(void)
{
    Run run = run_of({1, 101, 201, 301}, 350);
    for (gpio_edge_t &edge : run.edges) {
        edge.t_ns += 1700000000LL * 1000000000; /* the wall clock */
    }
    const EdgeReport report = report_edges(run, {});
    TEST_ASSERT_FALSE(report.same_clock);
    TEST_ASSERT_EQUAL(0, report.start_to_edge_us.count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100, report.period_us.mean);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pulses_stand_a_period_apart);
    RUN_TEST(test_glitches_take_turns_half_a_period_before_each_start);
    RUN_TEST(test_signals_that_would_overlap_are_refused);
    RUN_TEST(test_chips_are_found_by_name_number_and_path);
    RUN_TEST(test_a_run_measures_the_box_exactly);
    RUN_TEST(test_a_box_with_enough_debounce_starts_only_at_start);
    RUN_TEST(test_each_trig_is_answered_with_one_exposure_until_the_end);
    RUN_TEST(test_lateness_is_what_the_system_took_to_wake_us);
    RUN_TEST(test_a_run_can_be_stopped_between_pulses);
    RUN_TEST(test_missing_pulses_are_counted_wherever_they_are);
    RUN_TEST(test_bounces_are_extra_edges_and_fail_a_known_period);
    RUN_TEST(test_edges_before_start_are_the_preamble_and_not_measured);
    RUN_TEST(test_period_and_jitter_of_noisy_stamps_are_those_of_the_noise);
    RUN_TEST(test_a_wrong_period_fails_and_crystals_may_differ);
    RUN_TEST(test_stamps_of_another_clock_give_periods_but_no_delays);
    return UNITY_END();
}
