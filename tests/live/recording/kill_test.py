# SPDX-License-Identifier: Apache-2.0
"""Kill a recording at instants spread by seed over its start, its course and its stop; then look
whether it opens, whether no more than a second is lost, and whether what is there is right.

    kill_test.py SCAN_WRITER [--kills N] [--seed N] [--jobs N] [--keep FOLDER]

Ends with 1 and the seed of each failure if there was any. The judge is scan_check.py."""
import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import made_truth
from memory_folder import memory_folder
from scan_check import WrongScan, check_scan
from scan_claims import Claims

EDGES = 60
RATE_HZ = 60


# A sanitizer that looks for leaks at the end does not take a kill in silence.
WRITER_ENVIRONMENT = {**os.environ,
                      "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"}


class Writer:
    """A scan_writer and what it has said so far."""

    def __init__(self, program, folder, commit_ms):
        self.claims = Claims()
        self.changed = threading.Condition()
        self.process = subprocess.Popen(
            [program, "record", folder, "scan", "100000", str(RATE_HZ), str(EDGES),
             str(commit_ms)],
            env=WRITER_ENVIRONMENT, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True)
        self.reader = threading.Thread(target=self.listen)
        self.reader.start()

    def listen(self):
        for line in self.process.stdout:
            with self.changed:
                if line.endswith("\n"):
                    self.claims.hear(line)
                self.changed.notify_all()
        with self.changed:
            self.changed.notify_all()

    def wait_for(self, word):
        with self.changed:
            self.changed.wait_for(lambda: getattr(self.claims, word)
                                  or self.process.poll() is not None, timeout=60)

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        cut_ns = time.monotonic_ns()
        self.process.wait()
        self.reader.join()
        trouble = self.process.stderr.read()
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            stream.close()
        return cut_ns, trouble


def run_and_kill(program, folder, rng):
    """@return What was said, when it was killed, and in which part."""
    writer = Writer(program, folder, rng.choice([50, 100, 250]))
    part = rng.choices(["start", "course", "stop"], [1, 2, 1])[0]
    if part == "start":
        time.sleep(rng.uniform(0, 0.06))
    else:
        writer.wait_for("begun")
        time.sleep(rng.uniform(0, 2.5) if part == "course" else rng.uniform(0, 0.5))
    if part == "stop":
        writer.process.stdin.close()
        writer.wait_for("ending")
        time.sleep(rng.uniform(0, 0.05))
    cut_ns, trouble = writer.kill()
    if trouble:
        raise WrongScan(f"scan_writer says: {trouble}")
    return writer.claims, cut_ns, part


def check(folder, claims, cut_ns, edges, known_good=None):
    """What is there after a cut at that instant against what was said before it.
    @return What was found; None where there is no recording, and none is due."""
    scan = Path(folder) / "scan"
    if not scan.exists():
        if claims.begun:
            raise WrongScan("there is no recording, though it had begun")
        return None
    found = check_scan(scan, edges, known_good)
    if claims.ended and not found.ended:
        raise WrongScan("it had ended, the recording says that it had not")
    rows, pictures = claims.rows_due(cut_ns), claims.pictures_due(cut_ns)
    for table, newest in found.newest.items():
        due = made_truth.numbers(table, rows)
        if due and newest < due[-1]:
            raise WrongScan(f"{table}: to {newest}, record {due[-1]} must be there")
    missing = set(range(1, pictures + 1)) - found.pictures
    if missing:
        raise WrongScan(f"pictures {sorted(missing)[:5]} are missing, all to {pictures} must be")
    return found


def recover(program, folder, found):
    """Another look, by opms itself: after it the scan is whole, and nothing of it has gone."""
    run = subprocess.run([program, "recover", str(Path(folder) / "scan")], text=True,
                         capture_output=True)
    if run.returncode != 0:
        raise WrongScan(f"cannot be recovered: {run.stderr}")
    report = json.loads(run.stdout)
    if report["needed"] == found.ended or report["pictures_lost"] != 0:
        raise WrongScan(f"recovery says {report}, the scan had ended: {found.ended}")
    again = check_scan(Path(folder) / "scan", EDGES)
    if again.rows != found.rows or again.pictures != found.pictures:
        raise WrongScan("recovery has changed what is there")
    named = {f"{n:06}.png" for n in again.pictures}
    loose = {p.name for p in (Path(folder) / "scan/pictures").rglob("*.*")} - named
    if loose and not found.ended:
        raise WrongScan(f"recovery left {sorted(loose)[:3]}")


def one(program, seed, keep):
    rng = random.Random(seed)
    folder = tempfile.mkdtemp(prefix="opms-kill-", dir=memory_folder())
    try:
        claims, cut_ns, part = run_and_kill(program, folder, rng)
        found = check(folder, claims, cut_ns, EDGES)
        if found and rng.random() < 0.5:
            recover(program, folder, found)
        lost = len(claims.handed) - found.newest["frames"] if found else 0
        shutil.rmtree(folder)
        return part, found is not None, lost, None
    except WrongScan as error:
        if keep:
            shutil.move(folder, Path(keep) / f"kill-{seed}")
        else:
            shutil.rmtree(folder)
        return "", False, 0, f"seed {seed}: {error}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scan_writer")
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=6)
    parser.add_argument("--keep", help="move the recordings of failures there")
    args = parser.parse_args()
    seeds = range(args.seed, args.seed + args.kills)
    with ThreadPoolExecutor(args.jobs) as pool:
        results = list(pool.map(lambda seed: one(args.scan_writer, seed, args.keep), seeds))
    failures = [error for *_, error in results if error]
    parts = {name: sum(part == name for part, *_ in results)
             for name in ("start", "course", "stop")}
    there = sum(is_there for _, is_there, *_ in results)
    most = max(lost for *_, lost, _ in results)
    for failure in failures:
        print(failure)
    print(f"{args.kills} kills ({parts['start']} at the start, {parts['course']} in its course, "
          f"{parts['stop']} at the stop): {there} recordings, {len(failures)} wrong; at most "
          f"{most} frames of {RATE_HZ} a second lost")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
