/* SPDX-License-Identifier: Apache-2.0 */
/* What the host may ask, when it is refused, and what it is told. */
#include <string.h>

#include <unity.h>

#include "firmware_bench.h"

void setUp(void)
{
    bench_power_on(NULL);
    bench_drain();
}

void tearDown(void)
{
}

static void reseal(uint8_t *bytes)
{
    const uint16_t crc = opms_wire_crc16(bytes, OPMS_WIRE_SIZE - 2);
    bytes[OPMS_WIRE_SIZE - 2] = (uint8_t)crc;
    bytes[OPMS_WIRE_SIZE - 1] = (uint8_t)(crc >> 8);
}

typedef void (*sender_t)(const uint8_t *bytes, size_t size);

static void send_command(const uint8_t *bytes, size_t size)
{
    box_command(&box, bytes, size, now);
}

static void send_feature(const uint8_t *bytes, size_t size)
{
    box_set_feature(&box, bytes, size, now);
}

static void check_refused(sender_t send, const uint8_t *bytes, size_t size, uint32_t argument,
                          opms_refusal_t refusal)
{
    const uint32_t before = box.commands_refused;
    bench_drain();

    send(bytes, size);

    bench_drain();
    TEST_ASSERT_EQUAL(1, reports.event_count);
    TEST_ASSERT_EQUAL_STRING(opms_refusal_name(refusal),
                             opms_refusal_name((opms_refusal_t)reports.events[0].detail));
    TEST_ASSERT_EQUAL(OPMS_EVENT_REFUSED, reports.events[0].kind);
    TEST_ASSERT_EQUAL_HEX32(argument, reports.events[0].argument);
    TEST_ASSERT_EQUAL(before + 1, box.commands_refused);
    TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
    TEST_ASSERT_EQUAL(OPMS_BOX_IDLE, box_state(&box));
}

/* Each way in which the bytes of a request can be wrong. */
static void check_faults(sender_t send, const uint8_t *good, uint32_t argument,
                         opms_refusal_t bad_value)
{
    uint8_t bytes[2 * OPMS_WIRE_SIZE] = {0};
    memcpy(bytes, good, OPMS_WIRE_SIZE);
    check_refused(send, bytes, OPMS_WIRE_SIZE - 1, argument, OPMS_REFUSAL_LENGTH);
    check_refused(send, bytes, OPMS_WIRE_SIZE + 1, argument, OPMS_REFUSAL_LENGTH);
    bytes[40] ^= 1;
    check_refused(send, bytes, OPMS_WIRE_SIZE, argument, OPMS_REFUSAL_CRC);
    reseal(bytes);
    check_refused(send, bytes, OPMS_WIRE_SIZE, argument, bad_value);
    bytes[40] ^= 1;
    bytes[1]++;
    reseal(bytes);
    check_refused(send, bytes, OPMS_WIRE_SIZE, argument, OPMS_REFUSAL_VERSION);
}

static void test_faulty_requests_are_refused_by_their_fault(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    const opms_command_report_t command = {OPMS_COMMAND_ARM, SESSION};
    opms_wire_write_command(&command, bytes);
    check_faults(send_command, bytes, OPMS_REPORT_COMMAND, OPMS_REFUSAL_VALUE);
    opms_wire_write_settings_set(box_settings(&box), bytes);
    check_faults(send_feature, bytes, OPMS_REPORT_SETTINGS, OPMS_REFUSAL_VALUE);
    const opms_history_request_t request = {1, SESSION, 1, 1};
    opms_wire_write_history_request(&request, bytes);
    check_faults(send_feature, bytes, OPMS_REPORT_HISTORY, OPMS_REFUSAL_VALUE);
    opms_wire_write_bootloader(bytes);
    check_faults(send_feature, bytes, OPMS_REPORT_BOOTLOADER, OPMS_REFUSAL_MAGIC);
}

static void test_reports_that_are_no_requests_are_refused_by_id(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE] = {OPMS_REPORT_TRIGGER, OPMS_WIRE_PROTOCOL};
    reseal(bytes);
    check_refused(send_command, bytes, sizeof bytes, OPMS_REPORT_COMMAND, OPMS_REFUSAL_ID);
    check_refused(send_feature, bytes, sizeof bytes, OPMS_REPORT_TRIGGER, OPMS_REFUSAL_ID);
    bytes[0] = OPMS_REPORT_IDENTITY;
    reseal(bytes);
    check_refused(send_feature, bytes, sizeof bytes, OPMS_REPORT_IDENTITY, OPMS_REFUSAL_ID);
    check_refused(send_feature, bytes, 0, 0, OPMS_REFUSAL_ID);
    check_refused(send_feature, NULL, 0, 0, OPMS_REFUSAL_ID);
    check_refused(send_command, NULL, 0, OPMS_REPORT_COMMAND, OPMS_REFUSAL_LENGTH);
}

static void test_commands_out_of_range_are_refused(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    const opms_command_report_t bad[] = {
        {OPMS_COMMAND_ARM, 0}, {OPMS_COMMAND_DISARM, 1}, {(opms_command_opcode_t)4, 0}};
    for (unsigned i = 0; i < 3; i++) {
        opms_wire_write_command(&bad[i], bytes);
        check_refused(send_command, bytes, sizeof bytes, OPMS_REPORT_COMMAND, OPMS_REFUSAL_VALUE);
    }
}

static void test_a_refused_command_tells_its_opcode(void)
{
    bench_bring_to(OPMS_BOX_RUNNING);
    bench_command(OPMS_COMMAND_ARM, SESSION);
    bench_drain();
    TEST_ASSERT_EQUAL_HEX32(OPMS_REPORT_COMMAND + 256 * OPMS_COMMAND_ARM,
                            bench_the_event(OPMS_EVENT_REFUSED)->argument);
}

static void test_ping_is_answered_with_the_times_of_both_ends(void)
{
    bench_command(OPMS_COMMAND_PING, 0xABCD1234);
    const box_cycles_t received = now;
    bench_pass(US(731) + 5);
    bench_drain();

    TEST_ASSERT_EQUAL(1, reports.pong_count);
    const opms_pong_report_t *pong = &reports.pongs[0];
    TEST_ASSERT_EQUAL_HEX32(0xABCD1234, pong->ping_id);
    TEST_ASSERT_EQUAL_HEX32(BOOT, pong->boot_id);
    TEST_ASSERT_EQUAL_INT64((int64_t)received * 8, opms_box_time_ns(pong->received));
    TEST_ASSERT_EQUAL_INT64((int64_t)now * 8, opms_box_time_ns(pong->sent));
}

static void test_pings_wait_in_order_and_too_many_are_refused(void)
{
    for (uint32_t i = 0; i < BOX_PONGS + 1; i++) {
        bench_command(OPMS_COMMAND_PING, 100 + i);
    }
    bench_drain();

    TEST_ASSERT_EQUAL(BOX_PONGS, reports.pong_count);
    for (uint32_t i = 0; i < BOX_PONGS; i++) {
        TEST_ASSERT_EQUAL(100 + i, reports.pongs[i].ping_id);
    }
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_BUSY, bench_the_event(OPMS_EVENT_REFUSED)->detail);
    TEST_ASSERT_EQUAL_HEX32(OPMS_REPORT_COMMAND + 256 * OPMS_COMMAND_PING,
                            bench_the_event(OPMS_EVENT_REFUSED)->argument);
    bench_command(OPMS_COMMAND_PING, 9);
    bench_drain();
    TEST_ASSERT_EQUAL(9, reports.pongs[0].ping_id);
}

static void test_identity_is_told_as_it_was_given(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE];
    opms_identity_report_t identity;
    TEST_ASSERT_TRUE(box_get_feature(&box, OPMS_REPORT_IDENTITY, bytes));
    TEST_ASSERT_EQUAL(OPMS_WIRE_OK, opms_wire_read_identity(bytes, sizeof bytes, &identity));
    TEST_ASSERT_EQUAL_STRING("0123456789abcdef0123", identity.git_hash);
    TEST_ASSERT_EQUAL_HEX32(BOOT, identity.boot_id);
    TEST_ASSERT_EQUAL(8, identity.unique_id[7]);
}

static void test_what_cannot_be_read_is_stalled(void)
{
    for (unsigned id = 0; id < 256; id++) {
        uint8_t bytes[OPMS_WIRE_SIZE];
        const bool readable =
            id == OPMS_REPORT_IDENTITY || id == OPMS_REPORT_SETTINGS || id == OPMS_REPORT_HISTORY;
        TEST_ASSERT_EQUAL(readable, box_get_feature(&box, (uint8_t)id, bytes));
    }
}

static opms_settings_t other_settings(void)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.period_us = 20000;
    settings.trig_active_low = true;
    settings.sync = OPMS_SYNC_RUN;
    return settings;
}

static void test_settings_come_into_force_when_the_flash_has_them(void)
{
    const opms_settings_t settings = other_settings();
    TEST_ASSERT_FALSE(bench_get_settings().stored);

    bench_set_settings(&settings);

    TEST_ASSERT_TRUE(bench_get_settings().pending);
    TEST_ASSERT_EQUAL(100000, bench_get_settings().settings.period_us);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_STORE_SETTINGS, box_take_actions(&box));
    TEST_ASSERT_EQUAL(20000, box_settings_to_store(&box)->period_us);

    box_stored(&box, true, now);

    const opms_settings_report_t after = bench_get_settings();
    TEST_ASSERT_FALSE(after.pending);
    TEST_ASSERT_TRUE(after.stored);
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_NONE, after.last_set);
    TEST_ASSERT_EQUAL(20000, after.settings.period_us);
    TEST_ASSERT_TRUE(after.settings.trig_active_low);
    TEST_ASSERT_EQUAL(OPMS_SYNC_RUN, after.settings.sync);
    bench_pass(BOX_CYCLES_PER_S);
    bench_drain();
    TEST_ASSERT_EQUAL_HEX16(after.settings_crc,
                            bench_the_event(OPMS_EVENT_SETTINGS_STORED)->argument);
    TEST_ASSERT_EQUAL_HEX16(after.settings_crc, reports.statuses[0].settings_crc);
}

static void test_settings_that_the_flash_did_not_keep_change_nothing(void)
{
    const opms_settings_t settings = other_settings();
    bench_set_settings(&settings);
    box_take_actions(&box);
    box_stored(&box, false, now);

    const opms_settings_report_t after = bench_get_settings();
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_FLASH, after.last_set);
    TEST_ASSERT_FALSE(after.pending);
    TEST_ASSERT_FALSE(after.stored);
    TEST_ASSERT_EQUAL(100000, after.settings.period_us);
    bench_drain();
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_FLASH, bench_the_event(OPMS_EVENT_REFUSED)->detail);
    TEST_ASSERT_EQUAL(OPMS_REPORT_SETTINGS, bench_the_event(OPMS_EVENT_REFUSED)->argument);
}

static void test_a_refused_set_stands_in_last_set_until_the_next(void)
{
    const opms_settings_t settings = other_settings();
    opms_settings_t wrong = settings;
    wrong.period_us = 1;
    bench_set_settings(&wrong);
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_VALUE, bench_get_settings().last_set);
    bench_set_settings(&settings);
    box_take_actions(&box);
    box_stored(&box, true, now);
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_NONE, bench_get_settings().last_set);
    bench_bring_to(OPMS_BOX_ARMED);
    bench_set_settings(&settings);
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_STATE, bench_get_settings().last_set);
}

static void test_while_settings_are_written_all_that_needs_idle_is_busy(void)
{
    const opms_settings_t settings = other_settings();
    opms_settings_t third = settings;
    third.period_us = 30000;
    bench_set_settings(&settings);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_STORE_SETTINGS, box_take_actions(&box));

    bench_set_settings(&third);
    bench_command(OPMS_COMMAND_ARM, SESSION);
    bench_bootloader();
    bench_drain();

    TEST_ASSERT_EQUAL(3, reports.event_count);
    for (uint32_t i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(OPMS_EVENT_REFUSED, reports.events[i].kind);
        TEST_ASSERT_EQUAL(OPMS_REFUSAL_BUSY, reports.events[i].detail);
    }
    TEST_ASSERT_EQUAL_HEX32(0, box_take_actions(&box));
    TEST_ASSERT_EQUAL(20000, box_settings_to_store(&box)->period_us);
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_NONE, bench_get_settings().last_set);
    box_stored(&box, true, now);
    TEST_ASSERT_EQUAL(20000, box_settings(&box)->period_us);
    bench_bring_to(OPMS_BOX_ARMED);
}

static void test_an_answer_of_the_flash_that_no_one_asked_for_is_ignored(void)
{
    box_stored(&box, true, now);
    box_stored(&box, false, now);
    bench_drain();
    TEST_ASSERT_EQUAL(0, reports.event_count);
    TEST_ASSERT_FALSE(bench_get_settings().stored);
    TEST_ASSERT_EQUAL(100000, box_settings(&box)->period_us);
}

static void test_settings_of_the_flash_are_in_force_from_power_on(void)
{
    const opms_settings_t settings = other_settings();
    bench_power_on(&settings);
    TEST_ASSERT_TRUE(bench_get_settings().stored);
    TEST_ASSERT_EQUAL(20000, bench_get_settings().settings.period_us);
}

static void test_arming_is_refused_on_the_way_to_the_bootloader(void)
{
    bench_bootloader();
    bench_command(OPMS_COMMAND_ARM, SESSION);
    bench_drain();
    TEST_ASSERT_EQUAL(OPMS_REFUSAL_BUSY, bench_the_event(OPMS_EVENT_REFUSED)->detail);
    TEST_ASSERT_EQUAL_HEX32(BOX_DO_BOOTLOADER, box_take_actions(&box));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_faulty_requests_are_refused_by_their_fault);
    RUN_TEST(test_reports_that_are_no_requests_are_refused_by_id);
    RUN_TEST(test_commands_out_of_range_are_refused);
    RUN_TEST(test_a_refused_command_tells_its_opcode);
    RUN_TEST(test_ping_is_answered_with_the_times_of_both_ends);
    RUN_TEST(test_pings_wait_in_order_and_too_many_are_refused);
    RUN_TEST(test_identity_is_told_as_it_was_given);
    RUN_TEST(test_what_cannot_be_read_is_stalled);
    RUN_TEST(test_settings_come_into_force_when_the_flash_has_them);
    RUN_TEST(test_settings_that_the_flash_did_not_keep_change_nothing);
    RUN_TEST(test_a_refused_set_stands_in_last_set_until_the_next);
    RUN_TEST(test_while_settings_are_written_all_that_needs_idle_is_busy);
    RUN_TEST(test_an_answer_of_the_flash_that_no_one_asked_for_is_ignored);
    RUN_TEST(test_settings_of_the_flash_are_in_force_from_power_on);
    RUN_TEST(test_arming_is_refused_on_the_way_to_the_bootloader);
    return UNITY_END();
}
