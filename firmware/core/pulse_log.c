/* SPDX-License-Identifier: Apache-2.0 */
#include "pulse_log.h"

#define FLAGS_SHIFT 56
#define TIME_MASK ((UINT64_C(1) << FLAGS_SHIFT) - 1)
#define GAP_MAX_US 0xFFFFFFU /* three bytes of the TRIGGER report */

static pulse_entry_t *slot(pulse_log_t *log, uint32_t number)
{
    return &log->entries[number % OPMS_BOX_HISTORY_ENTRIES];
}

static const pulse_entry_t *entry_of(const pulse_log_t *log, uint32_t number)
{
    return &log->entries[number % OPMS_BOX_HISTORY_ENTRIES];
}

static void put(pulse_log_t *log, uint32_t number, box_cycles_t time, uint8_t flags)
{
    pulse_entry_t *entry = slot(log, number);
    entry->time_and_flags = (time & TIME_MASK) | ((uint64_t)flags << FLAGS_SHIFT);
    entry->strobe_delay_cycles = 0;
    entry->strobe_length_cycles = 0;
}

void pulse_log_clear(pulse_log_t *log)
{
    log->last = 0;
    log->first = 1;
}

/* A skipped pulse gets its neighbour's time, so that times in the log never fall. */
static void put_skipped(pulse_log_t *log, uint32_t from, uint32_t to, box_cycles_t time)
{
    if (to - from > OPMS_BOX_HISTORY_ENTRIES)
        from = to - OPMS_BOX_HISTORY_ENTRIES;
    for (uint32_t number = from; number != to; number++)
        put(log, number, time, OPMS_TRIGGER_NOT_HELD);
}

uint32_t pulse_log_add(pulse_log_t *log, uint32_t number, box_cycles_t time, uint8_t flags)
{
    uint32_t skipped = number - log->last - 1;
    if (skipped != 0)
        put_skipped(log, log->last + 1, number, time);
    put(log, number, time, flags);
    log->last = number;
    if (number - log->first >= OPMS_BOX_HISTORY_ENTRIES)
        log->first = number - OPMS_BOX_HISTORY_ENTRIES + 1;
    return skipped;
}

static bool is_empty(const pulse_log_t *log)
{
    return log->first == log->last + 1;
}

static bool is_in_range(const pulse_log_t *log, uint32_t number)
{
    return !is_empty(log) && number - log->first <= log->last - log->first;
}

bool pulse_log_holds(const pulse_log_t *log, uint32_t number)
{
    return is_in_range(log, number) &&
           (pulse_log_flags(log, number) & OPMS_TRIGGER_NOT_HELD) == 0;
}

box_cycles_t pulse_log_time(const pulse_log_t *log, uint32_t number)
{
    return entry_of(log, number)->time_and_flags & TIME_MASK;
}

uint8_t pulse_log_flags(const pulse_log_t *log, uint32_t number)
{
    return (uint8_t)(entry_of(log, number)->time_and_flags >> FLAGS_SHIFT);
}

void pulse_log_set_flags(pulse_log_t *log, uint32_t number, uint8_t flags)
{
    slot(log, number)->time_and_flags |= (uint64_t)flags << FLAGS_SHIFT;
}

void pulse_log_set_strobe(pulse_log_t *log, uint32_t number, uint32_t delay_cycles,
                          uint32_t length_cycles)
{
    pulse_entry_t *entry = slot(log, number);
    entry->strobe_delay_cycles = delay_cycles;
    entry->strobe_length_cycles = length_cycles;
    pulse_log_set_flags(log, number, OPMS_TRIGGER_STROBE);
}

uint32_t pulse_log_before(const pulse_log_t *log, box_cycles_t time)
{
    if (is_empty(log) || pulse_log_time(log, log->first) > time)
        return 0;
    /* Times rise with the numbers: halve the range until one is left. */
    uint32_t offset = 0, length = log->last - log->first + 1;
    while (length > 1) {
        uint32_t half = length / 2;
        if (pulse_log_time(log, log->first + offset + half) <= time)
            offset += half;
        length -= half;
    }
    uint32_t number = log->first + offset;
    return pulse_log_holds(log, number) ? number : 0;
}

uint32_t pulse_log_gap_us(const pulse_log_t *log, uint32_t number, uint32_t back)
{
    uint32_t later = number - back, earlier = later - 1;
    if (!pulse_log_holds(log, later) || !pulse_log_holds(log, earlier))
        return 0;
    /* Of the whole us of both, so that the earlier time is found again without a rest. */
    uint64_t gap = pulse_log_time(log, later) / OPMS_BOX_CYCLES_PER_US -
                   pulse_log_time(log, earlier) / OPMS_BOX_CYCLES_PER_US;
    return gap <= GAP_MAX_US ? (uint32_t)gap : 0;
}

void pulse_log_read(const pulse_log_t *log, uint32_t number, opms_history_entry_t *entry)
{
    *entry = (opms_history_entry_t){.number = number, .flags = OPMS_TRIGGER_NOT_HELD};
    if (!pulse_log_holds(log, number))
        return;
    entry->flags = pulse_log_flags(log, number);
    entry->time = box_time_of(pulse_log_time(log, number));
    entry->strobe_delay_cycles = entry_of(log, number)->strobe_delay_cycles;
    entry->strobe_length_cycles = entry_of(log, number)->strobe_length_cycles;
}
