# SPDX-License-Identifier: Apache-2.0
"""opms simulate as users call it: files, rows, exit codes, and opms locate as a reader."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

OPMS = os.environ["OPMS"]


def opms(*arguments):
    return subprocess.run([OPMS, *map(str, arguments)], capture_output=True, text=True)


class Simulate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name) / "new" / "folder"

    def rows(self, *arguments):
        done = opms("simulate", *arguments, "--out", self.out, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return [json.loads(line) for line in done.stdout.splitlines()]

    def test_a_bar_is_written_with_truth_and_camera_and_is_located(self):
        rows = self.rows("bar", "--count", 2, "--seed", 5, "--tilt-deg", 19.3)
        self.assertEqual([row["schema"] for row in rows], ["opms.simulate/1"] * 2)
        self.assertEqual([row["seed"] for row in rows], [5, 6])
        self.assertEqual(Path(rows[0]["image"]).name, "bar_00005.png")
        found = opms("locate", "--camera", self.out / "camera.yaml", "--tilt-deg", 19.3, "--json",
                     *(row["image"] for row in rows))
        self.assertEqual(found.returncode, 0, found.stderr)
        for row, line in zip(rows, found.stdout.splitlines()):
            truth, answer = json.loads(Path(row["truth"]).read_text()), json.loads(line)
            self.assertEqual(answer["state"], "located")
            for wanted, seen in zip(truth["t_ground_detector_m"], answer["t_ground_detector_m"]):
                self.assertAlmostEqual(wanted, seen, delta=0.002)

    def test_a_picture_can_be_made_again_alone(self):
        self.rows("bar", "--count", 2, "--seed", 8)
        first = (self.out / "bar_00009.png").read_bytes()
        self.rows("bar", "--seed", 9)
        self.assertEqual(first, (self.out / "bar_00009.png").read_bytes())

    def test_a_truth_file_is_a_list_of_poses(self):
        row = self.rows("bar", "--seed", 3)[0]
        again = self.rows("bar", "--poses", row["truth"], "--seed", 4, "--name", "again")[0]
        a, b = (json.loads(Path(r["truth"]).read_text()) for r in (row, again))
        for wanted, seen in zip(a["t_bar_camera_m"], b["t_bar_camera_m"]):
            self.assertAlmostEqual(wanted, seen, delta=1e-12)

    def test_a_calibration_lift_starts_on_the_footprint(self):
        rows = self.rows("grid", "--count", 2)
        truths = [json.loads(Path(row["truth"]).read_text()) for row in rows]
        self.assertEqual([t["kind"] for t in truths], ["grid", "grid"])
        for wanted, seen in zip([0.35, 0, 0], truths[0]["t_ground_detector_m"]):
            self.assertAlmostEqual(wanted, seen, delta=1e-12)
        self.assertGreater(truths[1]["t_ground_detector_m"][2], 0.1)

    def test_wrong_calls_are_refused(self):
        for arguments in (["bar"], [], ["bar", "--out", self.out, "--bits", 12],
                          ["bar", "--out", self.out, "--blur", 1, "--blur-total", 1],
                          ["bar", "--out", self.out, "--x-m", 1, 0],
                          ["bar", "--out", self.out, "--bar", "hope34"],
                          ["bar", "--out", self.out, "--name", "a/b"]):
            done = opms("simulate", *arguments)
            self.assertEqual(done.returncode, 2, (arguments, done.stderr))
            self.assertTrue(done.stderr)

    def test_bad_files_are_named(self):
        done = opms("simulate", "bar", "--out", self.out, "--camera", "nowhere.yaml")
        self.assertEqual(done.returncode, 4)
        self.assertIn("nowhere.yaml", done.stderr)
        done = opms("simulate", "bar", "--out", self.out, "--poses", "nowhere.json")
        self.assertEqual(done.returncode, 4)
        self.assertIn("nowhere.json", done.stderr)

    def test_a_range_that_shows_nothing_is_refused(self):
        done = opms("simulate", "bar", "--out", self.out, "--y-m", 5, 6)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--min-visible", done.stderr)

    def test_numbers_that_are_none_are_refused(self):
        for arguments in (["--noise", "nan"], ["--noise", "inf"], ["--tilt-deg", "nan"],
                          ["--velocity", "nan", 0, 0], ["--attitude-deg", "inf"],
                          ["--x-m", "nan", 1]):
            done = opms("simulate", "bar", "--out", self.out, *arguments)
            self.assertEqual(done.returncode, 2, (arguments, done.stderr))
            self.assertFalse(self.out.exists(), arguments)


if __name__ == "__main__":
    unittest.main()
