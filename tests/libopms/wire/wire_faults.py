# SPDX-License-Identifier: Apache-2.0
"""Reports that must be refused, and why: good ones with one thing wrong, the CRC made good again
where it is not the fault."""
from wire_layouts import LAYOUTS, crc16, seal, write
from wire_samples import (CUT, MISSING, NOT_HELD, PREAMBLE, RUN, STROBE, box_time, entry, history,
                          samples, setting, trigger)


def first_sample(kind):
    return next(iter(samples(kind)))[1]


def with_bytes(kind, changes):
    report = bytearray(write(kind, first_sample(kind)))
    for at, value in changes.items():
        report[at] = value
    return seal(report)


def frame_faults():
    for kind in LAYOUTS:
        good = write(kind, first_sample(kind))
        yield kind, "nothing at all", "LENGTH", b""
        yield kind, "one byte short", "LENGTH", good[:-1]
        yield kind, "one byte too long", "LENGTH", good + b"\0"
        yield kind, "an unknown id", "ID", with_bytes(kind, {0: 0x7F})
        yield kind, "id 0", "ID", with_bytes(kind, {0: 0})
        yield kind, "protocol version 0", "VERSION", with_bytes(kind, {1: 0})
        yield kind, "protocol version 2", "VERSION", with_bytes(kind, {1: 2})
        yield kind, "an inverted CRC", "CRC", good[:62] + bytes(b ^ 0xFF for b in good[62:])
        yield kind, "a CRC with its bytes swapped", "CRC", good[:62] + good[:61:-1]
        yield kind, "one bit of the last byte before the CRC", "CRC", (
            good[:61] + bytes([good[61] ^ 0x80]) + good[62:])
    yield "trigger", "another report's id", "ID", write("pong", first_sample("pong"))
    yield "pong", "another report's id", "ID", write("trigger", first_sample("trigger"))


# kind: {what is wrong: changes to the first sample's fields}
FIELDS = {
    "pong": {"boot id 0": {"boot_id": 0}, "cycles of 125": {"received": box_time(1, 125)},
             "cycles of 255": {"sent": box_time(1, 255)}},
    "status": {"state 5": {"state": 5}, "reset cause 5": {"reset_cause": 5},
               "boot id 0": {"boot_id": 0}},
    "event": {"kind 0": {"kind": 0}, "kind 13": {"kind": 13}, "state 5": {"state": 5},
              "boot id 0": {"boot_id": 0}, "cycles of 125": {"time": box_time(1, 125)}},
    "command": {"opcode 0": {"opcode": 0}, "opcode 4": {"opcode": 4},
                "arm with session 0": {"opcode": 2, "argument": 0},
                "disarm with an argument": {"opcode": 3, "argument": 1}},
    "identity": {"boot id 0": {"boot_id": 0}, "a clock of 0 Hz": {"clock_hz": 0},
                 "an unknown capability": {"capabilities": 16},
                 "a capital in the hash": {"git_hash": "0123456789ABCDEF0123"},
                 "a hash that is too short": {"git_hash": "0123456789abcdef"},
                 "no hexadecimal digit": {"git_hash": "0123456789abcdeg0123"}},
    "history_request": {"token 0": {"token": 0}, "session 0": {"session_id": 0},
                        "first number 0": {"first_number": 0}, "count 0": {"count": 0},
                        "count 8193": {"count": 8193}},
}

TRIGGERS = {
    "neither of preamble nor of run": {"flags": 0},
    "of preamble and run": {"flags": PREAMBLE | RUN},
    "a cut preamble before the run": {"flags": PREAMBLE | CUT},
    "not held": {"flags": NOT_HELD},
    "held and not held": {"flags": RUN | NOT_HELD},
    "a reserved flag": {"flags": RUN | 0x80},
    "a reserved flag in the high byte": {"flags": RUN | 0x8000},
    "boot id 0": {"boot_id": 0},
    "session 0": {"session_id": 0},
    "cycles of 125": {"time": box_time(1, 125)},
    "cycles of 125 in the start edge": {"start_edge": box_time(1, 125)},
    "an exposure's number without its flag": {"strobe_for_trigger": 1},
    "an exposure's start without its flag": {"strobe_delay_cycles": 1},
    "an exposure's length without its flag": {"strobe_length_cycles": 1},
}

SETTINGS = {
    "a period of 9,999 us": {"period_us": 9_999, "width_us": 10},
    "a period of 10,000,001 us": {"period_us": 10_000_001},
    "a width of 9 us": {"width_us": 9},
    "a width of all but 999 us": {"width_us": 99_001},
    "a debounce of 1,250,001 cycles": {"debounce_cycles": 1_250_001},
    "SYNC 3": {"sync": 3},
    "a gap of 9 ms": {"preamble_gap_ms": [9] + [0] * 7},
    "a gap of 10,001 ms": {"preamble_gap_ms": [100, 10_001] + [0] * 6},
    "a gap after the end": {"preamble_gap_ms": [100, 0, 100] + [0] * 5},
    "a gap at the very end": {"preamble_gap_ms": [0] * 7 + [100]},
    "a gap shorter than a pulse and its rest": {"width_us": 99_000,
                                                "preamble_gap_ms": [99] + [0] * 7},
}

HISTORIES = {
    "boot id 0": history([], boot_id=0),
    "count 3": history([], count=3),
    "count 255": history([], count=255),
    "entries that follow an empty report": history([], remaining=1),
    "more than all entries": history([entry(7, RUN, 1)], remaining=8192),
    "a first number without an entry": history([entry(7, RUN, 1)], count=0),
    "an entry beyond the count": history([entry(7, RUN, 1), entry(8, RUN, 2)], count=1),
    "flags 0": history([entry(7, 0, 1)]),
    "not held, with a time": history([entry(7, NOT_HELD, 1)]),
    "not held, with cycles": history([entry(7, NOT_HELD, 0, 1)]),
    "not held, with an exposure": history([entry(7, NOT_HELD, 0, 0, 1)]),
    "not held, and of the run": history([entry(7, NOT_HELD | RUN)]),
    "missing strobe with not held": history([entry(7, NOT_HELD | MISSING)]),
    "a reserved flag": history([entry(7, RUN | 0x100, 1)]),
    "cycles of 125": history([entry(7, RUN, 1, 125)]),
    "an exposure without its flag": history([entry(7, RUN, 1, 1, 0, 5)]),
    "a fault in the second entry": history([entry(7, RUN | STROBE, 1), entry(8, RUN | CUT | 1)]),
}

BYTES = {
    "settings": {"refusal 10": {2: 10}, "a reserved flag": {3: 4}, "a reserved line flag": {16: 16},
                 "a settings CRC that is not that of the settings": {36: 0}},
    "settings_set": {"a result": {2: 1}, "a flag of the box": {3: 1}, "a reserved line flag":
                     {16: 0x80}, "a settings CRC": {36: 1}},
    "identity": {"another magic": {7: ord("s")}, "a reserved flag": {13: 2}},
    "bootloader": {"no magic word": dict.fromkeys(range(4, 8), 0), "a bit of the magic word":
                   {4: 0x1E}},
}


def value_faults():
    for kind, faults in FIELDS.items():
        for name, changes in faults.items():
            yield kind, name, "VALUE", write(kind, {**first_sample(kind), **changes})
    for name, changes in TRIGGERS.items():
        yield "trigger", name, "VALUE", write("trigger", trigger(**changes))
    for name, changes in SETTINGS.items():
        bad = setting(**changes)
        yield "settings_set", name, "VALUE", write("settings_set", bad)
        crc = crc16(write("settings_set", bad)[4:36])
        yield "settings", name, "VALUE", write(
            "settings", {**first_sample("settings"), "settings": bad, "settings_crc": crc})
    for name, fields in HISTORIES.items():
        yield "history", name, "VALUE", write("history", fields)
    for kind, faults in BYTES.items():
        for name, changes in faults.items():
            yield kind, name, "VALUE", with_bytes(kind, changes)


def faults():
    """(kind, name, result, bytes)."""
    yield from frame_faults()
    yield from value_faults()
