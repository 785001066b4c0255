/* SPDX-License-Identifier: Apache-2.0 */
/* hidapi itself, unmodified, between opms::hid and a mocked device. Linked once with the hidraw
 * back end and once with libusb's. */
#include <string.h>

#include <unity.h>

#include <opms/hid.h>

#include "mock_box.h"
#include "mock_device.h"

enum { BOOT = 0x1001, SESSION = 77, PULSES = 20, PATIENCE = 400 }; /* of 50 ms, where it fails */

static opms_error_t err;

void setUp(void)
{
    TEST_ASSERT_TRUE(mock_device_plug(BOOT));
}

void tearDown(void)
{
    mock_device_unplug();
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, mock_device_faults(), "the mock saw bytes it cannot read");
}

static opms_box_t *open_box(void)
{
    opms_box_options_t options;
    opms_box_options_init(&options);
    options.open_timeout_ms = 20000;
    strcpy(options.unique_id, MOCK_SERIAL);
    opms_box_t *box = NULL;
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_box_open(&options, &box, &err), err.message);
    return box;
}

/** Take items until one of that kind comes. */
static opms_box_item_t wait_item(opms_box_t *box, opms_item_kind_t kind)
{
    opms_box_item_t item = {0};
    for (int i = 0; i < PATIENCE && item.kind != kind; ++i) {
        TEST_ASSERT_EQUAL(OPMS_OK, opms_box_poll(box, 50, &item, &err));
    }
    TEST_ASSERT_EQUAL(kind, item.kind);
    return item;
}

static void wait_link(opms_box_t *box, opms_link_change_t change)
{
    while (wait_item(box, OPMS_ITEM_LINK).as.link.change != change) {
    }
}

static void a_box_is_listed_with_id_and_place(void)
{
    opms_box_entry_t entries[4];
    uint32_t count = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_list(entries, 4, &count, &err));
    TEST_ASSERT_EQUAL_UINT32(1, count);
    TEST_ASSERT_EQUAL_STRING(MOCK_SERIAL, entries[0].unique_id);
    TEST_ASSERT_EQUAL_STRING(mock_device_path(), entries[0].path);
    TEST_ASSERT_TRUE(entries[0].accessible);
}

static void another_id_is_refused_and_the_one_there_is_is_named(void)
{
    opms_box_options_t options;
    opms_box_options_init(&options);
    strcpy(options.unique_id, "0011223344556677");
    opms_box_t *box = NULL;
    TEST_ASSERT_EQUAL(OPMS_ERR_DEVICE, opms_box_open(&options, &box, &err));
    TEST_ASSERT_NOT_NULL(strstr(err.message, MOCK_SERIAL));
}

static void every_kind_of_transfer_gets_through(void)
{
    opms_box_t *const box = open_box();
    opms_identity_report_t identity;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_get_identity(box, &identity, NULL, &err));
    TEST_ASSERT_EQUAL_STRING("0123456789abcdef0123", identity.git_hash);
    uint32_t ping_id = 0;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_ping(box, 20000, &ping_id, &err));
    const opms_box_item_t pong = wait_item(box, OPMS_ITEM_PONG);
    TEST_ASSERT_EQUAL_UINT32(ping_id, pong.as.pong.report.ping_id);
    TEST_ASSERT_TRUE(pong.as.pong.t_sent_host_ns > 0);
    TEST_ASSERT_TRUE(pong.t_host_ns >= pong.as.pong.t_sent_host_ns);
    opms_settings_report_t settings;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_get_settings(box, 20000, &settings, &err));
    settings.settings.period_us = 50000;
    TEST_ASSERT_EQUAL_MESSAGE(
        OPMS_OK, opms_box_set_settings(box, &settings.settings, 20000, &settings, &err),
        err.message);
    TEST_ASSERT_EQUAL_UINT32(50000, settings.settings.period_us);
    opms_box_close(box);
}

static void lost_pulses_are_fetched_from_history(void)
{
    opms_box_t *const box = open_box();
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_box_arm(box, SESSION, 20000, &err), err.message);
    uint32_t seen[PULSES + 1] = {0}, count = 0;
    for (int i = 0; i < PATIENCE && count < PULSES; ++i) {
        opms_box_item_t item;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_box_poll(box, 50, &item, &err));
        TEST_ASSERT_NOT_EQUAL_MESSAGE(OPMS_ITEM_MALFORMED, item.kind, "a report was torn");
        if (item.kind == OPMS_ITEM_TRIGGER) {
            ++seen[item.as.trigger.trigger_number];
            ++count;
        } else if (item.kind == OPMS_ITEM_HISTORY) {
            TEST_ASSERT_EQUAL_UINT64(item.as.history.entry.number * UINT64_C(100000),
                                     item.as.history.entry.time.us);
            ++seen[item.as.history.entry.number];
            ++count;
        }
    }
    for (uint32_t number = 1; number <= PULSES; ++number) {
        TEST_ASSERT_EQUAL_UINT32(1, seen[number]);
    }
    opms_box_counters_t counters;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_box_get_counters(box, &counters, &err));
    TEST_ASSERT_EQUAL_UINT64(3, counters.triggers_filled);
    TEST_ASSERT_EQUAL_UINT64(3, counters.reports_lost);
    opms_box_close(box);
}

static void a_replug_is_followed_and_a_new_boot_is_told(void)
{
    if (!mock_device_replugs) {
        TEST_IGNORE_MESSAGE("this mock cannot");
    }
    opms_box_t *const box = open_box();
    wait_link(box, OPMS_LINK_CONNECTED);
    mock_device_unplug();
    wait_link(box, OPMS_LINK_DISCONNECTED);
    TEST_ASSERT_EQUAL(OPMS_ERR_DEVICE, opms_box_ping(box, 0, NULL, &err));
    TEST_ASSERT_TRUE(mock_device_plug(BOOT + 1));
    wait_link(box, OPMS_LINK_CONNECTED);
    wait_link(box, OPMS_LINK_REBOOTED);
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_box_ping(box, 20000, NULL, &err), err.message);
    wait_item(box, OPMS_ITEM_PONG);
    opms_box_close(box);
}

static void a_box_opens_again_after_it_was_closed(void)
{
    for (int i = 0; i < 3; ++i) {
        opms_box_close(open_box());
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_box_is_listed_with_id_and_place);
    RUN_TEST(another_id_is_refused_and_the_one_there_is_is_named);
    RUN_TEST(every_kind_of_transfer_gets_through);
    RUN_TEST(lost_pulses_are_fetched_from_history);
    RUN_TEST(a_replug_is_followed_and_a_new_boot_is_told);
    RUN_TEST(a_box_opens_again_after_it_was_closed);
    return UNITY_END();
}
