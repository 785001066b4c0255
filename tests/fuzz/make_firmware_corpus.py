# SPDX-License-Identifier: Apache-2.0
"""Write seeds for fuzz_box (scripts of whole sessions) and fuzz_settings_store.

    make_firmware_corpus.py FOLDER_BOX FOLDER_STORE
"""
import json
import struct
import sys
from pathlib import Path

DATA = Path(__file__).resolve().parents[1] / "data" / "wire"
(COMMAND, COMMAND_BYTES, COMMAND_SEALED, FEATURE_BYTES, FEATURE_SEALED, GET, PASS, PULSE, START,
 GLITCH, STROBE, ACT, REPORTS, HEAL) = range(14)


def passing(ms):
    return bytes([PASS]) + struct.pack(">I", ms * 125_000)


def golden(kind, index=0):
    document = json.loads((DATA / f"{kind}.json").read_text(encoding="utf-8"))
    return bytes.fromhex(document["vectors"][index]["hex"])


def command(opcode, argument=0):
    return bytes([COMMAND, opcode - 1, argument])


def feature(kind, index=0):
    return bytes([FEATURE_BYTES, 64]) + golden(kind, index)


def session(preamble, run, reports=True):
    yield command(2, 1) + bytes([ACT, 1])
    for _ in range(preamble):
        yield bytes([PULSE, 0]) + passing(100)
    yield bytes([START, 125]) + bytes([PASS]) + struct.pack(">I", 4)
    for i in range(run):
        yield bytes([PULSE, 0, STROBE]) + struct.pack(">I", 50) + bytes([40]) + passing(100)
        if reports:
            yield bytes([REPORTS, 3])
        if i % 5 == 0:
            yield command(1, i)
    yield command(3) + bytes([ACT, 1])


def box_seeds():
    yield "whole", b"\1" + b"".join(session(6, 20))
    yield "cut", b"\0" + b"".join(session(2, 5)) + b"".join(session(0, 5, reports=False)) * 3
    yield "lost", b"\1" + command(2, 1) + bytes([ACT, 1]) + bytes([PULSE, 3, PULSE, 2]) * 9 + (
        bytes([REPORTS, 255])) + command(3) + bytes([ACT, 1]) + command(2, 2)
    yield "settings", b"\0" + feature("settings_set", 2) + bytes([ACT, 1]) + feature(
        "settings_set", 3) + bytes([ACT, 0]) + bytes([GET, 0x21]) + feature("bootloader")
    yield "history", b"\1" + b"".join(session(6, 9)) + (
        bytes([FEATURE_SEALED, 14, 0x22, 0, 7, 0, 1, 0, 0, 0, 1, 0, 0, 0, 9, 0])
        + bytes([GET, 0x22]) * 6)
    yield "refused", b"\0" + b"".join(
        feature(kind) for kind in ("trigger", "identity", "command")) + (
        bytes([COMMAND_BYTES, 64]) + golden("pong")) + bytes([COMMAND_SEALED, 3, 0x10, 0, 9])
    yield "timeout", b"\0" + command(2, 1) + bytes([ACT, 1]) + (
        bytes([PULSE, 0]) * 6 + passing(9000) + passing(2000) + bytes([ACT, 1, HEAL, GLITCH, 1, 2]))


def store_seeds():
    yield "blank", bytes([255, 255, 0, 0])
    yield "cut_early", bytes([1, 9, 0, 31]) + golden("settings_set", 3)[2:62]
    yield "filled", bytes([40, 3, 255, 18]) + golden("settings_set")
    yield "half", bytes([200, 0, 120, 1]) + golden("settings", 2)[2:62]


def write(folder, prefix, seeds):
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, data in seeds:
        (Path(folder) / f"{prefix}_{name}.bin").write_bytes(data)


if __name__ == "__main__":
    write(sys.argv[1], "box", box_seeds())
    write(sys.argv[2], "store", store_seeds())
