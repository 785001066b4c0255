# SPDX-License-Identifier: Apache-2.0
"""Cut the power of a recording at many instants, and look at what the disk may hold then.

    power_cut.py SCAN_WRITER [--cuts N] [--frames N] [--seed N] [--keep FOLDER]

A scan is recorded once with a log of all that SQLite and the recorder ask of the disk; from it,
disk_state.py makes the disk after a cut at instants spread over all calls, each with its own luck
for what was not synced. Each must open, have lost a second at most, and be right: scan_check.py."""
import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import disk_state
from kill_test import check
from memory_folder import memory_folder
from scan_check import WrongScan
from scan_claims import Claims

EDGES = 400  # so much that the log is taken into the database in between
LUCK = [0.0, 0.1, 0.5, 0.9, 1.0]


def record(program, folder, frames):
    """@return The log's records."""
    root, log = folder / "disk", folder / "calls.log"
    root.mkdir()
    with subprocess.Popen(
            [program, "record", str(root), "scan", str(frames), "60", str(EDGES), "100"],
            env={**os.environ, "OPMS_DISK_ROOT": str(root), "OPMS_DISK_LOG": str(log)},
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as run:
        if run.wait() != 0:
            sys.exit("power_cut: scan_writer failed")
    return list(disk_state.read_log(log))


def replay_is_right(calls, root, rng):
    """The model itself: with all calls done and all luck, it is the folder that is there."""
    disk = disk_state.Disk()
    for kind, name, other, data, _, offset in calls:
        disk.apply(kind, name, other, data, offset)
    with tempfile.TemporaryDirectory(prefix="opms-disk-") as place:
        disk.cut(rng, 1.0, place)
        return files_of(Path(place)) == files_of(root)


def files_of(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def instants(calls, cuts, rng):
    """Numbers of calls after which the power goes: a fifth of them at the start and the stop."""
    count = len(calls)
    edge = max(1, count // 50)
    chosen = [rng.randrange(count) for _ in range(cuts * 4 // 5)]
    while len(chosen) < cuts:
        at = rng.randrange(edge)
        chosen.append(rng.choice([at, count - 1 - at]))
    return sorted(chosen)


def judge_can_fail(calls, rng):
    """On a disk that syncs nothing, recordings must be found wrong: else this test is worthless."""
    lying = [call for call in calls if call[0] != disk_state.SYNC]
    failures, *_ = cut_all(lying, 20, rng, None)
    return bool(failures)


def cut_all(calls, cuts, rng, keep):
    disk, claims, done = disk_state.Disk(), Claims(), 0
    failures, there, most_lost = [], 0, 0
    known_good = set()
    for number, at in enumerate(instants(calls, cuts, rng)):
        for kind, name, other, data, time_ns, offset in calls[done:at + 1]:
            if kind == disk_state.MARK:
                claims.hear(data.decode())
            else:
                disk.apply(kind, name, other, data, offset)
        done = at + 1
        place = tempfile.mkdtemp(prefix="opms-cut-", dir=memory_folder())
        disk.cut(rng, LUCK[number % len(LUCK)], place)
        try:
            found = check(place, claims, calls[at][4], EDGES, known_good)
            there += found is not None
            if found:
                most_lost = max(most_lost, len(claims.handed) - found.newest["frames"])
        except WrongScan as error:
            failures.append(f"cut {number} after call {at}: {error}")
            if keep:
                shutil.copytree(place, Path(keep) / f"cut-{number}")
        shutil.rmtree(place)
    return failures, there, most_lost


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scan_writer")
    parser.add_argument("--cuts", type=int, default=1000)
    parser.add_argument("--frames", type=int, default=600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", help="copy the disks of failures there")
    args = parser.parse_args()
    rng = random.Random(args.seed)
    with tempfile.TemporaryDirectory(prefix="opms-power-", dir=memory_folder()) as temporary:
        folder = Path(temporary).resolve()
        calls = record(args.scan_writer, folder, args.frames)
        if not replay_is_right(calls, folder / "disk", rng):
            sys.exit("power_cut: the log does not lead to the folder that is there")
    if not judge_can_fail(calls, rng):
        sys.exit("power_cut: a disk that syncs nothing was found to keep all")
    failures, there, most = cut_all(calls, args.cuts, rng, args.keep)
    for failure in failures:
        print(failure)
    print(f"{args.cuts} power cuts over {len(calls)} calls: {there} recordings, "
          f"{len(failures)} wrong; at most {most} frames of 60 a second lost")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
