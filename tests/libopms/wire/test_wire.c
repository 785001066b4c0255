/* SPDX-License-Identifier: Apache-2.0 */
/* Reports of the trigger box against golden ones that Python's struct and binascii wrote. */
#include <string.h>

#include <unity.h>

#include <opms/wire.h>

#include "wire_vectors.h"

void setUp(void)
{
}

void tearDown(void)
{
}

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Both directions of all golden reports of one kind. */
#define CHECK_BOTH_WAYS(kind, type)                                                                \
    for (size_t i = 0; i < COUNT(kind##_vectors); i++) {                                           \
        const char *name = kind##_vectors[i].name;                                                 \
        uint8_t bytes[OPMS_WIRE_SIZE];                                                             \
        type report;                                                                               \
        memset(bytes, 0xA5, sizeof bytes);                                                         \
        memset(&report, 0xA5, sizeof report);                                                      \
                                                                                                   \
        opms_wire_write_##kind(&kind##_vectors[i].report, bytes);                                  \
        const opms_wire_result_t result =                                                          \
            opms_wire_read_##kind(kind##_vectors[i].bytes, OPMS_WIRE_SIZE, &report);               \
                                                                                                   \
        TEST_ASSERT_EQUAL_HEX8_ARRAY_MESSAGE(kind##_vectors[i].bytes, bytes, sizeof bytes, name);  \
        TEST_ASSERT_EQUAL_STRING_MESSAGE("OK", opms_wire_result_name(result), name);               \
        compare_##kind(&kind##_vectors[i].report, &report, name);                                  \
    }

static void test_golden_reports_of_the_box_are_written_and_read(void)
{
    CHECK_BOTH_WAYS(trigger, opms_trigger_report_t)
    CHECK_BOTH_WAYS(pong, opms_pong_report_t)
    CHECK_BOTH_WAYS(status, opms_status_report_t)
    CHECK_BOTH_WAYS(event, opms_event_report_t)
}

static void test_golden_reports_of_the_host_are_written_and_read(void)
{
    uint8_t bootloader[OPMS_WIRE_SIZE];

    CHECK_BOTH_WAYS(command, opms_command_report_t)
    opms_wire_write_bootloader(bootloader);

    TEST_ASSERT_EQUAL_HEX8_ARRAY(bootloader_vectors[0].bytes, bootloader, sizeof bootloader);
    TEST_ASSERT_EQUAL(OPMS_WIRE_OK, opms_wire_read_bootloader(bootloader, sizeof bootloader));
}

static void test_golden_feature_reports_are_written_and_read(void)
{
    CHECK_BOTH_WAYS(identity, opms_identity_report_t)
    CHECK_BOTH_WAYS(settings, opms_settings_report_t)
    CHECK_BOTH_WAYS(settings_set, opms_settings_t)
    CHECK_BOTH_WAYS(history_request, opms_history_request_t)
    CHECK_BOTH_WAYS(history, opms_history_report_t)
}

/* One signature for all readers, so that they can stand in a table. */
typedef struct reader {
    const char *report;
    opms_wire_result_t (*read)(const uint8_t *bytes, size_t size, void *output);
    uint64_t reserved;
} reader_t;

#define READER(kind, type)                                                                         \
    static opms_wire_result_t any_##kind(const uint8_t *bytes, size_t size, void *output)          \
    {                                                                                              \
        return opms_wire_read_##kind(bytes, size, (type *)output);                                 \
    }

READER(trigger, opms_trigger_report_t)
READER(pong, opms_pong_report_t)
READER(status, opms_status_report_t)
READER(event, opms_event_report_t)
READER(command, opms_command_report_t)
READER(identity, opms_identity_report_t)
READER(settings, opms_settings_report_t)
READER(settings_set, opms_settings_t)
READER(history_request, opms_history_request_t)
READER(history, opms_history_report_t)

static opms_wire_result_t any_bootloader(const uint8_t *bytes, size_t size, void *output)
{
    (void)output;
    return opms_wire_read_bootloader(bytes, size);
}

enum { READERS = 11 };

static reader_t reader_at(size_t i)
{
    const reader_t readers[READERS] = {
        {"trigger", any_trigger, trigger_reserved},
        {"pong", any_pong, pong_reserved},
        {"status", any_status, status_reserved},
        {"event", any_event, event_reserved},
        {"command", any_command, command_reserved},
        {"identity", any_identity, identity_reserved},
        {"settings", any_settings, settings_reserved},
        {"settings_set", any_settings_set, settings_set_reserved},
        {"history_request", any_history_request, history_request_reserved},
        {"history", any_history, history_reserved},
        {"bootloader", any_bootloader, bootloader_reserved},
    };
    return readers[i];
}

static reader_t reader_of(const char *report)
{
    for (size_t i = 0; i < READERS; i++) {
        if (strcmp(reader_at(i).report, report) == 0) {
            return reader_at(i);
        }
    }
    TEST_FAIL_MESSAGE("no reader of that name");
    return reader_at(0);
}

/* The first golden report of a kind. */
static const uint8_t *golden(const char *report)
{
    const struct {
        const char *report;
        const uint8_t *bytes;
    } first[READERS] = {
        {"trigger", trigger_vectors[0].bytes},
        {"pong", pong_vectors[0].bytes},
        {"status", status_vectors[0].bytes},
        {"event", event_vectors[0].bytes},
        {"command", command_vectors[0].bytes},
        {"identity", identity_vectors[0].bytes},
        {"settings", settings_vectors[0].bytes},
        {"settings_set", settings_set_vectors[0].bytes},
        {"history_request", history_request_vectors[0].bytes},
        {"history", history_vectors[0].bytes},
        {"bootloader", bootloader_vectors[0].bytes},
    };
    for (size_t i = 0; i < READERS; i++) {
        if (strcmp(first[i].report, report) == 0) {
            return first[i].bytes;
        }
    }
    return NULL;
}

/* Room for the largest struct, filled with a pattern that a reader must not touch. */
typedef union output {
    uint8_t bytes[256];
    uint64_t aligned;
} output_t;

static void fill(output_t *output)
{
    memset(output->bytes, 0xA5, sizeof output->bytes);
}

static void check_untouched(const output_t *output, const char *name)
{
    TEST_ASSERT_EACH_EQUAL_HEX8_MESSAGE(0xA5, output->bytes, sizeof output->bytes, name);
}

static void test_faulty_reports_are_refused_by_their_fault_and_leave_the_output_alone(void)
{
    for (size_t i = 0; i < COUNT(refused_vectors); i++) {
        const char *name = refused_vectors[i].name;
        output_t output;
        fill(&output);

        const opms_wire_result_t result =
            reader_of(refused_vectors[i].report)
                .read(refused_vectors[i].bytes, refused_vectors[i].size, &output);

        TEST_ASSERT_EQUAL_STRING_MESSAGE(opms_wire_result_name(refused_vectors[i].result),
                                         opms_wire_result_name(result), name);
        check_untouched(&output, name);
    }
}

static void seal(uint8_t *bytes)
{
    const uint16_t crc = opms_wire_crc16(bytes, OPMS_WIRE_SIZE - 2);
    bytes[OPMS_WIRE_SIZE - 2] = (uint8_t)crc;
    bytes[OPMS_WIRE_SIZE - 1] = (uint8_t)(crc >> 8);
}

static void test_a_bit_in_any_reserved_byte_is_refused(void)
{
    for (size_t r = 0; r < READERS; r++) {
        const reader_t reader = reader_at(r);
        for (unsigned bit = 0; bit < 8 * (OPMS_WIRE_SIZE - 2); bit++) {
            if ((reader.reserved >> (bit / 8) & 1U) == 0) {
                continue;
            }
            uint8_t bytes[OPMS_WIRE_SIZE];
            memcpy(bytes, golden(reader.report), sizeof bytes);
            bytes[bit / 8] ^= (uint8_t)(1U << bit % 8);
            seal(bytes);
            output_t output;
            fill(&output);

            TEST_ASSERT_EQUAL_MESSAGE(OPMS_WIRE_VALUE, reader.read(bytes, sizeof bytes, &output),
                                      reader.report);

            check_untouched(&output, reader.report);
        }
    }
}

static void test_any_changed_bit_is_noticed(void)
{
    for (size_t r = 0; r < READERS; r++) {
        const reader_t reader = reader_at(r);
        for (unsigned bit = 0; bit < 8 * OPMS_WIRE_SIZE; bit++) {
            uint8_t bytes[OPMS_WIRE_SIZE];
            memcpy(bytes, golden(reader.report), sizeof bytes);
            bytes[bit / 8] ^= (uint8_t)(1U << bit % 8);
            const opms_wire_result_t want = bit < 8    ? OPMS_WIRE_ID
                                            : bit < 16 ? OPMS_WIRE_VERSION
                                                       : OPMS_WIRE_CRC;
            output_t output;

            TEST_ASSERT_EQUAL_MESSAGE(want, reader.read(bytes, sizeof bytes, &output),
                                      reader.report);
        }
    }
}

static void test_reports_of_every_other_length_are_refused(void)
{
    static uint8_t bytes[4 * OPMS_WIRE_SIZE];
    for (size_t r = 0; r < READERS; r++) {
        const reader_t reader = reader_at(r);
        memcpy(bytes, golden(reader.report), OPMS_WIRE_SIZE);
        for (size_t size = 0; size <= sizeof bytes; size++) {
            output_t output;
            const opms_wire_result_t want =
                size == OPMS_WIRE_SIZE ? OPMS_WIRE_OK : OPMS_WIRE_LENGTH;

            TEST_ASSERT_EQUAL_MESSAGE(want, reader.read(bytes, size, &output), reader.report);
            TEST_ASSERT_EQUAL_MESSAGE(want, opms_wire_check(bytes, size, NULL), reader.report);
        }
    }
}

static void test_null_is_refused_as_bytes_and_allowed_as_output(void)
{
    uint8_t id = 0xA5;
    for (size_t r = 0; r < READERS; r++) {
        const reader_t reader = reader_at(r);
        output_t output;

        TEST_ASSERT_EQUAL(OPMS_WIRE_LENGTH, reader.read(NULL, 0, &output));
        TEST_ASSERT_EQUAL(OPMS_WIRE_LENGTH, reader.read(NULL, OPMS_WIRE_SIZE, &output));
        TEST_ASSERT_EQUAL(OPMS_WIRE_OK, reader.read(golden(reader.report), OPMS_WIRE_SIZE, NULL));
    }
    TEST_ASSERT_EQUAL(OPMS_WIRE_LENGTH, opms_wire_check(NULL, 0, &id));
    TEST_ASSERT_EQUAL(0, id);
    TEST_ASSERT_EQUAL(OPMS_WIRE_LENGTH, opms_wire_check(NULL, OPMS_WIRE_SIZE, NULL));
    TEST_ASSERT_EQUAL_STRING("settings must not be NULL", opms_wire_check_settings(NULL));
}

static void test_a_report_is_known_by_its_id(void)
{
    const uint8_t known[] = {0x01, 0x02, 0x03, 0x04, 0x10, 0x20, 0x21, 0x22, 0x23};
    for (unsigned id = 0; id < 256; id++) {
        uint8_t bytes[OPMS_WIRE_SIZE] = {(uint8_t)id, OPMS_WIRE_PROTOCOL}, got = 0;
        seal(bytes);
        const bool is_known = memchr(known, (int)id, sizeof known) != NULL;

        TEST_ASSERT_EQUAL(is_known ? OPMS_WIRE_OK : OPMS_WIRE_ID,
                          opms_wire_check(bytes, sizeof bytes, &got));

        TEST_ASSERT_EQUAL_HEX8(id, got);
    }
}

static void test_the_check_tells_version_and_crc_apart_and_the_id_all_the_same(void)
{
    uint8_t bytes[OPMS_WIRE_SIZE] = {OPMS_REPORT_PONG, OPMS_WIRE_PROTOCOL + 1}, id = 0;
    seal(bytes);
    TEST_ASSERT_EQUAL(OPMS_WIRE_VERSION, opms_wire_check(bytes, sizeof bytes, &id));
    TEST_ASSERT_EQUAL_HEX8(OPMS_REPORT_PONG, id);
    bytes[1] = OPMS_WIRE_PROTOCOL;
    id = 0;
    TEST_ASSERT_EQUAL(OPMS_WIRE_CRC, opms_wire_check(bytes, sizeof bytes, &id));
    TEST_ASSERT_EQUAL_HEX8(OPMS_REPORT_PONG, id);
    id = 0;
    TEST_ASSERT_EQUAL(OPMS_WIRE_LENGTH, opms_wire_check(bytes, 3, &id));
    TEST_ASSERT_EQUAL_HEX8(OPMS_REPORT_PONG, id);
}

static void test_the_crc_has_its_published_check_value(void)
{
    TEST_ASSERT_EQUAL_HEX16(0x29B1, opms_wire_crc16((const uint8_t *)"123456789", 9));
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, opms_wire_crc16(NULL, 0));
}

static void test_a_gap_of_more_than_24_bits_is_written_as_none(void)
{
    opms_trigger_report_t report = trigger_vectors[0].report;
    report.gap_us[0] = 0xFFFFFF;
    report.gap_us[1] = 0x1000001;
    uint8_t bytes[OPMS_WIRE_SIZE];

    opms_wire_write_trigger(&report, bytes);
    TEST_ASSERT_EQUAL(OPMS_WIRE_OK, opms_wire_read_trigger(bytes, sizeof bytes, &report));

    TEST_ASSERT_EQUAL_HEX32(0xFFFFFF, report.gap_us[0]);
    TEST_ASSERT_EQUAL_HEX32(0, report.gap_us[1]);
}

static void test_a_history_of_too_many_entries_is_written_within_bounds_and_not_read(void)
{
    const uint32_t counts[] = {OPMS_HISTORY_PER_REPORT + 1, 256, 258, 1000000, UINT32_MAX};
    for (size_t i = 0; i < COUNT(counts); i++) {
        opms_history_report_t report = history_vectors[3].report;
        report.count = counts[i];
        uint8_t bytes[OPMS_WIRE_SIZE];

        opms_wire_write_history(&report, bytes);

        TEST_ASSERT_EQUAL(OPMS_WIRE_VALUE, opms_wire_read_history(bytes, sizeof bytes, NULL));
    }
}

static void test_the_default_settings_are_those_of_the_docs(void)
{
    opms_settings_t settings;
    memset(&settings, 0xA5, sizeof settings);

    opms_wire_default_settings(&settings);

    compare_settings_set(&settings_set_vectors[0].report, &settings, "defaults");
    TEST_ASSERT_NULL(opms_wire_check_settings(&settings));
    TEST_ASSERT_EQUAL_HEX16(0x4C0E, opms_wire_settings_crc(&settings));
}

static void test_settings_out_of_range_are_refused_by_name(void)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.period_us = 9999;
    TEST_ASSERT_EQUAL_STRING("period_us must be 10000 to 10000000",
                             opms_wire_check_settings(&settings));
    opms_wire_default_settings(&settings);
    settings.width_us = 99001;
    TEST_ASSERT_EQUAL_STRING("width_us must be 10 to period_us - 1000",
                             opms_wire_check_settings(&settings));
    opms_wire_default_settings(&settings);
    settings.sync = (opms_sync_mode_t)3;
    TEST_ASSERT_NOT_NULL(strstr(opms_wire_check_settings(&settings), "sync"));
    opms_wire_default_settings(&settings);
    settings.debounce_cycles = UINT32_MAX;
    TEST_ASSERT_NOT_NULL(strstr(opms_wire_check_settings(&settings), "debounce_cycles"));
    opms_wire_default_settings(&settings);
    settings.preamble_gap_ms[6] = 10;
    TEST_ASSERT_NOT_NULL(strstr(opms_wire_check_settings(&settings), "after the first 0"));
}

static void test_every_value_has_a_name_of_its_own_and_others_are_unknown(void)
{
    TEST_ASSERT_EQUAL_STRING("bad CRC", opms_wire_result_name(OPMS_WIRE_CRC));
    TEST_ASSERT_EQUAL_STRING("not in this state", opms_refusal_name(OPMS_REFUSAL_STATE));
    TEST_ASSERT_EQUAL_STRING("busy with the one before", opms_refusal_name(OPMS_REFUSAL_BUSY));
    TEST_ASSERT_EQUAL_STRING("WAITING", opms_box_state_name(OPMS_BOX_WAITING));
    TEST_ASSERT_EQUAL_STRING("start refused", opms_event_name(OPMS_EVENT_START_REFUSED));
    TEST_ASSERT_EQUAL_STRING("endpoint healed", opms_event_name(OPMS_EVENT_ENDPOINT_HEALED));
    TEST_ASSERT_EQUAL_STRING("unknown", opms_wire_result_name((opms_wire_result_t)6));
    TEST_ASSERT_EQUAL_STRING("unknown", opms_refusal_name((opms_refusal_t)10));
    TEST_ASSERT_EQUAL_STRING("unknown", opms_box_state_name((opms_box_state_t)5));
    TEST_ASSERT_EQUAL_STRING("unknown", opms_event_name((opms_event_kind_t)0));
    TEST_ASSERT_EQUAL_STRING("unknown", opms_event_name((opms_event_kind_t)13));
}

static void test_box_times_become_nanoseconds(void)
{
    const opms_box_time_t time = {1000001, 124};
    TEST_ASSERT_EQUAL_INT64(1000001992, opms_box_time_ns(time));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_golden_reports_of_the_box_are_written_and_read);
    RUN_TEST(test_golden_reports_of_the_host_are_written_and_read);
    RUN_TEST(test_golden_feature_reports_are_written_and_read);
    RUN_TEST(test_faulty_reports_are_refused_by_their_fault_and_leave_the_output_alone);
    RUN_TEST(test_a_bit_in_any_reserved_byte_is_refused);
    RUN_TEST(test_any_changed_bit_is_noticed);
    RUN_TEST(test_reports_of_every_other_length_are_refused);
    RUN_TEST(test_null_is_refused_as_bytes_and_allowed_as_output);
    RUN_TEST(test_a_report_is_known_by_its_id);
    RUN_TEST(test_the_check_tells_version_and_crc_apart_and_the_id_all_the_same);
    RUN_TEST(test_the_crc_has_its_published_check_value);
    RUN_TEST(test_a_gap_of_more_than_24_bits_is_written_as_none);
    RUN_TEST(test_a_history_of_too_many_entries_is_written_within_bounds_and_not_read);
    RUN_TEST(test_the_default_settings_are_those_of_the_docs);
    RUN_TEST(test_settings_out_of_range_are_refused_by_name);
    RUN_TEST(test_every_value_has_a_name_of_its_own_and_others_are_unknown);
    RUN_TEST(test_box_times_become_nanoseconds);
    return UNITY_END();
}
