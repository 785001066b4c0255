/* SPDX-License-Identifier: Apache-2.0 */
#include "pair/intake.h"

#include "base/fail.h"
#include "pair/emit.h"
#include "pair/lock.h"
#include "pair/settle.h"

#define STAGE "pair"

opms_status_t pair_check_input(const opms_pairer_t *pairer, const void *input, const char *name,
                               opms_error_t *err)
{
    if (!pairer || !input) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL", pairer ? name : "pairer");
    }
    if (!pair_has_room(pairer, 2 * (pairer->jump_max + 2))) {
        return opms_fail(err, OPMS_ERR_CAPACITY, STAGE, -1,
                         "%u results wait: poll them before the next input",
                         (unsigned)pairer->results.count);
    }
    return OPMS_OK;
}

opms_status_t pair_check_time(int64_t host_ns, const char *name, opms_error_t *err)
{
    if (host_ns < 0 || host_ns >= PAIR_TIME_LIMIT_NS) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "%s is %lld: no time of a monotonic clock in nanoseconds", name,
                         (long long)host_ns);
    }
    return OPMS_OK;
}

void pair_set_now(opms_pairer_t *pairer, int64_t now_host_ns)
{
    if (now_host_ns > pairer->now_host_ns) {
        pairer->now_host_ns = now_host_ns;
    }
}

void pair_see_other_boot(opms_pairer_t *pairer)
{
    pairer->counters.boots_seen += !pairer->ended;
    pairer->ended = 1;
}

int pair_is_ours(opms_pairer_t *pairer, uint32_t boot_id, uint32_t session_id)
{
    if (pairer->state != OPMS_PAIR_CLOSED && boot_id == pairer->boot_id &&
        session_id == pairer->session_id) {
        return 1;
    }
    ++pairer->counters.reports_foreign;
    if (pairer->state != OPMS_PAIR_CLOSED && boot_id != pairer->boot_id) {
        pair_see_other_boot(pairer);
    }
    return 0;
}

void pair_go_on(opms_pairer_t *pairer, int64_t now_host_ns)
{
    pair_set_now(pairer, now_host_ns);
    if (pairer->state == OPMS_PAIR_CLOSED) {
        return;
    }
    pair_settle_waiting(pairer);
    pair_seek_lock(pairer);
    pair_settle_expired(pairer, 0);
}

/** Add one trigger; the oldest one makes room for it. */
static void add_trigger(opms_pairer_t *pairer)
{
    pair_ring_t *ring = &pairer->triggers;
    if (ring->next - ring->open > ring->mask) {
        pair_settle_oldest_trigger(pairer);
    }
    pair_ring_add(ring, pairer->now_host_ns);
    ++pairer->counters.triggers;
}

int pair_extend_triggers(opms_pairer_t *pairer, int64_t number)
{
    pair_ring_t *ring = &pairer->triggers;
    if (number < ring->first) {
        return 0;
    }
    const int64_t jump = number + 1 - ring->next;
    if (jump > (int64_t)pairer->jump_max) {
        /* More than are held: those in between are lost for good, and told so. */
        pair_settle_expired(pairer, 1);
        const int64_t lost = jump - (int64_t)pairer->jump_max;
        pair_emit_lost(pairer, ring->next, (uint32_t)lost);
        pairer->counters.triggers += (uint64_t)lost;
        for (int64_t n = ring->next; n < ring->next + lost && n <= ring->next + ring->mask; ++n) {
            ring->slots[n & ring->mask] = (pair_trigger_t){.state = OPMS_TRIGGER_UNCERTAIN};
        }
        ring->next += lost;
        ring->open = ring->next;
    }
    while (ring->next <= number) {
        add_trigger(pairer);
    }
    return 1;
}
