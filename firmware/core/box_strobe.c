/* SPDX-License-Identifier: Apache-2.0 */
/* Exposures, as the camera's strobe output shows them: of which pulse, and which are missing. */
#include "box_internal.h"

static void tell_missing(box_t *box, uint32_t number, box_cycles_t now)
{
    if (!pulse_log_holds(&box->log, number) ||
        (pulse_log_flags(&box->log, number) & OPMS_TRIGGER_STROBE) != 0)
        return;
    pulse_log_set_flags(&box->log, number, OPMS_TRIGGER_STROBE_MISSING);
    box->strobes_missing++;
    box->strobe_missing_news = true;
    box_push_event(box, OPMS_EVENT_STROBE_MISSING, now, number, 0);
}

/* Every pulse up to `number` has its exposure by now, or has none. */
static void settle_up_to(box_t *box, uint32_t number, box_cycles_t now)
{
    uint32_t unsettled = number - box->strobe_checked;
    if (unsettled > UINT32_MAX / 2)
        return; /* a later exposure has settled it */
    if (unsettled > OPMS_BOX_HISTORY_ENTRIES)
        box->strobe_checked = number - OPMS_BOX_HISTORY_ENTRIES;
    while (box->strobe_checked != number)
        tell_missing(box, ++box->strobe_checked, now);
}

void box_note_strobe(box_t *box, box_cycles_t rise, uint32_t length_cycles)
{
    if (!box->settings.strobe_enabled)
        return;
    uint32_t number = pulse_log_before(&box->log, rise);
    /* Only the first exposure after a pulse is the pulse's; none is before the first pulse, and
     * one that was told missing stays so: reports have gone out with it. */
    if (number == 0 || number - box->strobe_checked - 1 >= UINT32_MAX / 2)
        return;
    box_cycles_t delay = rise - pulse_log_time(&box->log, number);
    if (delay > UINT32_MAX)
        return;
    pulse_log_set_strobe(&box->log, number, (uint32_t)delay, length_cycles);
    box->strobe_number = number;
    settle_up_to(box, number, rise);
}

void box_check_strobes(box_t *box, uint32_t newest, box_cycles_t now)
{
    /* An exposure may last until the next pulse, so it is overdue at the one after that. */
    if (box->settings.strobe_enabled && newest >= 3)
        settle_up_to(box, newest - 2, now);
}
