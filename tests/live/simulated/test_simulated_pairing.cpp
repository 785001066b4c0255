/* SPDX-License-Identifier: Apache-2.0 */
/* The pairer over the simulated world: never a wrong pair, whatever goes wrong. */
#include <cstdio>
#include <string>
#include <vector>

#include <unity.h>

#include "world_scene.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

static constexpr std::int64_t MICROSECONDS = 1000;

static void test_without_faults_all_is_paired_at_its_true_time(void)
{
    PairedScene paired(scene_options("seed=5"));
    paired.session(11, 60);
    paired.session(12, 60);
    const std::size_t triggers = paired.scene().world().true_triggers().size();
    TEST_ASSERT_GREATER_THAN(1200, triggers);
    TEST_ASSERT_EQUAL(triggers, paired.paired);
    TEST_ASSERT_EQUAL(0, paired.wrong);
    TEST_ASSERT_TRUE(paired.worst_time_ns < MICROSECONDS);
    TEST_ASSERT_TRUE(paired.summary().sums_hold);
}

/** A world with this text: nothing is paired wrongly, and `share` of its triggers are paired. */
static void check(const char *text, double share)
{
    PairedScene paired(scene_options(text));
    paired.session(21, 120);
    paired.session(22, 60);
    const auto triggers =
        static_cast<double>(paired.scene().world().true_triggers().size());
    char message[160];
    std::snprintf(message, sizeof message, "%s: %llu of %.0f paired, %llu wrong", text,
                  static_cast<unsigned long long>(paired.paired), triggers,
                  static_cast<unsigned long long>(paired.wrong));
    TEST_ASSERT_EQUAL_MESSAGE(0, paired.wrong, message);
    TEST_ASSERT_TRUE_MESSAGE(static_cast<double>(paired.paired) >= share * triggers, message);
    TEST_ASSERT_TRUE_MESSAGE(paired.worst_time_ns < 20 * MICROSECONDS, message);
    TEST_ASSERT_TRUE_MESSAGE(paired.summary().sums_hold, message);
    TEST_ASSERT_EQUAL_MESSAGE(paired.scene().frames.size(), paired.frame_results, message);
}

static void test_no_single_fault_makes_a_wrong_pair(void)
{
    for (std::size_t i = 0; i < FAULT_KINDS; ++i) {
        char text[80];
        std::snprintf(text, sizeof text, "seed=%d,%s=0.02", static_cast<int>(i) + 1,
                      fault_name(static_cast<Fault>(i)));
        check(text, 0.7);
    }
}

static void test_no_mishap_makes_a_wrong_pair(void)
{
    check("box_unplug=5+0.5/20+6/50+1", 0.9);
    check("camera_restart=5+0.5/20+3/50+1", 0.8);
    check("host_stall=5+0.02/20+0.4/50+2", 0.9);
    check("glitch=5/6/7.7", 0.99);
}

static void test_a_box_that_reboots_in_the_run_makes_no_wrong_pair(void)
{
    PairedScene paired(scene_options("box_reboot=30+1"));
    paired.session(21, 60);
    paired.session(22, 20);
    TEST_ASSERT_EQUAL(0, paired.wrong);
    TEST_ASSERT_GREATER_THAN(450, paired.paired);
}

static void test_many_faults_at_once_make_no_wrong_pair(void)
{
    for (int seed = 1; seed <= 12; ++seed) {
        char text[80];
        std::snprintf(text, sizeof text, "faults=%s,seed=%d%s", seed % 2 ? "some" : "many", seed,
                      seed % 3 ? "" : ",id_bits=64,first_id=4294967290");
        check(text, 0.05);
    }
}

static void test_without_strobe_or_without_camera_time_nothing_is_paired_wrongly(void)
{
    check("strobe=0,faults=some,seed=31", 0.3);
    check("camera_time=0,faults=some,seed=32", 0.3);
}

static void test_16_bit_ids_wrap_from_65535_to_1(void)
{
    PairedScene paired(scene_options("first_id=65400"));
    paired.session(4, 30);
    TEST_ASSERT_EQUAL(0, paired.wrong);
    TEST_ASSERT_EQUAL(paired.scene().world().true_triggers().size(), paired.paired);
    bool wrapped = false;
    for (std::size_t i = 1; i < paired.scene().frames.size(); ++i) {
        const std::uint64_t before = paired.scene().frames[i - 1].frame_id;
        const std::uint64_t id = paired.scene().frames[i].frame_id;
        TEST_ASSERT_EQUAL_UINT64(before == 65535 ? 1 : before + 1, id);
        wrapped = wrapped || before == 65535;
    }
    TEST_ASSERT_TRUE(wrapped);
}

/** All that an item says, as text. */
static std::string text_of(const opms_box_item_t &item)
{
    std::uint8_t bytes[OPMS_WIRE_SIZE] = {};
    std::uint64_t numbers[4] = {};
    switch (item.kind) {
    case OPMS_ITEM_TRIGGER: opms_wire_write_trigger(&item.as.trigger, bytes); break;
    case OPMS_ITEM_PONG:
        opms_wire_write_pong(&item.as.pong.report, bytes);
        numbers[0] = static_cast<std::uint64_t>(item.as.pong.t_sent_host_ns);
        break;
    case OPMS_ITEM_STATUS: opms_wire_write_status(&item.as.status, bytes); break;
    case OPMS_ITEM_EVENT: opms_wire_write_event(&item.as.event, bytes); break;
    case OPMS_ITEM_HISTORY:
        numbers[0] = item.as.history.entry.number;
        numbers[1] = static_cast<std::uint64_t>(opms_box_time_ns(item.as.history.entry.time));
        numbers[2] = item.as.history.entry.flags;
        break;
    case OPMS_ITEM_LINK:
        numbers[0] = item.as.link.change;
        numbers[1] = item.as.link.boot_id;
        break;
    case OPMS_ITEM_LOST:
        numbers[0] = item.as.lost.what;
        numbers[1] = item.as.lost.first;
        numbers[2] = item.as.lost.count;
        break;
    default: numbers[0] = item.as.malformed.result; break;
    }
    std::string text(reinterpret_cast<const char *>(bytes), sizeof bytes);
    for (const std::uint64_t number : numbers) {
        text += " " + std::to_string(number);
    }
    return std::to_string(item.kind) + " " + std::to_string(item.t_host_ns) + " " + text;
}

static std::string text_of(const std::vector<opms_box_item_t> &items)
{
    std::string text;
    for (const opms_box_item_t &item : items) {
        text += text_of(item) + "\n";
    }
    return text;
}

static void test_equal_seeds_give_equal_worlds_and_others_do_not(void)
{
    PairedScene a(scene_options("faults=many,seed=77")), b(scene_options("faults=many,seed=77"));
    PairedScene c(scene_options("faults=many,seed=78"));
    for (PairedScene *scene : {&a, &b, &c}) {
        scene->session(3, 100);
    }
    const std::string of_a = text_of(a.scene().items);
    TEST_ASSERT_TRUE(of_a == text_of(b.scene().items));
    TEST_ASSERT_FALSE(of_a == text_of(c.scene().items));
    TEST_ASSERT_EQUAL(a.scene().frames.size(), b.scene().frames.size());
    for (std::size_t i = 0; i < a.scene().frames.size(); ++i) {
        const Frame &one = a.scene().frames[i], &other = b.scene().frames[i];
        TEST_ASSERT_EQUAL_INT64(one.arrival_host_ns, other.arrival_host_ns);
        TEST_ASSERT_EQUAL_UINT64(one.camera_time_ticks, other.camera_time_ticks);
        TEST_ASSERT_EQUAL_UINT64(one.frame_id, other.frame_id);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_faults_all_is_paired_at_its_true_time);
    RUN_TEST(test_no_single_fault_makes_a_wrong_pair);
    RUN_TEST(test_no_mishap_makes_a_wrong_pair);
    RUN_TEST(test_a_box_that_reboots_in_the_run_makes_no_wrong_pair);
    RUN_TEST(test_many_faults_at_once_make_no_wrong_pair);
    RUN_TEST(test_without_strobe_or_without_camera_time_nothing_is_paired_wrongly);
    RUN_TEST(test_16_bit_ids_wrap_from_65535_to_1);
    RUN_TEST(test_equal_seeds_give_equal_worlds_and_others_do_not);
    return UNITY_END();
}
