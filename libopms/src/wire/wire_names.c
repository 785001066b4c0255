/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Words for people. */
#include <opms/wire.h>

/* The values of each enum are consecutive; tables of another length do not compile. */
#define TABLE_ENDS_AT(table, last)                                                                 \
    _Static_assert(sizeof(table) / sizeof((table)[0]) == (size_t)(last) + 1, "one name each")

static const char *const result_names[] = {
    "OK",      "wrong length",       "wrong report id", "another protocol version",
    "bad CRC", "value out of range",
};
TABLE_ENDS_AT(result_names, OPMS_WIRE_VALUE);

static const char *const refusal_names[] = {
    "not refused",
    "not in this state",
    "wrong length",
    "wrong report id",
    "another protocol version",
    "bad CRC",
    "value out of range",
    "no magic word",
    "flash did not keep it",
    "busy with the one before",
};
TABLE_ENDS_AT(refusal_names, OPMS_REFUSAL_BUSY);

static const char *const state_names[] = {"IDLE", "ARMED", "PREAMBLE", "WAITING", "RUNNING"};
TABLE_ENDS_AT(state_names, OPMS_BOX_RUNNING);

static const char *const event_names[] = {
    "unknown", /* there is no kind 0 */
    "armed",        "waiting",       "start",           "stop",
    "glitch",       "start refused", "preamble cut",    "strobe missing",
    "wait timeout", "refused",       "settings stored", "endpoint healed",
};
TABLE_ENDS_AT(event_names, OPMS_EVENT_ENDPOINT_HEALED);

static const char *name_of(const char *const *names, size_t count, unsigned value)
{
    return value < count ? names[value] : "unknown";
}

#define NAME_OF(names, value) name_of(names, sizeof(names) / sizeof((names)[0]), (unsigned)(value))

const char *opms_wire_result_name(opms_wire_result_t result)
{
    return NAME_OF(result_names, result);
}

const char *opms_refusal_name(opms_refusal_t refusal)
{
    return NAME_OF(refusal_names, refusal);
}

const char *opms_box_state_name(opms_box_state_t state)
{
    return NAME_OF(state_names, state);
}

const char *opms_event_name(opms_event_kind_t kind)
{
    return NAME_OF(event_names, kind);
}
