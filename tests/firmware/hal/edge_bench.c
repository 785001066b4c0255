/* SPDX-License-Identifier: Apache-2.0 */
#include "edge_bench.h"

#include <string.h>
#include <unity.h>

edge_order_t order;
opms_settings_t settings;
box_input_t told[EDGE_BENCH_MOST];
uint32_t told_count;

static struct {
    edge_pulse_t pulses[EDGE_BENCH_MOST];
    uint32_t pulses_in, pulses_out, number;
    edge_level_t levels[EDGE_LINES][EDGE_BENCH_MOST];
    uint32_t levels_in[EDGE_LINES], levels_out[EDGE_LINES];
} world;

static bool peek_pulse(edge_pulse_t *pulse)
{
    if (world.pulses_in == world.pulses_out)
        return false;
    *pulse = world.pulses[world.pulses_out];
    return true;
}

static void drop_pulse(void)
{
    world.pulses_out++;
}

static bool peek_level(edge_line_t line, edge_level_t *edge)
{
    if (world.levels_in[line] == world.levels_out[line])
        return false;
    *edge = world.levels[line][world.levels_out[line]];
    return true;
}

static void drop_level(edge_line_t line)
{
    world.levels_out[line]++;
}

static const edge_source_t source = {peek_pulse, drop_pulse, peek_level, drop_level};

void edge_bench_init(void)
{
    memset(&world, 0, sizeof world);
    /* Hardware's count runs since start-up and wraps. */
    world.number = UINT32_MAX - 3;
    told_count = 0;
    opms_wire_default_settings(&settings);
    edge_order_init(&order, &source, &settings);
    order.last_number = world.number;
}

void edge_bench_pulse(box_cycles_t time)
{
    world.pulses[world.pulses_in++] = (edge_pulse_t){.number = ++world.number, .time = time};
}

void edge_bench_lose_pulses(uint32_t count)
{
    world.number += count;
}

static void add_level(edge_line_t line, bool rise, box_cycles_t time)
{
    world.levels[line][world.levels_in[line]++] =
        (edge_level_t){.rise = rise, .time = time + time % 2};
}

void edge_bench_rise(edge_line_t line, box_cycles_t rise)
{
    add_level(line, true, rise);
}

void edge_bench_fall(edge_line_t line, box_cycles_t fall)
{
    add_level(line, false, fall);
}

void edge_bench_high(edge_line_t line, box_cycles_t rise, box_cycles_t fall)
{
    edge_bench_rise(line, rise);
    edge_bench_fall(line, fall);
}

void edge_bench_tell(box_cycles_t now)
{
    while (edge_order_next(&order, now, &told[told_count]))
        TEST_ASSERT_LESS_THAN(EDGE_BENCH_MOST, ++told_count);
}

const char *edge_bench_kinds(void)
{
    static char text[EDGE_BENCH_MOST + 1];
    for (uint32_t i = 0; i < told_count; i++)
        text[i] = "ASPTGE"[told[i].kind];
    text[told_count] = '\0';
    return text;
}

const box_input_t *edge_bench_the(box_input_kind_t kind)
{
    const box_input_t *found = NULL;
    for (uint32_t i = 0; i < told_count; i++) {
        if (told[i].kind != kind)
            continue;
        TEST_ASSERT_NULL_MESSAGE(found, "told twice");
        found = &told[i];
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(found, "not told");
    return found;
}
