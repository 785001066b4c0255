# SPDX-License-Identifier: Apache-2.0
"""Fields of reports worth checking: ordinary ones, borders, and seeded random ones.

64-bit numbers are decimal strings, because JSON readers in JavaScript would round them.
"""
import random
import struct

from wire_layouts import crc16, write

U16, U24, U32, U64 = 2**16 - 1, 2**24 - 1, 2**32 - 1, 2**64 - 1
PREAMBLE, RUN, CUT, STROBE, MISSING, DELAYED, NOT_HELD = (1 << i for i in range(7))


def box_time(us, cycles=0):
    return {"us": str(us), "cycles": cycles}


def trigger(**changes):
    return {
        "flags": RUN, "boot_id": 0x1B2C3D4E, "session_id": 0x5F607182, "report_number": 17,
        "trigger_number": 9, "time": box_time(1_300_001, 4), "start_edge": box_time(1_000_000, 4),
        "first_run_number": 6, "strobe_for_trigger": 0, "strobe_delay_cycles": 0,
        "strobe_length_cycles": 0, "gap_us": [100_000, 100_000], "dropped": 0, **changes,
    }


def triggers(draw):
    before = {"start_edge": box_time(0), "first_run_number": 0}
    yield "a pulse of the run", trigger()
    yield "the first pulse after arming", trigger(
        flags=PREAMBLE, trigger_number=1, gap_us=[0, 0], **before)
    yield "the preamble was cut", trigger(flags=RUN | CUT, trigger_number=4, first_run_number=3)
    yield "with the last completed exposure", trigger(
        flags=RUN | STROBE, strobe_for_trigger=8, strobe_delay_cycles=1875,
        strobe_length_cycles=1_000_000)
    yield "an exposure is missing, the report is late", trigger(flags=RUN | MISSING | DELAYED)
    yield "every field at its largest", trigger(
        flags=RUN | CUT | STROBE | MISSING | DELAYED, boot_id=U32, session_id=U32,
        report_number=U32, trigger_number=U32, time=box_time(U64, 124),
        start_edge=box_time(U64, 124), first_run_number=U32, strobe_for_trigger=U32,
        strobe_delay_cycles=U32, strobe_length_cycles=U32, gap_us=[U24, U24], dropped=U16)
    yield "numbers that have wrapped to 0", trigger(report_number=0, trigger_number=0)
    for i in range(8):
        yield f"random {i}", trigger(
            flags=draw.choice((PREAMBLE, RUN, RUN | CUT)) | STROBE | draw.choice((0, DELAYED)),
            boot_id=draw.randint(1, U32), session_id=draw.randint(1, U32),
            report_number=draw.randint(0, U32), trigger_number=draw.randint(0, U32),
            time=box_time(draw.randint(0, U64), draw.randint(0, 124)),
            start_edge=box_time(draw.randint(0, U64), draw.randint(0, 124)),
            first_run_number=draw.randint(0, U32), strobe_for_trigger=draw.randint(0, U32),
            strobe_delay_cycles=draw.randint(0, U32), strobe_length_cycles=draw.randint(0, U32),
            gap_us=[draw.randint(0, U24), draw.randint(0, U24)], dropped=draw.randint(0, U16))


def pongs(draw):
    yield "an answer after 52 us", {
        "boot_id": 0x1B2C3D4E, "report_number": 3, "ping_id": 77,
        "received": box_time(5_000_000, 11), "sent": box_time(5_000_052, 120)}
    yield "every field at its largest", {
        "boot_id": U32, "report_number": U32, "ping_id": U32, "received": box_time(U64, 124),
        "sent": box_time(U64, 124)}
    for i in range(4):
        yield f"random {i}", {
            "boot_id": draw.randint(1, U32), "report_number": draw.randint(0, U32),
            "ping_id": draw.randint(0, U32),
            "received": box_time(draw.randint(0, U64), draw.randint(0, 124)),
            "sent": box_time(draw.randint(0, U64), draw.randint(0, 124))}


STATUS_COUNTERS = ("report_number", "trigger_number", "first_run_number", "glitches",
                   "starts_refused", "strobes_missing", "dropped", "commands_refused")


def statuses(draw):
    idle = {"state": 0, "reset_cause": 1, "boot_id": 0x1B2C3D4E, "session_id": 0,
            "uptime_us": "1000000", **dict.fromkeys(STATUS_COUNTERS, 0),
            "reenumerations": 0, "settings_crc": 0x4C0E}
    yield "idle, one second after power-on", {**idle, "report_number": 1}
    yield "after a bite of the watchdog", {**idle, "reset_cause": 3}
    yield "every field at its largest", {
        "state": 4, "reset_cause": 4, "boot_id": U32, "session_id": U32, "uptime_us": str(U64),
        **dict.fromkeys(STATUS_COUNTERS, U32), "reenumerations": U16, "settings_crc": U16}
    for i in range(5):
        yield f"random {i}", {
            "state": i, "reset_cause": 4 - i, "boot_id": draw.randint(1, U32),
            "session_id": draw.randint(0, U32), "uptime_us": str(draw.randint(0, U64)),
            **{name: draw.randint(0, U32) for name in STATUS_COUNTERS},
            "reenumerations": draw.randint(0, U16), "settings_crc": draw.randint(0, U16)}


def events(draw):
    for kind in range(1, 13):
        yield f"of kind {kind}", {
            "kind": kind, "state": kind % 5, "boot_id": draw.randint(1, U32),
            "session_id": draw.randint(0, U32), "report_number": draw.randint(0, U32),
            "event_number": draw.randint(0, U32),
            "time": box_time(draw.randint(0, U64), draw.randint(0, 124)),
            "argument": draw.randint(0, U32), "detail": draw.randint(0, 9)}
    yield "every field at its largest", {
        "kind": 12, "state": 4, "boot_id": U32, "session_id": U32, "report_number": U32,
        "event_number": U32, "time": box_time(U64, 124), "argument": U32, "detail": U32}


def commands(_):
    yield "ping", {"opcode": 1, "argument": 0xA1B2C3D4}
    yield "ping 0", {"opcode": 1, "argument": 0}
    yield "arm", {"opcode": 2, "argument": 0x5F607182}
    yield "disarm", {"opcode": 3, "argument": 0}


def identities(draw):
    usual = {"hardware_version": 1, "firmware_version": [0, 2, 0], "firmware_modified": False,
             "capabilities": 15, "unique_id": [0xE6, 0x61, 0x64, 0x08, 0x43, 0x2F, 0x5B, 0x21],
             "git_hash": "0123456789abcdef0123", "boot_id": 0x1B2C3D4E, "clock_hz": 125_000_000,
             "start_cycles": 4, "ring_entries": 1024, "history_entries": 8192}
    yield "a usual box", usual
    yield "built from a changed tree", {**usual, "firmware_modified": True}
    yield "every field at its largest", {
        "hardware_version": U16, "firmware_version": [255] * 3, "firmware_modified": True,
        "capabilities": 15, "unique_id": [255] * 8, "git_hash": "f" * 20, "boot_id": U32,
        "clock_hz": U32, "start_cycles": U16, "ring_entries": U16, "history_entries": U16}
    for i in range(4):
        yield f"random {i}", {
            "hardware_version": draw.randint(0, U16),
            "firmware_version": [draw.randint(0, 255) for _ in range(3)],
            "firmware_modified": bool(i % 2), "capabilities": draw.randint(0, 15),
            "unique_id": [draw.randint(0, 255) for _ in range(8)],
            "git_hash": f"{draw.getrandbits(80):020x}", "boot_id": draw.randint(1, U32),
            "clock_hz": draw.randint(1, U32), "start_cycles": draw.randint(0, U16),
            "ring_entries": draw.randint(0, U16), "history_entries": draw.randint(0, U16)}


def setting(**changes):
    return {"period_us": 100_000, "width_us": 1_000, "debounce_cycles": 125,
            "trig_active_low": False, "start_falling_edge": False, "strobe_enabled": False,
            "strobe_active_low": False, "sync": 0,
            "preamble_gap_ms": [100, 200, 100, 300, 100, 0, 0, 0], "wait_timeout_s": 0, **changes}


def settings_sets(draw):
    none = [0] * 8
    yield "the defaults", setting()
    yield "no preamble", setting(preamble_gap_ms=none)
    yield "the shortest period and its longest pulse", setting(
        period_us=10_000, width_us=9_000, debounce_cycles=0, preamble_gap_ms=[10, 11] + [10] * 6)
    yield "the longest of everything", setting(
        period_us=10_000_000, width_us=9_999_000, debounce_cycles=1_250_000, sync=2,
        trig_active_low=True, start_falling_edge=True, strobe_enabled=True,
        strobe_active_low=True, preamble_gap_ms=[10_000] * 8, wait_timeout_s=U16)
    yield "the shortest pulse", setting(width_us=10, sync=1)
    for bit, name in enumerate(("trig_active_low", "start_falling_edge", "strobe_enabled",
                                "strobe_active_low")):
        yield f"line flag {bit} alone", setting(**{name: True})
    for i in range(4):
        count = draw.randint(0, 8)
        yield f"random {i}", setting(
            period_us=draw.randint(10_000, 10_000_000), width_us=draw.randint(10, 9_000),
            debounce_cycles=draw.randint(0, 1_250_000), sync=draw.randint(0, 2),
            preamble_gap_ms=[draw.randint(10, 10_000) for _ in range(count)] + none[count:],
            wait_timeout_s=draw.randint(0, U16))


def settings(draw):
    for i, (name, fields) in enumerate(settings_sets(draw)):
        crc = crc16(write("settings_set", fields)[4:36])
        yield name, {"settings": fields, "last_set": i % 10, "pending": bool(i & 1),
                     "stored": bool(i & 2), "settings_crc": crc}


def history_requests(draw):
    yield "all of it", {"token": 0x1234, "session_id": 0x5F607182, "first_number": 1,
                        "count": 8192}
    yield "one pulse", {"token": 1, "session_id": 1, "first_number": U32, "count": 1}
    yield "every field at its largest", {"token": U16, "session_id": U32, "first_number": U32,
                                         "count": 8192}
    for i in range(3):
        yield f"random {i}", {
            "token": draw.randint(1, U16), "session_id": draw.randint(1, U32),
            "first_number": draw.randint(1, U32), "count": draw.randint(1, 8192)}


def entry(number, flags, us=0, cycles=0, delay=0, length=0):
    return {"number": number, "flags": flags, "time": box_time(us, cycles),
            "strobe_delay_cycles": delay, "strobe_length_cycles": length}


def history(entries, **changes):
    return {"token": 0x1234, "boot_id": 0x1B2C3D4E, "session_id": 0x5F607182, "remaining": 0,
            "count": len(entries), "entries": entries, **changes}


def histories(draw):
    yield "nothing was selected yet", history([], token=0, session_id=0)
    yield "the end of a selection", history([])
    yield "one entry, the last", history([entry(7, RUN, 2_000_000, 3)])
    yield "two entries with their exposures", history(
        [entry(7, RUN | STROBE, 2_000_000, 3, 1875, 1_000_000),
         entry(8, RUN | STROBE, 2_100_000, 3, 1880, 1_000_001)], remaining=8190)
    yield "hours between preamble and run", history(
        [entry(6, PREAMBLE, 800_000), entry(7, RUN, 86_400_000_000, 9)], remaining=2)
    yield "too old, and held", history([entry(7, NOT_HELD), entry(8, RUN, 2_100_000)])
    yield "a session that is not held", history(
        [entry(1, NOT_HELD), entry(2, NOT_HELD)], session_id=0, remaining=98)
    yield "numbers that wrap", history([entry(U32, RUN, 5, 5), entry(0, RUN, 10, 10)])
    yield "every field at its largest", history(
        [entry(n, 62, U64, 124, U32, U32) for n in (U32 - 1, U32)], token=U16, boot_id=U32,
        session_id=U32, remaining=8190)
    for i in range(4):
        first = draw.randint(0, U32 - 1)
        yield f"random {i}", history(
            [entry(first + k, RUN | STROBE, draw.randint(0, U64), draw.randint(0, 124),
                   draw.randint(0, U32), draw.randint(0, U32)) for k in range(1 + i % 2)],
            token=draw.randint(1, U16), boot_id=draw.randint(1, U32),
            session_id=draw.randint(1, U32), remaining=draw.randint(0, 8190))


SAMPLES = {
    "trigger": triggers, "pong": pongs, "status": statuses, "event": events, "command": commands,
    "identity": identities, "settings": settings, "settings_set": settings_sets,
    "history_request": history_requests, "history": histories,
    "bootloader": lambda _: [("with its magic word", {})],
}


def samples(kind):
    """Pairs of a name and fields; the same ones each time."""
    return SAMPLES[kind](random.Random(struct.unpack("<I", kind.encode()[:4])[0]))
