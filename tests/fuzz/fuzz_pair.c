/* SPDX-License-Identifier: Apache-2.0 */
/* Any inputs in any order: the pairer never crashes, its sums stay exact, and no trigger and no
 * frame gets two results.
 *
 * The first byte chooses the profile; each input after it is one byte for its kind and seven for
 * what it holds. Small steps of numbers and times keep the inputs near to what a session is made
 * of; some kinds take extreme values. make_pair_corpus.py writes seeds of this form. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <opms/pair.h>

#define MS 1000000LL
#define FRAMES_MAX 65536
#define INPUT_BYTES 8

enum { PROFILE_STAMP = 1, PROFILE_STROBE = 2, PROFILE_16_BIT = 4, PROFILE_WRAP = 8 };

typedef struct session {
    opms_pairer_t *pairer;
    int64_t now_ns;
    uint32_t number, boot_id, session_id;
    uint64_t frame_id, pushed;
    uint8_t seen[FRAMES_MAX];  /* results of each frame */
    uint64_t first, next_lost; /* triggers: results come once a number */
    uint8_t trigger_seen[FRAMES_MAX];
} session_t;

static void require(int holds)
{
    if (!holds) {
        abort();
    }
}

static void take_results(session_t *s)
{
    opms_pair_result_t results[7];
    uint32_t count = 0;
    do {
        require(opms_pairer_poll(s->pairer, results, 7, &count, NULL) == OPMS_OK);
        for (uint32_t i = 0; i < count; ++i) {
            const opms_pair_result_t *result = &results[i];
            require(result->frame_state != OPMS_FRAME_NONE ||
                    result->trigger_state != OPMS_TRIGGER_NONE);
            require((result->frame_state == OPMS_FRAME_PAIRED) ==
                    (result->trigger_state == OPMS_TRIGGER_PAIRED));
            if (result->frame_state != OPMS_FRAME_NONE) {
                require(result->frame.tag < s->pushed && s->seen[result->frame.tag]++ == 0);
            }
            if (result->frame_state == OPMS_FRAME_PAIRED) { /* two witnesses, at least */
                const uint32_t w = result->witnesses & ~(uint32_t)OPMS_WITNESS_PREAMBLE;
                require((w & (w - 1)) != 0);
            }
            if (result->trigger_state != OPMS_TRIGGER_NONE && result->trigger_count == 1) {
                const uint64_t at = result->trigger_number - s->first;
                require(at >= FRAMES_MAX || s->trigger_seen[at]++ == 0);
            }
        }
    } while (count > 0);
    opms_pair_summary_t summary;
    opms_pairer_summary(s->pairer, &summary);
    require(summary.sums_hold);
    require(memchr(summary.line, 0, sizeof summary.line) != NULL);
}

static opms_box_time_t box_time(int64_t ns)
{
    const opms_box_time_t time = {(uint64_t)ns / 1000, (uint8_t)((uint64_t)ns % 1000 / 8)};
    return time;
}

static uint64_t extreme(const uint8_t *in)
{
    uint64_t value = 0;
    memcpy(&value, in, 6);
    return in[0] & 1 ? value << 8 : UINT64_MAX - value;
}

static void push_trigger(session_t *s, const uint8_t *in)
{
    opms_trigger_report_t report = {.flags = in[0], .boot_id = s->boot_id,
                                    .session_id = s->session_id};
    s->number += (uint32_t)(int8_t)in[1];
    report.trigger_number = s->number;
    report.time = box_time(s->now_ns + (int8_t)in[2] * MS);
    report.gap_us[0] = in[3] * 1000U;
    report.gap_us[1] = in[4] * 1000U;
    report.first_run_number = in[5];
    report.start_edge = report.time;
    report.strobe_for_trigger = s->number - in[6];
    report.strobe_length_cycles = in[5] * 1000U;
    if (in[0] == 255) {
        report.time.us = extreme(in);
    }
    (void)opms_pairer_push_trigger(s->pairer, &report, s->now_ns + 900000 * MS, NULL);
}

static void push_frame(session_t *s, const uint8_t *in)
{
    if (s->pushed == FRAMES_MAX) {
        return;
    }
    opms_frame_t frame = {.tag = s->pushed, .flags = in[5] & 7U};
    s->frame_id += (uint64_t)(int8_t)in[0];
    frame.frame_id = s->frame_id;
    frame.camera_time_ticks = (uint64_t)(s->now_ns + (int8_t)in[1] * MS) / 8;
    frame.arrival_host_ns = s->now_ns + 900000 * MS + 30 * MS + in[2] * (MS / 4);
    if (in[6] == 255) {
        frame.frame_id = extreme(in);
        frame.camera_time_ticks = extreme(in + 1);
    }
    if (opms_pairer_push_frame(s->pairer, &frame, NULL) == OPMS_OK) {
        ++s->pushed;
    }
}

static void push_history(session_t *s, const uint8_t *in)
{
    opms_history_report_t report = {.token = 1, .boot_id = s->boot_id,
                                    .session_id = s->session_id, .count = 1U + in[0] % 2U};
    for (uint32_t i = 0; i < report.count; ++i) {
        report.entries[i].number = s->number - in[1] + i;
        report.entries[i].flags = in[2];
        report.entries[i].time = box_time(s->now_ns - in[1] * 100 * MS + i * 100 * MS);
        report.entries[i].strobe_length_cycles = in[3];
    }
    (void)opms_pairer_push_history(s->pairer, &report, NULL);
}

static void push_others(session_t *s, uint8_t kind, const uint8_t *in)
{
    if (kind == 0) {
        opms_event_report_t event = {.kind = (opms_event_kind_t)(in[0] % 14),
                                     .boot_id = s->boot_id + (in[1] > 250),
                                     .session_id = s->session_id, .time = box_time(s->now_ns),
                                     .argument = s->number + in[2]};
        (void)opms_pairer_push_event(s->pairer, &event, NULL);
    } else if (kind == 1) {
        opms_status_report_t status = {.state = (opms_box_state_t)(in[0] % 5),
                                       .boot_id = s->boot_id + (in[1] > 250),
                                       .session_id = s->session_id,
                                       .trigger_number = s->number + in[2]};
        if (in[3] == 255) { /* a jump by thousands */
            status.trigger_number += (uint32_t)in[4] << 9;
        }
        (void)opms_pairer_push_status(s->pairer, &status, NULL);
    } else {
        opms_pong_report_t pong = {.boot_id = s->boot_id, .ping_id = in[0]};
        const int64_t sent_ns = s->now_ns + 900000 * MS;
        pong.received = box_time(s->now_ns + in[1] * 10000);
        pong.sent = box_time(s->now_ns + in[1] * 10000 + in[2] * 100);
        (void)opms_pairer_push_pong(s->pairer, sent_ns, &pong, sent_ns + in[3] * 20000, NULL);
    }
}

static void change_session(session_t *s, const uint8_t *in)
{
    opms_settings_t settings;
    opms_wire_default_settings(&settings);
    settings.period_us = in[0] & 1 ? 100000 : 10000;
    if (opms_pairer_close(s->pairer, NULL) == OPMS_ERR_INTERNAL) {
        abort();
    }
    take_results(s);
    memset(s->trigger_seen, 0, sizeof s->trigger_seen);
    s->boot_id += in[1] & 1;
    s->session_id += 1;
    s->number = (uint32_t)s->first;
    (void)opms_pairer_open(s->pairer, s->boot_id, s->session_id, &settings, NULL);
}

static void step(session_t *s, const uint8_t *in)
{
    switch (in[0] % 12) {
    case 0: case 1: case 2: push_trigger(s, in + 1); break;
    case 3: case 4: case 5: push_frame(s, in + 1); break;
    case 6: push_history(s, in + 1); break;
    case 7: push_others(s, in[1] % 2, in + 2); break;
    case 8: push_others(s, 2, in + 1); break;
    case 9:
        if (in[1] > 250) {
            change_session(s, in + 2);
        }
        break;
    default:
        s->now_ns += in[1] == 255 ? 7000 * MS : (in[0] & 16 ? 100 : in[1]) * MS;
        (void)opms_pairer_advance(s->pairer, s->now_ns + 900000 * MS, NULL);
        break;
    }
    take_results(s);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < 1) {
        return 0;
    }
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera.has_camera_time = (data[0] & PROFILE_STAMP) != 0;
    options.camera.camera_time_bits = data[0] & PROFILE_16_BIT ? 32 : 64;
    options.camera.camera_tick_hz = 125000000;
    options.camera.has_strobe = (data[0] & PROFILE_STROBE) != 0;
    options.camera.frame_id_bits = data[0] & PROFILE_16_BIT ? 16 : 64;
    options.camera.frame_id_skips_0 = (data[0] & PROFILE_16_BIT) != 0;
    options.first_number = data[0] & PROFILE_WRAP ? 0xFFFFFFF0U : 1;
    session_t *s = calloc(1, sizeof *s);
    require(s != NULL);
    s->now_ns = 20000 * MS;
    s->boot_id = s->session_id = 1;
    s->first = options.first_number;
    s->number = options.first_number;
    s->frame_id = 65500;
    require(opms_pairer_create(&options, &s->pairer, NULL) == OPMS_OK);
    const uint8_t first_session[7] = {1, 0, 0, 0, 0, 0, 0};
    change_session(s, first_session);
    for (size_t at = 1; at + INPUT_BYTES <= size; at += INPUT_BYTES) {
        step(s, data + at);
    }
    require(opms_pairer_close(s->pairer, NULL) != OPMS_ERR_INTERNAL);
    take_results(s);
    for (uint64_t i = 0; i < s->pushed; ++i) {
        require(s->seen[i] == 1);
    }
    opms_pairer_destroy(s->pairer);
    free(s);
    return 0;
}
