/* SPDX-License-Identifier: Apache-2.0 */
#include "edge_order.h"

#include <string.h>

/* Pulses are tagged to the cycle, START to two. */
#define TOLERANCE 1U

/* Two pulses that are closer than this have one tag. */
#define TAGGERS_DEAD_TIME 10U
/* After this long a tag has arrived. */
#define SETTLED (10U * OPMS_BOX_CYCLES_PER_US)

/* A candidate that cannot come yet. */
#define NEVER UINT64_MAX

void edge_order_init(edge_order_t *order, const edge_source_t *source,
                     const opms_settings_t *settings)
{
    memset(order, 0, sizeof *order);
    order->source = source;
    order->debounce_cycles = settings->debounce_cycles;
}

/* Bring the next two pulses into sight. */
static void hold_pulses(edge_order_t *order)
{
    while (order->pulses_held < 2 &&
           order->source->peek_pulse(&order->pulses[order->pulses_held])) {
        order->source->drop_pulse();
        order->pulses_held++;
    }
}

static edge_pulse_t take_pulse(edge_order_t *order)
{
    edge_pulse_t pulse = order->pulses[0];
    order->pulses[0] = order->pulses[1];
    order->pulses_held--;
    return pulse;
}

static void forget_line(edge_order_t *order, edge_line_t line, edge_high_t *high)
{
    edge_level_t edge;
    while (order->source->peek_level(line, &edge)) {
        *high = (edge_high_t){.seen = edge.rise, .told = edge.rise, .rise = edge.time};
        order->source->drop_level(line);
    }
    high->told = true;
}

void edge_order_set_lines(edge_order_t *order, const opms_settings_t *settings)
{
    order->debounce_cycles = settings->debounce_cycles;
    forget_line(order, EDGE_LINE_START, &order->start);
    forget_line(order, EDGE_LINE_STROBE, &order->strobe);
    for (hold_pulses(order); order->pulses_held != 0; hold_pulses(order))
        order->last_number = take_pulse(order).number;
}

static void plan_preamble(edge_order_t *order, const opms_settings_t *settings)
{
    order->preamble_pulses = 0;
    order->preamble_at[0] = 0;
    for (uint32_t gap = 0; gap < OPMS_BOX_PREAMBLE_MAX && settings->preamble_gap_ms[gap] != 0;
         gap++) {
        order->preamble_at[gap + 1] =
            order->preamble_at[gap] + settings->preamble_gap_ms[gap] * BOX_CYCLES_PER_MS;
        order->preamble_pulses = gap + 2;
    }
}

void edge_order_armed(edge_order_t *order, const opms_settings_t *settings, box_cycles_t now)
{
    plan_preamble(order, settings);
    order->debounce_cycles = settings->debounce_cycles;
    order->armed_number = order->last_number;
    order->listening = true;
    order->start_told = false;
    order->armed_due = true;
    order->armed_at = now;
}

void edge_order_stopped(edge_order_t *order, box_cycles_t now)
{
    order->stopped_due = true;
    order->stopped_at = now;
}

/* --- lines ------------------------------------------------------------------------------------ */

/* Bring a line's next high, or its end, into sight. */
static void follow_line(edge_order_t *order, edge_line_t line, edge_high_t *high)
{
    edge_level_t edge;
    while (!(high->seen && high->fallen) && order->source->peek_level(line, &edge)) {
        if (edge.rise)
            *high = (edge_high_t){.seen = true, .rise = edge.time};
        else if (high->seen && high->told)
            high->seen = false;
        else if (high->seen) {
            high->fallen = true;
            high->fall = edge.time;
        }
        order->source->drop_level(line);
    }
}

/* A high as the event's length: more than 34 s are not told apart. */
static uint32_t length_of(const edge_high_t *high)
{
    box_cycles_t length = high->fall - high->rise;
    return length < UINT32_MAX ? (uint32_t)length : UINT32_MAX;
}

/* --- the run's first pulse -------------------------------------------------------------------- */

static bool is_near(box_cycles_t one, box_cycles_t other)
{
    return one + TOLERANCE >= other && other + TOLERANCE >= one;
}

static bool is_on_schedule(const edge_order_t *order, uint32_t number, box_cycles_t time)
{
    if (number > order->preamble_pulses)
        return false;
    return number == 1 || is_near(time, order->first_pulse + order->preamble_at[number - 1]);
}

typedef enum pulse_kind { PULSE_PLAIN, PULSE_BEGINS_RUN, PULSE_UNDECIDED } pulse_kind_t;

/* A pulse that is due in the preamble, and just before the one that START makes: where START cut
 * it right after its edge, and the debounce is nearly 0, both may have this one tag. */
static pulse_kind_t judge_close_pulse(const edge_order_t *order, box_cycles_t now)
{
    const edge_pulse_t *pulses = order->pulses;
    if (order->pulses_held == 2) {
        bool another = pulses[1].time - pulses[0].time <= TAGGERS_DEAD_TIME + 2 * TOLERANCE;
        return another ? PULSE_PLAIN : PULSE_BEGINS_RUN;
    }
    return now < pulses[0].time + SETTLED ? PULSE_UNDECIDED : PULSE_BEGINS_RUN;
}

static pulse_kind_t judge_pulse(const edge_order_t *order, box_cycles_t now)
{
    const edge_pulse_t *pulse = &order->pulses[0];
    if (!order->listening || order->armed_due)
        return PULSE_PLAIN;
    if (!is_on_schedule(order, pulse->number - order->armed_number, pulse->time))
        return PULSE_BEGINS_RUN;
    if (!order->start.seen)
        return PULSE_PLAIN;
    box_cycles_t due = order->start.rise + order->debounce_cycles + OPMS_BOX_START_CYCLES;
    if (is_near(pulse->time, due))
        return PULSE_BEGINS_RUN;
    if (pulse->time < due && due - pulse->time <= TAGGERS_DEAD_TIME)
        return judge_close_pulse(order, now);
    return PULSE_PLAIN;
}

/* --- candidates ------------------------------------------------------------------------------- */

/* What could be told next: when it was decided, and how to tell it. */
typedef struct candidate {
    box_cycles_t decided;
    void (*tell)(edge_order_t *order, box_input_t *input);
} candidate_t;

static void tell_start_line(edge_order_t *order, box_input_t *input)
{
    input->kind = BOX_INPUT_START;
    input->time = order->start.rise;
    order->start.told = true;
    if (order->start.fallen)
        order->start.seen = false;
}

static void tell_glitch(edge_order_t *order, box_input_t *input)
{
    /* The tags may make it longer by a cycle than the generator knows it was. */
    uint32_t length = length_of(&order->start);
    uint32_t longest = order->debounce_cycles == 0 ? 0 : order->debounce_cycles - 1;
    input->kind = BOX_INPUT_GLITCH;
    input->time = order->start.rise;
    input->length_cycles = length < longest ? length : longest;
    order->start.seen = false;
}

static void tell_strobe(edge_order_t *order, box_input_t *input)
{
    input->kind = BOX_INPUT_STROBE;
    input->time = order->strobe.rise;
    input->length_cycles = length_of(&order->strobe);
    order->strobe.seen = false;
}

static void tell_armed(edge_order_t *order, box_input_t *input)
{
    input->kind = BOX_INPUT_ARMED;
    input->time = order->armed_at;
    order->armed_due = false;
}

static void tell_stopped(edge_order_t *order, box_input_t *input)
{
    input->kind = BOX_INPUT_STOPPED;
    input->time = order->stopped_at;
    order->stopped_due = false;
    order->listening = false;
}

/* What comes before the run's first pulse: the edge that made it. Pieces of a noisy START up to
 * the end of its debounce belong to it. */
static void tell_start_of_run(edge_order_t *order, box_input_t *input)
{
    order->start_edge =
        order->pulses[0].time - OPMS_BOX_START_CYCLES - order->debounce_cycles;
    order->start_told = true;
    order->listening = false;
    input->kind = BOX_INPUT_START;
    input->time = order->start_edge;
}

static void tell_pulse(edge_order_t *order, box_input_t *input)
{
    edge_pulse_t pulse = take_pulse(order);
    order->last_number = pulse.number;
    input->kind = BOX_INPUT_PULSE;
    input->time = pulse.time;
    input->number = pulse.number - order->armed_number;
    if (input->number == 1)
        order->first_pulse = pulse.time;
}

static candidate_t pulse_candidate(const edge_order_t *order, box_cycles_t now)
{
    if (order->pulses_held == 0)
        return (candidate_t){NEVER, NULL};
    box_cycles_t time = order->pulses[0].time;
    switch (judge_pulse(order, now)) {
    case PULSE_PLAIN:
        return (candidate_t){time, tell_pulse};
    case PULSE_BEGINS_RUN:
        return (candidate_t){time - OPMS_BOX_START_CYCLES - 2 * TOLERANCE, tell_start_of_run};
    case PULSE_UNDECIDED:
        break;
    }
    return (candidate_t){NEVER, NULL};
}

/* While the generator listens, a high is a START if a pulse says so, else a glitch at its end. */
static candidate_t start_while_listening(const edge_high_t *high, box_cycles_t now)
{
    if (!high->fallen || now < high->fall + SETTLED)
        return (candidate_t){NEVER, NULL};
    return (candidate_t){high->fall, tell_glitch};
}

static candidate_t start_candidate(const edge_order_t *order, box_cycles_t now)
{
    const edge_high_t *high = &order->start;
    if (!high->seen || high->told)
        return (candidate_t){NEVER, NULL};
    box_cycles_t passed = high->rise + order->debounce_cycles;
    if (order->armed_due && high->rise <= order->armed_at)
        return (candidate_t){high->rise, tell_start_line};
    if (order->listening)
        return start_while_listening(high, now);
    if (high->fallen && high->fall < passed)
        return (candidate_t){high->fall, tell_glitch};
    if (high->fallen || now >= passed)
        return (candidate_t){passed, tell_start_line};
    return (candidate_t){NEVER, NULL};
}

static candidate_t strobe_candidate(const edge_order_t *order)
{
    const edge_high_t *high = &order->strobe;
    if (!high->seen || !high->fallen)
        return (candidate_t){NEVER, NULL};
    return (candidate_t){high->fall, tell_strobe};
}

static candidate_t marker_candidate(const edge_order_t *order)
{
    if (order->armed_due)
        return (candidate_t){order->armed_at, tell_armed};
    if (order->stopped_due)
        return (candidate_t){order->stopped_at, tell_stopped};
    return (candidate_t){NEVER, NULL};
}

/* The run's own START, and what is left of it, has been told with its first pulse. */
static void absorb_start(edge_order_t *order)
{
    edge_high_t *high = &order->start;
    if (!order->start_told || !high->seen || high->told ||
        high->rise > order->start_edge + order->debounce_cycles + TAGGERS_DEAD_TIME)
        return;
    high->told = true;
    if (high->fallen)
        high->seen = false;
}

bool edge_order_next(edge_order_t *order, box_cycles_t now, box_input_t *input)
{
    do {
        follow_line(order, EDGE_LINE_START, &order->start);
        absorb_start(order);
    } while (!order->start.seen && order->source->peek_level(EDGE_LINE_START, &(edge_level_t){0}));
    follow_line(order, EDGE_LINE_STROBE, &order->strobe);
    hold_pulses(order);
    const candidate_t candidates[] = {
        pulse_candidate(order, now),
        start_candidate(order, now),
        strobe_candidate(order),
        marker_candidate(order),
    };
    const candidate_t *first = &candidates[0];
    for (uint32_t i = 1; i < sizeof candidates / sizeof *candidates; i++)
        if (candidates[i].decided < first->decided)
            first = &candidates[i];
    if (first->decided == NEVER)
        return false;
    *input = (box_input_t){0};
    first->tell(order, input);
    return true;
}
