/* SPDX-License-Identifier: Apache-2.0 */
/* Events wait here until the host takes them. */
#include "box_internal.h"

void box_push_event(box_t *box, opms_event_kind_t kind, box_cycles_t time, uint32_t argument,
                    uint32_t detail)
{
    box->event_number++;
    if (box->events_in - box->events_out == BOX_EVENTS)
        return;
    opms_event_report_t *report = &box->events[box->events_in++ % BOX_EVENTS];
    *report = (opms_event_report_t){
        .kind = kind,
        .state = box->state,
        .boot_id = box->identity.report.boot_id,
        .session_id = box->session_id,
        .event_number = box->event_number,
        .time = box_time_of(time),
        .argument = argument,
        .detail = detail,
    };
}

void box_refuse(box_t *box, uint8_t report_id, uint32_t opcode, opms_refusal_t refusal,
                box_cycles_t now)
{
    box->commands_refused++;
    box_push_event(box, OPMS_EVENT_REFUSED, now, report_id + 256U * opcode, (uint32_t)refusal);
}
