# SPDX-License-Identifier: Apache-2.0
"""opms calibrate tells which picture to take next: it is rendered, and does what was foreseen."""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

OPMS = os.environ.get("OPMS", "opms")
GRID = Path(__file__).resolve().parents[1] / "data" / "grid"
CAMERA = GRID / "camera.yaml"


def run(*arguments):
    result = subprocess.run([OPMS, *map(str, arguments)], capture_output=True, text=True,
                            timeout=300)
    return result


class Advice(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def render(self, name, poses):
        """Pictures of the grid from these camera poses."""
        file = self.folder / f"{name}.json"
        file.write_text(json.dumps([{"R_bar_camera": R, "t_bar_camera_m": t} for R, t in poses]))
        folder = self.folder / name
        result = run("simulate", "grid", "--out", folder, "--camera", CAMERA, "--poses", file)
        self.assertEqual(result.returncode, 0, result.stderr)
        return sorted(folder.glob("*.png"))

    def calibrate(self, pictures, *options):
        result = run("calibrate", "--grid", "a0-25", "--json", "--footprint-sigma", "0,0", "--out",
                     self.folder / "found.yaml", *options, *pictures)
        return result, json.loads(result.stdout)

    def lift(self, count):
        """Poses of the lift, the first on the footprint, leaning hardly at all after it."""
        truth = json.loads((GRID / "grid_02001.json").read_text())
        R, t = truth["R_bar_camera"], truth["t_bar_camera_m"]
        poses = []
        for k in range(count):
            a = 0.06 * k  # about the picture's column axis
            turn = [[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]]
            turned = [[sum(R[i][m] * turn[m][j] for m in range(3)) for j in range(3)]
                      for i in range(3)]
            poses.append((turned, [t[0], t[1], t[2] + 0.02 * k]))
        return poses

    def test_the_advised_picture_lowers_the_error_as_foreseen(self):
        pictures = self.render("few", self.lift(5))
        result, before = self.calibrate(pictures)
        self.assertEqual(result.returncode, 0, result.stderr)
        advised = before["next"]
        self.assertLess(advised["position_mm_then"], 0.8 * advised["position_mm_now"])
        more = self.render("more", [(advised["R_grid_camera"], advised["t_grid_camera_m"])])
        _, after = self.calibrate([*pictures, *more])
        picture = after["pictures"][-1]
        self.assertNotIn("left_out", picture)
        self.assertLess(abs(picture["node_count"] - advised["node_count"]),
                        0.2 * advised["node_count"])
        # How alike residuals are, and with it the stated error, is found anew each time.
        ratio = after["next"]["position_mm_now"] / advised["position_mm_then"]
        self.assertGreater(ratio, 0.4)
        self.assertLess(ratio, 2.0)
        self.assertLess(after["expected"]["parts"]["lens"]["position_rms_mm"],
                        before["expected"]["parts"]["lens"]["position_rms_mm"])

    def test_the_words_say_where_the_camera_goes(self):
        pictures = self.render("few", self.lift(5))
        advised = self.calibrate(pictures)[1]["next"]
        first = self.lift(1)[0]
        axis = [row[2] for row in first[0]]
        new_axis = [row[2] for row in advised["R_grid_camera"]]
        angle = math.degrees(math.acos(sum(a * b for a, b in zip(axis, new_axis))))
        self.assertAlmostEqual(angle, advised["tilt_deg"], delta=0.2)
        seen = [t - a / axis[2] * first[1][2] for t, a in zip(first[1], axis)]
        moved = [a - b for a, b in zip(advised["t_grid_camera_m"], seen)]
        self.assertAlmostEqual(math.hypot(*moved), advised["distance_m"], delta=0.005)
        was = [a - b for a, b in zip(first[1], seen)]
        part = advised["distance_m"] / math.hypot(*was)
        x, y = (moved[i] - part * was[i] for i in range(2))
        towards = {"left": -y, "right": y, "back": x, "ahead": -x}
        self.assertGreater(advised["tilt_deg"], 0)
        self.assertEqual(max(towards, key=towards.get), advised["towards"])

    def test_parallel_pictures_are_told_how_to_go_on_and_the_report_says_do_it_again(self):
        result = run("simulate", "grid", "--out", self.folder / "parallel", "--count", 3,
                     "--distance-m", 0.5, 0.52, "--incidence-deg", 15, 15, "--azimuth-deg", 40, 41,
                     "--along-m", 0, 0)
        self.assertEqual(result.returncode, 0, result.stderr)
        pictures = sorted((self.folder / "parallel").glob("*.png"))
        report = self.folder / "report"
        result, row = self.calibrate(pictures, "--report", report)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(row["state"], "undetermined")
        self.assertGreaterEqual(row["next"]["tilt_deg"], 15)
        self.assertIn(f"by {row['next']['tilt_deg']:.0f} degrees", row["next"]["advice"])
        self.assertIn(f"{100 * row['next']['distance_m']:.0f} cm", row["next"]["advice"])
        self.assertFalse((self.folder / "found.yaml").exists())
        document = json.loads((report / "report.json").read_text())
        self.assertEqual(document["verdict"]["level"], "again")
        self.assertTrue(any("leans nearly the same way" in reason
                            for reason in document["verdict"]["reasons"]))
        self.assertIn(row["next"]["advice"].split("'")[0], (report / "report.html").read_text())


if __name__ == "__main__":
    unittest.main()
