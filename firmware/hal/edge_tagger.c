/* SPDX-License-Identifier: Apache-2.0 */
/* Method: four machines count 2-cycle steps from one common start. Two of them tag TRIG, one cycle
 * apart, so that the earlier of their two looks at an edge tells its cycle. Each machine's words go
 * to a ring of its own by an endless DMA channel; how far a channel is, its transfer count says.
 * A 32-bit count of steps wraps every 68 s; the microsecond timer gives the upper digits. */
#include "edge_tagger.h"

#include "board_pins.h"
#include "cycle_clock.h"
#include "hardware/dma.h"
#include "hardware/irq.h"
#include "hardware/pio.h"
#include "hardware/sync.h"
#include "hardware/timer.h"
#include "tagger.pio.h"

#define RING_WORDS (2U * OPMS_BOX_RING_ENTRIES)
#define RING_BYTES_LOG2 13U
/* Transfers before a channel has to be started again: whole rings, so that its place stays. */
#define CHANNEL_TRANSFERS (UINT32_MAX - UINT32_MAX % RING_WORDS)

#define MACHINES 4U
#define FIRST_LEVEL_MACHINE 2U
#define WORDS_PER_PULSE 2U
#define WAKING_FLAGS 0x3U
#define WAKING_SOURCES ((1U << pis_interrupt0) | (1U << pis_interrupt1))

/* From the timer's tick to the first step: about, but the same in every boot of one build. */
#define START_LATENCY_CYCLES 20U
/* The step that is pushed was counted after the look; the look comes 2 cycles after the edge. */
#define STEP_TO_EDGE_CYCLES 5U
/* The second machine of a pair tags one cycle later; far later than that it never will. */
#define PARTNER_PATIENCE (100U * OPMS_BOX_CYCLES_PER_US)

typedef struct tag_ring {
    uint32_t words[RING_WORDS];
} tag_ring_t;

static tag_ring_t rings[MACHINES] __attribute__((aligned(1U << RING_BYTES_LOG2)));
static uint32_t finished_transfers[MACHINES]; /* of earlier starts of the channel */
static uint32_t heads[MACHINES];              /* at the last look; free-running */
static uint32_t tails[MACHINES];
static uint32_t missed_edges[2];              /* of TRIG, by one machine but not by the other */
static box_cycles_t started_at;
static box_cycles_t looked_at;
static bool outrun[EDGE_LINES];

_Static_assert(sizeof(tag_ring_t) == 1U << RING_BYTES_LOG2, "DMA wraps at powers of two");

/* --- rings ------------------------------------------------------------------------------------ */

static void start_channel(uint machine)
{
    dma_channel_config config = dma_channel_get_default_config(machine);
    channel_config_set_read_increment(&config, false);
    channel_config_set_write_increment(&config, true);
    channel_config_set_ring(&config, true, RING_BYTES_LOG2);
    channel_config_set_dreq(&config, pio_get_dreq(pio1, machine, false));
    dma_channel_configure(machine, &config, rings[machine].words, &pio1->rxf[machine],
                          CHANNEL_TRANSFERS, true);
}

/* Words that have arrived since start-up. */
static uint32_t words_of(uint machine)
{
    return finished_transfers[machine] + CHANNEL_TRANSFERS -
           dma_channel_hw_addr(machine)->transfer_count;
}

/* Four thousand million words end a channel. Its FIFO keeps what comes until this is called. */
static void keep_channel_going(uint machine)
{
    if (dma_channel_is_busy(machine))
        return;
    finished_transfers[machine] += CHANNEL_TRANSFERS;
    dma_channel_set_trans_count(machine, CHANNEL_TRANSFERS, true);
}

static uint32_t word_at(uint machine, uint32_t position)
{
    return *(volatile uint32_t *)&rings[machine].words[position % RING_WORDS];
}

/* Where a ring was overrun, what is left begins behind a margin: DMA goes on while we read. */
static void skip_overrun(uint machine)
{
    uint32_t margin = RING_WORDS / 64U;
    if (heads[machine] - tails[machine] > RING_WORDS - margin)
        tails[machine] = heads[machine] - (RING_WORDS - margin);
}

void edge_tagger_look(void)
{
    pio1->irq = WAKING_FLAGS;
    pio_set_irq0_source_mask_enabled(pio1, WAKING_SOURCES, true);
    looked_at = cycle_clock_now();
    for (uint machine = MACHINES; machine-- > 0;) {
        keep_channel_going(machine);
        heads[machine] = words_of(machine);
        if (machine < FIRST_LEVEL_MACHINE)
            heads[machine] -= heads[machine] % WORDS_PER_PULSE;
        skip_overrun(machine);
    }
}

bool edge_tagger_has_news(void)
{
    for (uint machine = 0; machine < MACHINES; machine++)
        if (words_of(machine) != heads[machine])
            return true;
    /* A pulse of which one machine's tag was still on its way. */
    return tails[0] != heads[0] || tails[1] != heads[1];
}

/* --- time ------------------------------------------------------------------------------------- */

/* Cycles since start-up at which an edge was at the pad, from the word that tells its step. The
 * edge is less than 34 s away from the last look. */
static box_cycles_t time_of_step(uint32_t word, uint32_t extra_cycles)
{
    uint64_t now_steps = (looked_at - started_at) / 2;
    uint32_t step = ~word;
    int32_t back = (int32_t)(step - (uint32_t)now_steps);
    uint64_t steps = now_steps + (uint64_t)(int64_t)back;
    return started_at + 2 * steps + extra_cycles - STEP_TO_EDGE_CYCLES;
}

/* --- pulses ----------------------------------------------------------------------------------- */

typedef struct pulse_tag {
    bool seen;
    uint32_t number; /* of all edges that either machine saw */
    box_cycles_t time;
} pulse_tag_t;

/* The oldest pulse: which machines have a tag of it, and whether the other one missed its edge. */
typedef struct tag_choice {
    bool of[2];
    bool missed[2];
    edge_pulse_t pulse;
} tag_choice_t;

static pulse_tag_t peek_tag(uint machine)
{
    pulse_tag_t tag = {.seen = heads[machine] - tails[machine] >= WORDS_PER_PULSE};
    if (tag.seen) {
        tag.time = time_of_step(word_at(machine, tails[machine]), machine);
        tag.number = ~word_at(machine, tails[machine] + 1) + missed_edges[machine];
    }
    return tag;
}

static tag_choice_t choose_one(uint machine, const pulse_tag_t *tag, bool other_missed)
{
    tag_choice_t choice = {.pulse = {.number = tag->number, .time = tag->time}};
    choice.of[machine] = true;
    choice.missed[1U - machine] = other_missed;
    return choice;
}

/* Equal numbers are one pulse, unless a machine missed a low of one cycle that the other one saw.
 * Unequal ones come after an overrun. */
static tag_choice_t choose_of_two(const pulse_tag_t *first, const pulse_tag_t *second)
{
    int64_t apart = (int64_t)(first->time - second->time);
    if (first->number != second->number) {
        bool first_is_older = (int32_t)(first->number - second->number) < 0;
        return first_is_older ? choose_one(0, first, false) : choose_one(1, second, false);
    }
    if (apart < -1)
        return choose_one(0, first, true);
    if (apart > 1)
        return choose_one(1, second, true);
    box_cycles_t time = apart < 0 ? first->time : second->time;
    return (tag_choice_t){.of = {true, true}, .pulse = {.number = first->number, .time = time}};
}

static tag_choice_t choose_tags(void)
{
    pulse_tag_t first = peek_tag(0);
    pulse_tag_t second = peek_tag(1);
    if (first.seen && second.seen)
        return choose_of_two(&first, &second);
    if (first.seen && looked_at > first.time + PARTNER_PATIENCE)
        return choose_one(0, &first, true);
    if (second.seen && looked_at > second.time + PARTNER_PATIENCE)
        return choose_one(1, &second, true);
    return (tag_choice_t){0};
}

bool edge_tagger_peek_pulse(edge_pulse_t *pulse)
{
    tag_choice_t choice = choose_tags();
    if (!choice.of[0] && !choice.of[1])
        return false;
    *pulse = choice.pulse;
    return true;
}

void edge_tagger_drop_pulse(void)
{
    tag_choice_t choice = choose_tags();
    for (uint machine = 0; machine < 2; machine++) {
        if (choice.of[machine])
            tails[machine] += WORDS_PER_PULSE;
        if (choice.missed[machine])
            missed_edges[machine]++;
    }
}

/* --- levels ----------------------------------------------------------------------------------- */

/* A machine that found its FIFO full stood still until there was room. */
static bool stood_still(uint machine)
{
    return (pio1->fdebug & (1U << (PIO_FDEBUG_RXSTALL_LSB + machine))) != 0;
}

bool edge_tagger_is_outrun(void)
{
    return outrun[EDGE_LINE_START] || outrun[EDGE_LINE_STROBE];
}

bool edge_tagger_peek_level(edge_line_t line, edge_level_t *edge)
{
    uint machine = FIRST_LEVEL_MACHINE + (uint)line;
    outrun[line] = outrun[line] || stood_still(machine);
    if (outrun[line])
        tails[machine] = heads[machine];
    if (heads[machine] == tails[machine])
        return false;
    /* Rises and falls alternate from start-up on, and the ring has room for an even number. */
    edge->rise = tails[machine] % 2 == 0;
    edge->time = time_of_step(word_at(machine, tails[machine]), 0);
    return true;
}

void edge_tagger_drop_level(edge_line_t line)
{
    tails[FIRST_LEVEL_MACHINE + (uint)line]++;
}

/* --- start ------------------------------------------------------------------------------------ */

/* Only wakes the CPU. It is heard again after the next look, so that noise on a line cannot keep
 * the main loop from its work. */
static void on_edge(void)
{
    pio_set_irq0_source_mask_enabled(pio1, WAKING_SOURCES, false);
}

/* Every machine begins with nothing counted and nothing in its ring. */
static void init_machine(uint machine, pio_sm_config *config, uint pin, uint begin)
{
    sm_config_set_jmp_pin(config, pin);
    sm_config_set_in_shift(config, false, true, 32);
    sm_config_set_fifo_join(config, PIO_FIFO_JOIN_RX);
    pio_sm_init(pio1, machine, begin, config);
    pio_sm_exec(pio1, machine, pio_encode_mov_not(pio_x, pio_null));
    pio_sm_exec(pio1, machine, pio_encode_mov_not(pio_y, pio_null));
    start_channel(machine);
}

/* All machines start in one cycle, soon after the timer's tick. */
static void start_machines(void)
{
    uint32_t status = save_and_disable_interrupts();
    uint32_t us = timer_hw->timerawl;
    while (timer_hw->timerawl == us)
        tight_loop_contents();
    pio_enable_sm_mask_in_sync(pio1, (1U << MACHINES) - 1U);
    started_at = cycle_clock_now() + START_LATENCY_CYCLES;
    restore_interrupts(status);
}

static uint pulse_at, level_at; /* the programs */

static void init_machines(void)
{
    pio_sm_config pulse = pulse_tagger_program_get_default_config(pulse_at);
    pio_sm_config level = level_tagger_program_get_default_config(level_at);
    init_machine(0, &pulse, PIN_TRIG, pulse_at + pulse_tagger_offset_begin);
    init_machine(1, &pulse, PIN_TRIG, pulse_at + pulse_tagger_offset_skew);
    init_machine(FIRST_LEVEL_MACHINE + EDGE_LINE_START, &level, PIN_START,
                 level_at + level_tagger_offset_begin);
    init_machine(FIRST_LEVEL_MACHINE + EDGE_LINE_STROBE, &level, PIN_STROBE,
                 level_at + level_tagger_offset_begin);
}

void edge_tagger_init(void)
{
    pulse_at = (uint)pio_add_program(pio1, &pulse_tagger_program);
    level_at = (uint)pio_add_program(pio1, &level_tagger_program);
    init_machines();
    start_machines();
    irq_set_exclusive_handler(PIO1_IRQ_0, on_edge);
    irq_set_enabled(PIO1_IRQ_0, true);
}

void edge_tagger_restart(void)
{
    pio_set_sm_mask_enabled(pio1, (1U << MACHINES) - 1U, false);
    for (uint machine = 0; machine < MACHINES; machine++) {
        dma_channel_abort(machine);
        finished_transfers[machine] = 0;
        heads[machine] = 0;
        tails[machine] = 0;
    }
    missed_edges[0] = missed_edges[1] = 0;
    outrun[EDGE_LINE_START] = outrun[EDGE_LINE_STROBE] = false;
    init_machines();
    start_machines();
}
