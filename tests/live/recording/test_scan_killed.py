# SPDX-License-Identifier: Apache-2.0
"""`opms scan` itself, killed: what it had printed a second before is in the recording, and the
same. OPMS names the program."""
import json
import os
import random
import sqlite3
import subprocess
import tempfile
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from memory_folder import memory_folder

CAMERA = Path(__file__).resolve().parents[2] / "data/bar/camera.yaml"
KILLS = int(os.environ.get("OPMS_SCAN_KILLS", "3"))


class Stalls(threading.Thread):
    """The longest time that this machine let somebody sleep too long."""

    def __init__(self):
        super().__init__(daemon=True)
        self.most_s = 0.0

    def run(self):
        while True:
            before = time.monotonic()
            time.sleep(0.01)
            self.most_s = max(self.most_s, time.monotonic() - before - 0.01)


def scan_until(folder, poses):
    """Run a scan until so many poses were printed, and kill it.
    @return The poses with the time at which each was read, and that of the kill."""
    program = subprocess.Popen(
        [os.environ["OPMS"], "scan", "--camera", str(CAMERA), "--box", "simulated",
         "--source", "simulated:pictures=blank", "--folder", folder, "--name", "killed",
         "--start", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    printed = []
    for line in program.stdout:
        row = json.loads(line)
        if row["schema"] == "opms.pose/1":
            printed.append((row, time.monotonic()))
        if len(printed) == poses:
            break
    program.kill()
    killed = time.monotonic()
    trouble = program.communicate()[1]
    if len(printed) < poses:
        raise AssertionError(f"the scan ended by itself: {trouble}")
    return printed, killed


def recorded_poses(folder):
    book = sqlite3.connect(Path(folder) / "killed/scan.sqlite")
    verdict = book.execute("PRAGMA integrity_check").fetchone()[0]
    poses = {number: rest for number, *rest in book.execute(
        "SELECT number, state, frame_state, trigger_number, t_scan_ns FROM poses")}
    pictures = {number: Path(folder) / "killed" / path
                for number, path in book.execute("SELECT number, path FROM pictures")}
    ended = book.execute("SELECT count(*) FROM scan_end").fetchone()[0]
    book.close()
    return verdict, poses, pictures, ended


class KilledScan(unittest.TestCase):
    def assert_same(self, row, recorded):
        state, frame_state, trigger, t_scan_ns = recorded
        self.assertEqual((state, frame_state), (row["state"], row["pair"]))
        self.assertEqual(trigger or None, row["trigger"])
        if row["t_scan_s"] is None:
            self.assertIsNone(t_scan_ns)
        else:
            self.assertAlmostEqual(t_scan_ns * 1e-9, row["t_scan_s"], places=7)

    def check_one(self, seed):
        stalls = Stalls()
        stalls.start()
        with tempfile.TemporaryDirectory(prefix="opms-killed-", dir=memory_folder()) as folder:
            printed, killed = scan_until(folder, random.Random(seed).randint(30, 60))
            verdict, poses, pictures, ended = recorded_poses(folder)
            self.assertEqual((verdict, ended), ("ok", 0))
            self.assertEqual(sorted(poses), list(range(1, len(poses) + 1)))
            due = [row for row, at in printed if at < killed - 1 - stalls.most_s]
            self.assertLessEqual({row["picture"] for row in due}, set(poses))
            self.assertLessEqual({row["picture"] for row in due}, set(pictures))
            self.assertTrue(all(path.is_file() for path in pictures.values()))
            for row, _ in printed:
                if row["picture"] in poses:
                    self.assert_same(row, poses[row["picture"]])
            return len(due)

    def test_what_was_printed_a_second_before_a_kill_is_recorded(self):
        with ThreadPoolExecutor(3) as pool:
            due = list(pool.map(self.check_one, range(1, KILLS + 1)))
        self.assertGreater(sum(due), 0, "no pose was printed early enough to be due")


if __name__ == "__main__":
    unittest.main()
