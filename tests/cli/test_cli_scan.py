# SPDX-License-Identifier: Apache-2.0
"""`opms scan` with a simulated box and camera: as a person calls it, and as it ends."""
import json
import math
import signal
import sqlite3
import subprocess
import unittest
from contextlib import closing

from cli_kit import DATA, INPUT, OK, OPMS, USAGE, CliTest, opms, rows

CAMERA = DATA / "bar/camera.yaml"
DEVICE = 3
WORLD = ["--box", "simulated", "--source", "simulated:frames=8,seed=5", "--start"]


def of_schema(objects, schema):
    return [row for row in objects if row["schema"] == schema]


class Scan(CliTest):
    def setUp(self):
        super().setUp()
        self.scans = self.folder / "scans"
        self.place = ["--camera", CAMERA, "--folder", self.scans]

    def scan(self, *arguments):
        return opms("scan", *self.place, *WORLD, *arguments)

    def begin(self, *arguments):
        """A scan that goes on until it is told."""
        process = subprocess.Popen(
            [OPMS, "scan", *map(str, self.place), *WORLD, "--json", *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        return process

    def wait_for_poses(self, process, count):
        while count > 0:
            line = process.stdout.readline()
            self.assertTrue(line, "the scan ended by itself")
            count -= json.loads(line)["schema"] == "opms.pose/1"

    def one_recording(self):
        found = list(self.scans.glob("*/scan.sqlite"))
        self.assertEqual(len(found), 1)
        return found[0]

    def rows_of(self, table):
        with closing(sqlite3.connect(f"file:{self.one_recording()}?mode=ro", uri=True)) as book:
            return book.execute(f"SELECT count(*) FROM {table}").fetchone()[0]

    def test_every_pulse_has_a_pose_at_its_own_time(self):
        result = self.scan("--json", "--count", "30")
        self.assertEqual(result.returncode, OK, result.stderr)
        seen = rows(result)
        states = [row["state"] for row in of_schema(seen, "opms.state/1")]
        self.assertIn("ready", states)
        self.assertLess(states.index("ready"), states.index("running"))
        timed = [row for row in of_schema(seen, "opms.pose/1") if row["t_scan_s"] is not None
                 and row["t_scan_s"] > 0]
        self.assertGreater(len(timed), 15)
        for before, after in zip(timed, timed[1:]):
            self.assertEqual(after["trigger"], before["trigger"] + 1)
            self.assertLess(abs(after["t_scan_s"] - before["t_scan_s"] - 0.1), 0.03)
        for row in timed:
            self.assertEqual((row["state"], row["pair"]), ("located", "PAIRED"))
            self.assertLess(math.dist(row["t_ground_detector_m"], (0, 0, 0)), 3)

    def test_it_is_recorded_with_each_pose_and_picture(self):
        result = self.scan("--json", "--count", "20")
        self.assertEqual(result.returncode, OK, result.stderr)
        poses = len(of_schema(rows(result), "opms.pose/1"))
        self.assertGreaterEqual(poses, 20)
        self.assertEqual(self.rows_of("poses"), poses)
        self.assertEqual(len(list(self.one_recording().parent.rglob("*.png"))), poses)
        self.assertIn(f"recorded: {self.one_recording().parent}", result.stderr)

    def test_no_recording_leaves_nothing_behind(self):
        result = self.scan("--no-recording", "--count", "10")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertFalse(self.scans.exists())

    def test_ctrl_c_ends_a_scan_well(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number), self.subTest():
                process = self.begin("--name", f"by-{number.name}")
                self.wait_for_poses(process, 12)
                process.send_signal(number)
                process.communicate(timeout=60)
                self.assertEqual(process.returncode, OK)
                shown = opms("catalogue", "show", "--json", "--folder", self.scans,
                             f"by-{number.name}")
                self.assertEqual(shown.returncode, OK, shown.stderr)

    def test_a_reader_that_goes_away_ends_it_and_the_recording_is_closed(self):
        process = self.begin()
        self.wait_for_poses(process, 8)
        process.stdout.close()
        self.assertEqual(process.wait(timeout=60), INPUT)
        process.stderr.close()
        self.assertGreaterEqual(self.rows_of("poses"), 8)

    def test_the_focus_view_runs_without_a_box_and_keeps_nothing(self):
        result = opms("scan", *self.place, "--source", "simulated:frames=8,seed=5", "--focus",
                      "--json", "--count", "12")
        self.assertEqual(result.returncode, OK, result.stderr)
        poses = of_schema(rows(result), "opms.pose/1")
        self.assertGreaterEqual(len(poses), 12)
        for pose in poses:
            self.assertIsNone(pose["t_scan_s"])
            self.assertIn(pose["blur"]["verdict"],
                          ("sharp", "focus", "motion", "aperture", "unknown"))
        self.assertFalse(self.scans.exists())

    def test_a_file_gets_a_line_a_second_and_no_drawing(self):
        result = self.scan("--count", "25")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("paired", result.stdout)
        self.assertNotIn("\033", result.stdout + result.stderr)

    def test_wrong_use_is_told(self):
        cases = [(USAGE, ["--camera", CAMERA, "--box", "paper"], "paper"),
                 (USAGE, ["--camera", CAMERA, "--source", "film:1"], "film"),
                 (USAGE, ["--box", "simulated", "--source", "simulated"], "--camera"),
                 (USAGE, ["--camera", CAMERA, "--seconds", "nan"], "nan"),
                 (USAGE, ["--camera", CAMERA, "--pictures", "some"], "some"),
                 (INPUT, ["--camera", self.folder / "none.yaml", *WORLD], "none.yaml"),
                 (DEVICE, ["--camera", CAMERA, "--box", "hid:0123456789ABCDEF"],
                  "0123456789ABCDEF")]
        for exit_code, arguments, word in cases:
            with self.subTest(word):
                result = opms("scan", "--folder", self.scans, *arguments)
                self.assertEqual(result.returncode, exit_code, result.stderr)
                self.assertIn(word, result.stderr)

    def test_a_name_that_is_no_folder_is_refused_and_a_second_one_gets_a_number(self):
        self.assertNotEqual(self.scan("--count", "3", "--name", "../escape").returncode, OK)
        for _ in range(2):
            result = self.scan("--count", "3", "--name", "lane 7")
            self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(sorted(path.parent.name for path in self.scans.glob("*/scan.sqlite")),
                         ["lane 7", "lane 7-2"])


if __name__ == "__main__":
    unittest.main()
