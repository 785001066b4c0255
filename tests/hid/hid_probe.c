/* SPDX-License-Identifier: Apache-2.0 */
/* Opens the emulated box, does what stdin says, and prints what comes out as JSON lines:
 *
 *     hid_probe PORT [id=HEX] [queue=N] [ping=MS] [fill=0] [open=MS] [poll=0] [callback=1|2]
 *
 * The tests in Python drive it. poll=0 leaves the queue alone until the command `poll`; callback=2
 * is slow to come back from news of the link. */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <opms/hid.h>

static void print_item(void *user, const opms_box_item_t *item)
{
    (void)user;
    const int64_t t = item->t_host_ns;
    switch (item->kind) {
    case OPMS_ITEM_NONE: return;
    case OPMS_ITEM_TRIGGER:
        printf("{\"item\":\"trigger\",\"t\":%lld,\"session\":%u,\"number\":%u,\"time_ns\":%lld}\n",
               (long long)t, item->as.trigger.session_id, item->as.trigger.trigger_number,
               (long long)opms_box_time_ns(item->as.trigger.time));
        break;
    case OPMS_ITEM_PONG:
        printf("{\"item\":\"pong\",\"t\":%lld,\"id\":%u,\"sent\":%lld}\n", (long long)t,
               item->as.pong.report.ping_id, (long long)item->as.pong.t_sent_host_ns);
        break;
    case OPMS_ITEM_STATUS:
        printf("{\"item\":\"status\",\"t\":%lld,\"state\":%d,\"number\":%u}\n", (long long)t,
               (int)item->as.status.state, item->as.status.trigger_number);
        break;
    case OPMS_ITEM_EVENT:
        printf("{\"item\":\"event\",\"t\":%lld,\"kind\":%d,\"argument\":%u}\n", (long long)t,
               (int)item->as.event.kind, item->as.event.argument);
        break;
    case OPMS_ITEM_HISTORY:
        printf("{\"item\":\"history\",\"session\":%u,\"number\":%u,\"flags\":%u,"
               "\"time_ns\":%lld}\n",
               item->as.history.session_id, item->as.history.entry.number,
               (unsigned)item->as.history.entry.flags,
               (long long)opms_box_time_ns(item->as.history.entry.time));
        break;
    case OPMS_ITEM_LINK:
        printf("{\"item\":\"link\",\"change\":%d,\"boot\":%u,\"message\":\"%s\"}\n",
               (int)item->as.link.change, item->as.link.boot_id, item->as.link.message);
        break;
    case OPMS_ITEM_LOST:
        printf("{\"item\":\"lost\",\"what\":%d,\"session\":%u,\"first\":%u,\"count\":%u}\n",
               (int)item->as.lost.what, item->as.lost.session_id, item->as.lost.first,
               item->as.lost.count);
        break;
    case OPMS_ITEM_MALFORMED:
        printf("{\"item\":\"malformed\",\"result\":%d,\"id\":%u,\"size\":%u}\n",
               (int)item->as.malformed.result, item->as.malformed.id, item->as.malformed.size);
        break;
    }
    fflush(stdout);
}

static void print_slowly(void *user, const opms_box_item_t *item)
{
    print_item(user, item);
    if (item->kind == OPMS_ITEM_LINK) {
        poll(NULL, 0, 300);
    }
}

static void reply(const char *name, opms_status_t status, const opms_error_t *err,
                  const char *extra)
{
    printf("{\"reply\":\"%s\",\"status\":\"%s\",\"message\":\"%s\"%s%s}\n", name,
           opms_status_name(status), status == OPMS_OK ? "" : err->message, *extra ? "," : "",
           extra);
    fflush(stdout);
}

static void reply_counters(opms_box_t *box)
{
    opms_error_t err = {0};
    opms_box_counters_t c = {0};
    const opms_status_t status = opms_box_get_counters(box, &c, &err);
    char extra[600];
    snprintf(extra, sizeof extra,
             "\"triggers\":%llu,\"malformed\":[%llu,%llu,%llu,%llu,%llu,%llu],"
             "\"reports_lost\":%llu,\"repeated\":%llu,\"missed\":%llu,\"filled\":%llu,"
             "\"unfilled\":%llu,\"items_lost\":%llu,\"connections\":%llu,\"reboots\":%llu,"
             "\"requests_failed\":%llu",
             (unsigned long long)c.triggers, (unsigned long long)c.malformed[0],
             (unsigned long long)c.malformed[1], (unsigned long long)c.malformed[2],
             (unsigned long long)c.malformed[3], (unsigned long long)c.malformed[4],
             (unsigned long long)c.malformed[5], (unsigned long long)c.reports_lost,
             (unsigned long long)c.reports_repeated, (unsigned long long)c.triggers_missed,
             (unsigned long long)c.triggers_filled, (unsigned long long)c.triggers_unfilled,
             (unsigned long long)c.items_lost, (unsigned long long)c.connections,
             (unsigned long long)c.reboots, (unsigned long long)c.requests_failed);
    reply("counters", status, &err, extra);
}

static void reply_identity(opms_box_t *box)
{
    opms_error_t err = {0};
    opms_identity_report_t identity = {0};
    bool connected = false;
    const opms_status_t status = opms_box_get_identity(box, &identity, &connected, &err);
    char extra[200];
    snprintf(extra, sizeof extra, "\"boot\":%u,\"git\":\"%s\",\"first_byte\":%u,\"connected\":%s",
             identity.boot_id, identity.git_hash, (unsigned)identity.unique_id[0],
             connected ? "true" : "false");
    reply("identity", status, &err, extra);
}

static void reply_settings(const char *name, opms_status_t status, const opms_error_t *err,
                           const opms_settings_report_t *report)
{
    char extra[200];
    snprintf(extra, sizeof extra, "\"period_us\":%u,\"gap0\":%u,\"pending\":%s",
             report->settings.period_us, (unsigned)report->settings.preamble_gap_ms[0],
             report->pending ? "true" : "false");
    reply(name, status, err, extra);
}

static void do_set(opms_box_t *box, uint32_t period_us, uint32_t timeout_ms)
{
    opms_error_t err = {0};
    opms_settings_t settings;
    opms_settings_report_t report = {0};
    opms_wire_default_settings(&settings);
    settings.period_us = period_us;
    const opms_status_t status = opms_box_set_settings(box, &settings, timeout_ms, &report, &err);
    reply_settings("set", status, &err, &report);
}

static void do_history(opms_box_t *box, uint32_t session, uint32_t first, uint32_t count,
                       uint32_t timeout_ms)
{
    opms_error_t err = {0};
    opms_history_entry_t *entries = calloc(OPMS_BOX_HISTORY_ENTRIES, sizeof *entries);
    const opms_status_t status =
        opms_box_history(box, session, first, count, timeout_ms, entries, &err);
    uint32_t held = 0, in_order = 0;
    for (uint32_t i = 0; status == OPMS_OK && i < count; ++i) {
        held += (entries[i].flags & OPMS_TRIGGER_NOT_HELD) == 0;
        in_order += entries[i].number == first + i;
    }
    char extra[100];
    snprintf(extra, sizeof extra, "\"held\":%u,\"in_order\":%u", held, in_order);
    reply("history", status, &err, extra);
    free(entries);
}

/** @return Whether to go on. */
static bool do_command(opms_box_t *box, char *line)
{
    opms_error_t err = {0};
    char name[32] = "";
    unsigned a = 0, b = 0, c = 0, d = 0;
    sscanf(line, "%31s %u %u %u %u", name, &a, &b, &c, &d);
    if (!strcmp(name, "arm")) {
        reply(name, opms_box_arm(box, a, b, &err), &err, "");
    } else if (!strcmp(name, "disarm")) {
        reply(name, opms_box_disarm(box, a, &err), &err, "");
    } else if (!strcmp(name, "ping")) {
        uint32_t id = 0;
        const opms_status_t status = opms_box_ping(box, a, &id, &err);
        char extra[40];
        snprintf(extra, sizeof extra, "\"id\":%u", id);
        reply(name, status, &err, extra);
    } else if (!strcmp(name, "settings")) {
        opms_settings_report_t report = {0};
        const opms_status_t status = opms_box_get_settings(box, a, &report, &err);
        reply_settings(name, status, &err, &report);
    } else if (!strcmp(name, "set")) {
        do_set(box, a, b);
    } else if (!strcmp(name, "history")) {
        do_history(box, a, b, c, d);
    } else if (!strcmp(name, "bootloader")) {
        reply(name, opms_box_bootloader(box, a, &err), &err, "");
    } else if (!strcmp(name, "counters")) {
        reply_counters(box);
    } else if (!strcmp(name, "identity")) {
        reply_identity(box);
    } else if (!strcmp(name, "plug")) {
        reply(name, opms_box_emulate_plug(box, a != 0, &err), &err, "");
    } else if (!strcmp(name, "poll")) {
        for (opms_box_item_t item; opms_box_poll(box, 50, &item, &err) == OPMS_OK && item.kind;) {
            print_item(NULL, &item);
        }
        reply(name, OPMS_OK, &err, "");
    }
    return strcmp(name, "close") != 0;
}

/** @return Whether a whole line was read; false at the end of input. */
static bool read_line(char *line, size_t size)
{
    size_t length = 0;
    while (length + 1 < size && read(STDIN_FILENO, &line[length], 1) == 1) {
        if (line[length] == '\n') {
            line[length] = 0;
            return true;
        }
        ++length;
    }
    return false;
}

static bool take_option(const char *text, opms_box_options_t *options, bool *polls)
{
    unsigned value = 0;
    char id[OPMS_BOX_ID_SIZE];
    if (sscanf(text, "id=%16s", id) == 1) {
        memcpy(options->unique_id, id, sizeof id);
    } else if (sscanf(text, "queue=%u", &value) == 1) {
        options->queue_items = value;
    } else if (sscanf(text, "ping=%u", &value) == 1) {
        options->ping_interval_ms = value;
    } else if (sscanf(text, "fill=%u", &value) == 1) {
        options->fill_gaps = value != 0;
    } else if (sscanf(text, "open=%u", &value) == 1) {
        options->open_timeout_ms = value;
    } else if (sscanf(text, "poll=%u", &value) == 1) {
        *polls = value != 0;
    } else if (sscanf(text, "callback=%u", &value) == 1) {
        options->on_item = value == 2 ? print_slowly : value == 1 ? print_item : NULL;
    } else {
        return false;
    }
    return true;
}

static void run(opms_box_t *box, bool polls)
{
    opms_error_t err = {0};
    char line[200];
    for (bool go_on = true; go_on;) {
        struct pollfd input = {STDIN_FILENO, POLLIN, 0};
        if (poll(&input, 1, polls ? 0 : 50) > 0) {
            go_on = read_line(line, sizeof line) && do_command(box, line);
        }
        opms_box_item_t item;
        if (polls && opms_box_poll(box, 10, &item, &err) == OPMS_OK) {
            print_item(NULL, &item);
        }
    }
}

int main(int argc, char **argv)
{
    opms_box_options_t options;
    opms_box_options_init(&options);
    options.transport = OPMS_BOX_EMULATED;
    options.emulated_port = (uint16_t)(argc > 1 ? atoi(argv[1]) : 0);
    bool polls = true;
    for (int i = 2; i < argc; ++i) {
        if (!take_option(argv[i], &options, &polls)) {
            fprintf(stderr, "hid_probe: what is %s?\n", argv[i]);
            return 2;
        }
    }
    opms_error_t err = {0};
    opms_box_t *box = NULL;
    const opms_status_t status = opms_box_open(&options, &box, &err);
    reply("open", status, &err, "");
    if (status == OPMS_OK) {
        run(box, polls);
        opms_box_close(box);
        reply("close", OPMS_OK, &err, "");
    }
    return 0;
}
