# SPDX-License-Identifier: Apache-2.0
"""opms calibrate on rendered pictures from which no camera follows: none may be written."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

OPMS = os.environ.get("OPMS", "opms")
GRID = Path(__file__).resolve().parents[1] / "data" / "grid"
LIFT = sorted(GRID.glob("*.png"))
RESULT = 1


def run(*arguments):
    call = [OPMS, *map(str, arguments)]
    return subprocess.run(call, capture_output=True, text=True, timeout=300)


class Hopeless(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.out = self.folder / "found.yaml"

    def render(self, count, *options):
        """Pictures of a grid under a camera."""
        result = run("simulate", "grid", "--out", self.folder, "--count", count, *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return sorted(self.folder.glob("*.png"))

    def calibrate(self, pictures):
        return run("calibrate", "--grid", "a0-25", "--json", "--out", self.out, *pictures)

    def assert_refused(self, result, *words):
        self.assertEqual(result.returncode, RESULT, result.stderr)
        row = json.loads(result.stdout)
        self.assertIn(row["state"], ("undetermined", "unsolved"))
        for word in words:
            self.assertIn(word, row["reason"])
        self.assertIn(row["reason"], result.stderr)
        self.assertNotIn("out", row)
        self.assertFalse(self.out.exists())
        return row

    def test_pictures_all_from_straight_above_leave_the_focal_length_open(self):
        pictures = self.render(4, "--distance-m", 0.45, 0.6, "--incidence-deg", 0, 0,
                               "--along-m", 0, 0)
        self.assert_refused(self.calibrate(pictures), "tilt")

    def test_a_tilt_that_is_the_same_in_all_pictures_is_warned_about_by_name(self):
        pictures = self.render(3, "--distance-m", 0.5, 0.52, "--incidence-deg", 15, 15,
                               "--azimuth-deg", 40, 41, "--along-m", 0, 0)
        row = self.assert_refused(self.calibrate(pictures), "do not fix the camera")
        names = {warning["name"] for warning in row["warnings"]}
        self.assertLessEqual({"all_parallel", "few_pictures"}, names)
        self.assertEqual([p["outliers"] < 20 for p in row["pictures"]], [True] * 3)

    def test_pictures_of_two_cameras_are_told_apart(self):
        other = self.folder / "other.yaml"
        text = (GRID / "camera.yaml").read_text()
        other.write_text(text.replace("585.0", "640.0").replace("517.3", "500.3"))
        strangers = self.render(3, "--camera", other)
        row = self.assert_refused(self.calibrate([*LIFT, *strangers]), "two cameras")
        for picture in row["pictures"]:
            self.assertEqual("left_out" in picture, Path(picture["image"]) in strangers)

    def test_one_picture_of_another_camera_is_left_out_and_the_rest_calibrated(self):
        other = self.folder / "other.yaml"
        other.write_text((GRID / "camera.yaml").read_text().replace("585.0", "640.0"))
        [stranger] = self.render(1, "--camera", other)
        result = self.calibrate([*LIFT, stranger])
        self.assertEqual(result.returncode, 0, result.stderr)
        row = json.loads(result.stdout)
        self.assertEqual(row["pictures_used"], len(LIFT))
        self.assertLess(abs(row["lens"]["fx_px"] - 585.0), 0.2)
        self.assertIn(f"{stranger}: left out: it does not fit the camera", result.stderr)
        self.assertTrue(self.out.exists())


if __name__ == "__main__":
    unittest.main()
