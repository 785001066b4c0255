# SPDX-License-Identifier: Apache-2.0
"""opms locate on path-traced pictures, judged by their truth.

Limits are those that every picture has to keep: 2 mm still and 3 mm in motion, every picture
located, no wrong label."""
import json
import math
import os
import subprocess
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from locate_schema import row_problems  # noqa: E402
from truth import (angle_error_deg, position_error_mm, visible_squares,  # noqa: E402
                   wrong_labels)

OPMS = os.environ.get("OPMS", "opms")
DATA = HERE.parent / "data"
STILL, MOTION = DATA / "bar", DATA / "bar-motion"


def truth_of(picture):
    return json.loads(picture.with_suffix(".json").read_text())


def locate(pictures, *options):
    """Rows of pictures of one folder, which must all have the bar at the same tilt."""
    [tilt] = {truth_of(p)["bar_tilt_deg"] for p in pictures}
    call = [OPMS, "locate", "--json", "--require", "located", "--tilt-deg", str(tilt), "--camera",
            str(pictures[0].parent / "camera.yaml"), *options, *map(str, pictures)]
    result = subprocess.run(call, capture_output=True, text=True, timeout=300)
    assert result.returncode == 0, f"exit {result.returncode}: {result.stdout} {result.stderr}"
    return [json.loads(line) for line in result.stdout.splitlines()]


def sigma_m(row):
    """Stated standard deviation of the camera's position."""
    return math.sqrt(sum(row["covariance"][i][i] for i in (3, 4, 5)))


class Truth(unittest.TestCase):
    def check(self, folder, limit_mm, limit_deg):
        pictures = sorted(folder.glob("*.png"))
        errors = []
        for picture in pictures:
            with self.subTest(picture=picture.name):
                [row] = locate([picture])
                truth = truth_of(picture)
                self.assertEqual(list(row_problems(row)), [])
                self.assertEqual(wrong_labels(row, truth), [])
                self.assertGreaterEqual(len(row["squares"]), 0.6 * len(visible_squares(truth)))
                error = position_error_mm(row, truth)
                print(f"{picture.name}: {error:.3f} mm, {angle_error_deg(row, truth):.4f} deg, "
                      f"{len(row['squares'])} of {len(visible_squares(truth))} squares")
                self.assertLess(error, limit_mm)
                self.assertLess(angle_error_deg(row, truth), limit_deg)
                errors.append(error)
        self.assertEqual(len(errors), len(pictures))
        print(f"{folder.name}: RMS {math.sqrt(sum(e * e for e in errors) / len(errors)):.3f} mm")

    def test_still(self):
        self.check(STILL, limit_mm=2.0, limit_deg=0.2)

    def test_motion(self):
        self.check(MOTION, limit_mm=3.0, limit_deg=0.3)

    def test_following_gives_the_same_poses(self):
        """The pictures are no sequence: every hint is wrong, and none may do harm."""
        pictures = sorted(STILL.glob("*.png"))
        for alone, followed in zip(locate(pictures), locate(pictures, "--follow"), strict=True):
            with self.subTest(picture=alone["image"]):
                # A square that grass all but hides may come or go; a label never changes.
                seen, again = ({s["index"] for s in row["squares"]} for row in (alone, followed))
                self.assertLessEqual(len(seen ^ again), 1)
                self.assertLess(math.dist(alone["t_bar_camera_m"], followed["t_bar_camera_m"]),
                                0.1 * sigma_m(alone))

    def test_the_same_picture_followed_stays_in_place(self):
        [picture] = [STILL / "bar_01007.png"]
        first, second = locate([picture, picture], "--follow")
        self.assertLess(math.dist(first["t_bar_camera_m"], second["t_bar_camera_m"]), 1e-4)

    def test_the_tilt_moves_the_ground_and_not_the_bar(self):
        picture = STILL / "bar_01007.png"
        tilted = locate([picture])[0]
        call = [OPMS, "locate", "--json", "--camera", str(STILL / "camera.yaml"), str(picture)]
        flat = json.loads(subprocess.run(call, capture_output=True, text=True, timeout=60).stdout)
        self.assertEqual(tilted["t_bar_camera_m"], flat["t_bar_camera_m"])
        tilt = math.radians(truth_of(picture)["bar_tilt_deg"])
        x, y, z = flat["t_ground_detector_m"]
        # R_ground_bar = Ry(-tilt)
        turned = [math.cos(tilt) * x - math.sin(tilt) * z, y,
                  math.sin(tilt) * x + math.cos(tilt) * z]
        self.assertLess(math.dist(turned, tilted["t_ground_detector_m"]), 1e-9)


if __name__ == "__main__":
    unittest.main()
