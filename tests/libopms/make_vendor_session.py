# SPDX-License-Identifier: Apache-2.0
"""A small session for example_vendor: frames, and the box's bytes as docs/wire.md has them.

    make_vendor_session.py OUT.txt PICTURE.pgm...

A preamble of 6 pulses, a START, pulses of the run at 10 Hz. The second report of the run was lost,
one was damaged, one frame did not come. Pictures are taken in turn; the host's clock
is 5 s ahead of the box's, the camera's 77 s."""
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "hid"))
import box_wire  # noqa: E402

BOOT, SESSION = 0x1234ABCD, 7
MS = 1_000_000
HOST_LESS_BOX_NS, CAMERA_LESS_BOX_US = 5_000 * MS, 77_000_000
PREAMBLE_MS = [9000, 9100, 9300, 9400, 9700, 9800]
START_NS = 11_000 * MS - 1_032
RUN = 8
LOST_REPORT, DAMAGED_REPORT, LOST_FRAME = 8, 10, 13


def pulses():
    """Number, time and flag of each."""
    for i, ms in enumerate(PREAMBLE_MS):
        yield i + 1, ms * MS, box_wire.PREAMBLE_FLAG
    for i in range(RUN):
        yield len(PREAMBLE_MS) + 1 + i, (11_000 + 100 * i) * MS, box_wire.RUN_FLAG


def report_line(arrived_ns, report, sent_ns=0):
    return f"report {arrived_ns} {sent_ns} {report.hex()}"


def pings():
    for i in range(10):
        at = (8000 + 90 * i) * MS
        yield report_line(at + HOST_LESS_BOX_NS + MS // 2, box_wire.pong(BOOT, i + 1, i, at, at),
                          at + HOST_LESS_BOX_NS - MS // 2)


def session(pictures):
    yield from pings()
    yield f"session {BOOT} {SESSION}"
    before, first_run = [0, 0], len(PREAMBLE_MS) + 1
    for number, time_ns, flag in pulses():
        in_run = flag == box_wire.RUN_FLAG
        gaps = [(time_ns - at) // 1000 if at else 0 for at in before[:1]]
        gaps.append((before[0] - before[1]) // 1000 if before[1] else 0)
        report = box_wire.trigger(BOOT, SESSION, 100 + number, number, time_ns, flag,
                                  START_NS if in_run else 0, first_run if in_run else 0, gaps)
        before = [time_ns, before[0]]
        if number == DAMAGED_REPORT:
            report = report[:30] + bytes([report[30] ^ 0x40]) + report[31:]
        if number != LOST_REPORT:
            yield report_line(time_ns + HOST_LESS_BOX_NS + MS, report)
        if number != LOST_FRAME:
            yield (f"frame {time_ns + HOST_LESS_BOX_NS + 28 * MS} {500 + number} "
                   f"{time_ns // 1000 + CAMERA_LESS_BOX_US} {pictures[number % len(pictures)]}")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    lines = "".join(line + "\n" for line in session(sys.argv[2:]))
    Path(sys.argv[1]).write_text(lines, encoding="utf-8")
    print(os.path.basename(sys.argv[1]), "written")


if __name__ == "__main__":
    main()
