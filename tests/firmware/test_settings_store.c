/* SPDX-License-Identifier: Apache-2.0 */
/* Settings in flash: a power cut at any byte, worn pages, damage of any kind. */
#include <string.h>

#include <unity.h>

#include "nor_flash.h"

static nor_flash_t flash;
static store_flash_t view;

enum { PAGES_PER_SECTOR = STORE_SECTOR_SIZE / STORE_PAGE_SIZE };

void setUp(void)
{
    nor_flash_blank(&flash);
    view = nor_flash_view(&flash);
}

void tearDown(void)
{
}

/* Settings that tell their number apart. */
static opms_settings_t numbered(uint32_t number)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.period_us = 200000 + number;
    settings.wait_timeout_s = (uint16_t)number;
    return settings;
}

static void save(uint32_t number)
{
    const opms_settings_t settings = numbered(number);
    TEST_ASSERT_TRUE(settings_store_save(&view, &settings));
}

/* The number of what is loaded, or UINT32_MAX. */
static uint32_t load(void)
{
    opms_settings_t settings = {0};
    if (!settings_store_load(&view, &settings)) {
        return UINT32_MAX;
    }
    TEST_ASSERT_NULL(opms_wire_check_settings(&settings));
    TEST_ASSERT_EQUAL(settings.wait_timeout_s, settings.period_us - 200000);
    return settings.wait_timeout_s;
}

static void test_blank_flash_holds_nothing_and_leaves_the_settings_alone(void)
{
    opms_settings_t settings = numbered(5);
    TEST_ASSERT_FALSE(settings_store_load(&view, &settings));
    TEST_ASSERT_EQUAL(200005, settings.period_us);
}

static void test_all_fields_come_back(void)
{
    const opms_settings_t settings = {
        .period_us = 9999999,
        .width_us = 12345,
        .debounce_cycles = 1250000,
        .trig_active_low = true,
        .strobe_enabled = true,
        .sync = OPMS_SYNC_1HZ,
        .preamble_gap_ms = {100, 200, 300, 400, 500, 600, 700, 9999},
        .wait_timeout_s = 65535,
    };
    opms_settings_t got;
    TEST_ASSERT_TRUE(settings_store_save(&view, &settings));
    TEST_ASSERT_TRUE(settings_store_load(&view, &got));
    TEST_ASSERT_EQUAL(9999999, got.period_us);
    TEST_ASSERT_EQUAL(12345, got.width_us);
    TEST_ASSERT_EQUAL(1250000, got.debounce_cycles);
    TEST_ASSERT_TRUE(got.trig_active_low && got.strobe_enabled);
    TEST_ASSERT_FALSE(got.start_falling_edge || got.strobe_active_low);
    TEST_ASSERT_EQUAL(OPMS_SYNC_1HZ, got.sync);
    TEST_ASSERT_EQUAL_UINT16_ARRAY(settings.preamble_gap_ms, got.preamble_gap_ms,
                                   OPMS_BOX_PREAMBLE_MAX);
    TEST_ASSERT_EQUAL(65535, got.wait_timeout_s);
}

static void test_the_newest_of_many_is_loaded(void)
{
    for (uint32_t number = 1; number <= 200; number++) {
        save(number);
        TEST_ASSERT_EQUAL(number, load());
    }
    TEST_ASSERT_EQUAL(0, flash.overwrites);
}

static void test_the_same_settings_again_write_nothing(void)
{
    save(3);
    const uint32_t work = flash.work;
    save(3);
    TEST_ASSERT_EQUAL(work, flash.work);
    TEST_ASSERT_EQUAL(3, load());
}

static void test_the_sectors_wear_alike(void)
{
    enum { SAVES = 3200 };
    for (uint32_t number = 1; number <= SAVES; number++) {
        save(number);
    }
    TEST_ASSERT_EQUAL(SAVES, flash.programs);
    TEST_ASSERT_EQUAL(0, flash.overwrites);
    TEST_ASSERT_UINT32_WITHIN(1, SAVES / PAGES_PER_SECTOR / STORE_SECTORS, flash.erases[0]);
    TEST_ASSERT_UINT32_WITHIN(1, flash.erases[0], flash.erases[1]);
}

/* Save number `saves + 1` with power for `bytes`; what holds after that, and can it go on? */
static void check_cut(const nor_flash_t *before, uint32_t saves, uint32_t bytes)
{
    flash = *before;
    flash.power_left = bytes;
    flash.random = bytes + 1;
    const opms_settings_t settings = numbered(saves + 1);

    settings_store_save(&view, &settings);

    flash.power_left = NOR_FLASH_STAYS_ON;
    const uint32_t old = saves == 0 ? UINT32_MAX : saves, got = load();
    TEST_ASSERT_TRUE_MESSAGE(got == old || got == saves + 1, "neither the old nor the new");
    save(saves + 2);
    TEST_ASSERT_EQUAL_MESSAGE(saves + 2, load(), "the next save after the cut");
    TEST_ASSERT_EQUAL_MESSAGE(0, flash.overwrites, "a page that was not blank");
}

static void test_a_power_cut_at_any_byte_leaves_the_old_or_the_new(void)
{
    static nor_flash_t before;
    for (uint32_t saves = 0; saves <= 2 * PAGES_PER_SECTOR + 1; saves++) {
        if (saves > 0) {
            flash = before;
            save(saves);
        }
        before = flash;
        save(saves + 1);
        const uint32_t work = flash.work - before.work;
        TEST_ASSERT_TRUE(work >= STORE_PAGE_SIZE);
        /* All bytes near the borders of the sectors; elsewhere some, to save time. */
        const uint32_t step = saves < 2 || saves == 15 || saves == 16 ? 1 : 17;
        for (uint32_t bytes = 0; bytes < work; bytes += step) {
            check_cut(&before, saves, bytes);
        }
        flash = before;
        flash.power_left = work + 1;
        save(saves + 1);
        flash.power_left = NOR_FLASH_STAYS_ON;
        TEST_ASSERT_EQUAL_MESSAGE(saves + 1, load(), "with power to the end it is the new");
        flash = before;
    }
}

static void test_cuts_one_after_another_never_lose_the_last_good_settings(void)
{
    uint32_t good = UINT32_MAX;
    uint64_t random = 7;
    for (uint32_t number = 1; number <= 2000; number++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        flash.power_left = (uint32_t)(random >> 33) % (STORE_SECTOR_SIZE + 2 * STORE_PAGE_SIZE);
        const opms_settings_t settings = numbered(number);
        settings_store_save(&view, &settings);
        flash.power_left = NOR_FLASH_STAYS_ON;
        const uint32_t got = load();
        TEST_ASSERT_TRUE(got == good || got == number);
        good = got;
    }
    TEST_ASSERT_NOT_EQUAL(UINT32_MAX, good);
}

static void test_any_damaged_bit_of_the_newest_falls_back_to_the_one_before(void)
{
    save(1);
    save(2);
    static nor_flash_t whole;
    whole = flash;
    uint32_t noticed = 0;
    for (uint32_t bit = 0; bit < 8 * STORE_PAGE_SIZE; bit++) {
        flash = whole;
        flash.bytes[STORE_PAGE_SIZE + bit / 8] ^= (uint8_t)(1U << bit % 8);
        const uint32_t got = load();
        TEST_ASSERT_TRUE(got == 1 || got == 2);
        noticed += got == 1;
        save(3);
        TEST_ASSERT_EQUAL(3, load());
        TEST_ASSERT_EQUAL(0, flash.overwrites);
    }
    /* The record is 76 bytes; the rest of its page is not read. */
    TEST_ASSERT_EQUAL(8 * 76, noticed);
}

static void test_with_every_record_damaged_there_is_none_and_saving_goes_on(void)
{
    for (uint32_t number = 1; number <= 40; number++) {
        save(number);
    }
    for (uint32_t at = 10; at < sizeof flash.bytes; at += STORE_PAGE_SIZE) {
        flash.bytes[at] ^= 0x20;
    }
    TEST_ASSERT_EQUAL(UINT32_MAX, load());
    save(50);
    TEST_ASSERT_EQUAL(50, load());
    save(51);
    TEST_ASSERT_EQUAL(51, load());
}

static void test_random_and_constant_flash_holds_nothing_and_can_be_used(void)
{
    uint64_t random = 3;
    for (unsigned trial = 0; trial < 300; trial++) {
        nor_flash_blank(&flash);
        for (uint32_t i = 0; i < sizeof flash.bytes; i++) {
            random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            flash.bytes[i] = trial < 3 ? (uint8_t)(trial * 0x55) : (uint8_t)(random >> 40);
        }
        TEST_ASSERT_EQUAL(UINT32_MAX, load());
        save(trial);
        TEST_ASSERT_EQUAL(trial, load());
    }
}

/* CRC-32 by long division of bits in sending order, as the store does not compute it. */
static uint32_t crc32_of(const uint8_t *bytes, uint32_t size)
{
    uint32_t crc = UINT32_MAX, reflected = 0;
    for (uint32_t bit = 0; bit < 8 * size; bit++) {
        const uint32_t in = (bytes[bit / 8] >> bit % 8) & 1U;
        const uint32_t out = crc >> 31;
        crc = (crc << 1) ^ (in != out ? UINT32_C(0x04C11DB7) : 0);
    }
    for (uint32_t bit = 0; bit < 32; bit++) {
        reflected |= (crc >> bit & 1U) << (31 - bit);
    }
    return ~reflected;
}

static void reseal_record(uint8_t *record)
{
    const uint32_t crc = crc32_of(record, 72);
    for (unsigned i = 0; i < 4; i++) {
        record[72 + i] = (uint8_t)(crc >> 8 * i);
    }
}

static void reseal_report(uint8_t *report)
{
    const uint16_t crc = opms_wire_crc16(report, 62);
    report[62] = (uint8_t)crc;
    report[63] = (uint8_t)(crc >> 8);
}

static void test_whole_records_of_another_version_or_out_of_range_are_passed_over(void)
{
    save(1);
    save(2);
    uint8_t *record = flash.bytes + STORE_PAGE_SIZE, *report = record + 8, kept[76];
    memcpy(kept, record, sizeof kept);
    reseal_report(report);
    reseal_record(record);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(kept, record, sizeof kept);
    TEST_ASSERT_EQUAL(2, load());

    report[1]++; /* protocol version */
    reseal_report(report);
    reseal_record(record);
    TEST_ASSERT_EQUAL(1, load());

    memcpy(record, kept, sizeof kept);
    memset(report + 8, 0xFF, 4); /* width */
    reseal_report(report);
    reseal_record(record);
    TEST_ASSERT_EQUAL(1, load());
    save(3);
    TEST_ASSERT_EQUAL(3, load());
}

static void test_the_log_goes_on_past_2_to_the_32_records(void)
{
    save(1);
    memset(flash.bytes + 4, 0xFF, 4); /* its number in the log */
    flash.bytes[4] = 0xFD;
    reseal_record(flash.bytes);
    for (uint32_t number = 2; number < 60; number++) {
        save(number);
        TEST_ASSERT_EQUAL(number, load());
    }
}

static void test_worn_pages_are_passed_over(void)
{
    for (uint32_t at = 0; at < sizeof flash.bytes; at += 3 * STORE_PAGE_SIZE) {
        flash.stuck[at + 20] = 0xFF;
    }
    for (uint32_t number = 1; number <= 100; number++) {
        save(number);
        TEST_ASSERT_EQUAL(number, load());
    }
}

static void test_flash_that_keeps_nothing_is_told_and_the_old_settings_hold(void)
{
    save(1);
    memset(flash.stuck, 0xFF, sizeof flash.stuck);
    const opms_settings_t settings = numbered(2);
    for (unsigned i = 0; i < 5; i++) {
        TEST_ASSERT_FALSE(settings_store_save(&view, &settings));
        TEST_ASSERT_EQUAL(1, load());
    }
    memset(flash.stuck, 0, sizeof flash.stuck);
    save(3);
    TEST_ASSERT_EQUAL(3, load());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_blank_flash_holds_nothing_and_leaves_the_settings_alone);
    RUN_TEST(test_all_fields_come_back);
    RUN_TEST(test_the_newest_of_many_is_loaded);
    RUN_TEST(test_the_same_settings_again_write_nothing);
    RUN_TEST(test_the_sectors_wear_alike);
    RUN_TEST(test_a_power_cut_at_any_byte_leaves_the_old_or_the_new);
    RUN_TEST(test_cuts_one_after_another_never_lose_the_last_good_settings);
    RUN_TEST(test_any_damaged_bit_of_the_newest_falls_back_to_the_one_before);
    RUN_TEST(test_with_every_record_damaged_there_is_none_and_saving_goes_on);
    RUN_TEST(test_random_and_constant_flash_holds_nothing_and_can_be_used);
    RUN_TEST(test_whole_records_of_another_version_or_out_of_range_are_passed_over);
    RUN_TEST(test_the_log_goes_on_past_2_to_the_32_records);
    RUN_TEST(test_worn_pages_are_passed_over);
    RUN_TEST(test_flash_that_keeps_nothing_is_told_and_the_old_settings_hold);
    return UNITY_END();
}
