# SPDX-License-Identifier: Apache-2.0
"""Reports of the trigger box, written from docs/wire.md alone: shares nothing with the library."""
import binascii
import struct

PROTOCOL = 1
TRIGGER, PONG, STATUS, EVENT = 0x01, 0x02, 0x03, 0x04
COMMAND, IDENTITY, SETTINGS, HISTORY, BOOTLOADER = 0x10, 0x20, 0x21, 0x22, 0x23
IDLE, ARMED, PREAMBLE, WAITING, RUNNING = range(5)
PING, ARM, DISARM = 1, 2, 3
PREAMBLE_FLAG, RUN_FLAG, NOT_HELD_FLAG = 1 << 0, 1 << 1, 1 << 6
EVENT_ARMED, EVENT_WAITING, EVENT_START, EVENT_STOP = 1, 2, 3, 4
EVENT_GLITCH, EVENT_REFUSED, EVENT_SETTINGS_STORED = 5, 10, 11
REFUSED_STATE, REFUSED_VALUE = 1, 6
MAGIC_BOOTLOADER = 0xB0075E1F
DEFAULT_SETTINGS = struct.pack("<IIIBBH8H", 100000, 1000, 125, 0, 0, 0,
                               100, 200, 100, 300, 100, 0, 0, 0)


def crc16(data):
    return binascii.crc_hqx(data, 0xFFFF)


def seal(report_id, fields, version=PROTOCOL):
    """64 bytes from {offset: bytes}: id, version and CRC around them."""
    body = bytearray(62)
    body[0], body[1] = report_id, version
    for offset, data in fields.items():
        body[offset:offset + len(data)] = data
    return bytes(body) + struct.pack("<H", crc16(bytes(body)))


def reads(report, report_id):
    """Are id, length, version and CRC those of a good report?"""
    return (len(report) == 64 and report[0] == report_id and report[1] == PROTOCOL
            and crc16(report[:62]) == struct.unpack_from("<H", report, 62)[0])


def trigger(boot, session, report_number, number, time_ns, flags=RUN_FLAG, start_ns=0, first_run=0,
            gaps=(0, 0)):
    return seal(TRIGGER, {
        2: struct.pack("<HIIII", flags, boot, session, report_number, number & 0xFFFFFFFF),
        20: struct.pack("<QQBB", time_ns // 1000, start_ns // 1000, time_ns % 1000 // 8,
                        start_ns % 1000 // 8),
        40: struct.pack("<I", first_run),
        56: struct.pack("<I", gaps[0])[:3] + struct.pack("<I", gaps[1])[:3]})


def pong(boot, report_number, ping_id, received_ns, sent_ns):
    return seal(PONG, {4: struct.pack("<IIIQQBB", boot, report_number, ping_id, received_ns // 1000,
                                      sent_ns // 1000, received_ns % 1000 // 8,
                                      sent_ns % 1000 // 8)})


def status(boot, session, report_number, state=IDLE, uptime_us=0, number=0, first_run=0,
           settings=DEFAULT_SETTINGS, cause=1):
    return seal(STATUS, {2: struct.pack("<BBIIIQII", state, cause, boot, session, report_number,
                                        uptime_us, number & 0xFFFFFFFF, first_run),
                         54: struct.pack("<H", crc16(settings))})


def event(boot, session, report_number, event_number, kind, state, time_ns=0, argument=0,
          detail=0):
    return seal(EVENT, {2: struct.pack("<BBIIII", kind, state, boot, session, report_number,
                                       event_number),
                        20: struct.pack("<QB", time_ns // 1000, time_ns % 1000 // 8),
                        32: struct.pack("<II", argument & 0xFFFFFFFF, detail)})


def identity(boot, unique_id, version=PROTOCOL, firmware=(0, 2, 0)):
    return seal(IDENTITY, {2: struct.pack("<H", 0xF), 4: b"OPMS", 8: struct.pack("<H", 1),
                           10: bytes(firmware), 14: struct.pack("<H", 4),
                           16: bytes.fromhex(unique_id), 24: b"0123456789abcdef0123",
                           44: struct.pack("<IHHI", 125000000, 1024, 8192, boot)}, version)


def settings(body=DEFAULT_SETTINGS, last_set=0, pending=False, stored=True):
    """What the box answers to a GET; @p body is bytes 4 to 35."""
    flags = (1 if pending else 0) | (2 if stored else 0)
    return seal(SETTINGS, {2: bytes([last_set, flags]), 4: body,
                           36: struct.pack("<H", crc16(body))})


def history(boot, token, session, remaining, entries):
    """@p entries: up to two of (number, time_ns, flags)."""
    fields = {2: struct.pack("<HIIIHB", token, boot, session, entries[0][0] if entries else 0,
                             remaining, len(entries))}
    for i, (_, time_ns, flags) in enumerate(entries):
        fields[20 + 20 * i] = struct.pack("<QIIBBH", time_ns // 1000, 0, 0, time_ns % 1000 // 8, 0,
                                          flags)
    return seal(HISTORY, fields)
