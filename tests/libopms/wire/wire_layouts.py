# SPDX-License-Identifier: Apache-2.0
"""The reports of docs/wire.md as tables, and a writer that knows nothing of libopms.

A row is (offset, type, path of the field). Types: those of the struct module, "u24", "bit0" to
"bit7", "20s". A path names the field as opms/wire.h does.
"""
import binascii
import struct

SIZE = 64
PROTOCOL = 1

_SETTINGS = [
    (4, "I", "period_us"), (8, "I", "width_us"), (12, "I", "debounce_cycles"),
    (16, "bit0", "trig_active_low"), (16, "bit1", "start_falling_edge"),
    (16, "bit2", "strobe_enabled"), (16, "bit3", "strobe_active_low"),
    (17, "B", "sync"), (18, "H", "wait_timeout_s"),
    *((20 + 2 * i, "H", f"preamble_gap_ms.{i}") for i in range(8)),
]
_ENTRY = [(0, "Q", "time.us"), (8, "I", "strobe_delay_cycles"), (12, "I", "strobe_length_cycles"),
          (16, "B", "time.cycles"), (18, "H", "flags")]

# kind: (report id, constant bytes, rows)
LAYOUTS = {
    "trigger": (0x01, {}, [
        (2, "H", "flags"), (4, "I", "boot_id"), (8, "I", "session_id"), (12, "I", "report_number"),
        (16, "I", "trigger_number"), (20, "Q", "time.us"), (28, "Q", "start_edge.us"),
        (36, "B", "time.cycles"), (37, "B", "start_edge.cycles"), (38, "H", "dropped"),
        (40, "I", "first_run_number"), (44, "I", "strobe_for_trigger"),
        (48, "I", "strobe_delay_cycles"), (52, "I", "strobe_length_cycles"),
        (56, "u24", "gap_us.0"), (59, "u24", "gap_us.1"),
    ]),
    "pong": (0x02, {}, [
        (4, "I", "boot_id"), (8, "I", "report_number"), (12, "I", "ping_id"),
        (16, "Q", "received.us"), (24, "Q", "sent.us"), (32, "B", "received.cycles"),
        (33, "B", "sent.cycles"),
    ]),
    "status": (0x03, {}, [
        (2, "B", "state"), (3, "B", "reset_cause"), (4, "I", "boot_id"), (8, "I", "session_id"),
        (12, "I", "report_number"), (16, "Q", "uptime_us"), (24, "I", "trigger_number"),
        (28, "I", "first_run_number"), (32, "I", "glitches"), (36, "I", "starts_refused"),
        (40, "I", "strobes_missing"), (44, "I", "dropped"), (48, "I", "commands_refused"),
        (52, "H", "reenumerations"), (54, "H", "settings_crc"),
    ]),
    "event": (0x04, {}, [
        (2, "B", "kind"), (3, "B", "state"), (4, "I", "boot_id"), (8, "I", "session_id"),
        (12, "I", "report_number"), (16, "I", "event_number"), (20, "Q", "time.us"),
        (28, "B", "time.cycles"), (32, "I", "argument"), (36, "I", "detail"),
    ]),
    "command": (0x10, {}, [(2, "B", "opcode"), (4, "I", "argument")]),
    "identity": (0x20, {4: b"OPMS"}, [
        (2, "H", "capabilities"), (8, "H", "hardware_version"),
        *((10 + i, "B", f"firmware_version.{i}") for i in range(3)),
        (13, "bit0", "firmware_modified"), (14, "H", "start_cycles"),
        *((16 + i, "B", f"unique_id.{i}") for i in range(8)),
        (24, "20s", "git_hash"), (44, "I", "clock_hz"), (48, "H", "ring_entries"),
        (50, "H", "history_entries"), (52, "I", "boot_id"),
    ]),
    "settings": (0x21, {}, [
        (2, "B", "last_set"), (3, "bit0", "pending"), (3, "bit1", "stored"),
        *((at, kind, f"settings.{path}") for at, kind, path in _SETTINGS),
        (36, "H", "settings_crc"),
    ]),
    "settings_set": (0x21, {}, _SETTINGS),
    "history_request": (0x22, {}, [
        (2, "H", "token"), (4, "I", "session_id"), (8, "I", "first_number"), (12, "H", "count"),
    ]),
    "history": (0x22, {}, [
        (2, "H", "token"), (4, "I", "boot_id"), (8, "I", "session_id"),
        (12, "I", "entries.0.number"), (16, "H", "remaining"), (18, "B", "count"),
        *((20 * (i + 1) + at, kind, f"entries.{i}.{path}")
          for i in range(2) for at, kind, path in _ENTRY),
    ]),
    "bootloader": (0x23, {4: struct.pack("<I", 0xB0075E1F)}, []),
}


def crc16(data):
    """CRC-16/IBM-3740; crc_hqx has that polynomial, and takes the start value."""
    return binascii.crc_hqx(data, 0xFFFF)


def value_at(fields, path):
    """The value of a path such as "time.us"; a list that is shorter is filled up with 0."""
    for part in path.split("."):
        if part.isdigit():
            fields = fields[int(part)] if int(part) < len(fields) else {}
        elif fields == {}:
            return 0
        else:
            fields = fields[part]
    return 0 if fields == {} else fields


def size_of(kind):
    return 3 if kind == "u24" else 1 if kind.startswith("bit") else struct.calcsize(kind)


def reserved(name):
    """Offsets of the bytes that are 0 in every report of this kind."""
    _, constants, rows = LAYOUTS[name]
    used = {0, 1, 62, 63}
    for at, kind, _ in rows:
        used.update(range(at, at + size_of(kind)))
    for at, data in constants.items():
        used.update(range(at, at + len(data)))
    return sorted(set(range(SIZE)) - used)


def put(report, at, kind, value):
    if kind == "u24":
        report[at:at + 3] = struct.pack("<I", value)[:3]
    elif kind.startswith("bit"):
        report[at] |= int(value) << int(kind[3])
    elif kind == "20s":
        struct.pack_into("20s", report, at, value.encode("ascii"))
    else:
        struct.pack_into("<" + kind, report, at, int(value))


def seal(report):
    """Put the CRC of the bytes before it."""
    report[62:64] = struct.pack("<H", crc16(bytes(report[:62])))
    return bytes(report)


def write(name, fields):
    """The 64 bytes of a report."""
    report_id, constants, rows = LAYOUTS[name]
    report = bytearray(SIZE)
    report[0:2] = bytes([report_id, PROTOCOL])
    for at, data in constants.items():
        report[at:at + len(data)] = data
    for at, kind, path in rows:
        put(report, at, kind, value_at(fields, path))
    return seal(report)
