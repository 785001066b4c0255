# SPDX-License-Identifier: Apache-2.0
"""opms locate on rendered pictures that moved in any direction, with white saturated and not.

Judged by the truth of opms simulate: a position must be as good as it says."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

from truth import position_error_mm, wrong_labels

OPMS = os.environ.get("OPMS", "opms")
SPEED_M_S, SHUTTER_MS, COUNT = 0.6, 8, 2
ALONG, ACROSS, SLANTED = (0, SPEED_M_S, 0), (SPEED_M_S, 0, 0), (0.42, -0.42, 0)
WORST_MM = 3.0       # as path-traced pictures in motion have to keep
CHI2_3_MOST = 21.1   # of 10,000 true positions one lies farther out


def run(*arguments):
    return subprocess.run([OPMS, *map(str, arguments)], capture_output=True, text=True,
                          timeout=600)


def solve_3(m, b):
    """x of m x = b by elimination; m is positive definite."""
    rows = [[*m[i], b[i]] for i in range(3)]
    for k in range(3):
        for i in range(k + 1, 3):
            part = rows[i][k] / rows[k][k]
            rows[i] = [a - part * c for a, c in zip(rows[i], rows[k])]
    x = [0.0] * 3
    for i in (2, 1, 0):
        x[i] = (rows[i][3] - sum(rows[i][j] * x[j] for j in range(i + 1, 3))) / rows[i][i]
    return x


def position_chi2(row, truth):
    """How far off the camera's position is, squared, in its stated standard deviations."""
    off = [a - b for a, b in zip(row["t_bar_camera_m"], truth["t_bar_camera_m"])]
    covariance = [line[3:] for line in row["covariance"][3:]]
    return sum(a * b for a, b in zip(off, solve_3(covariance, off)))


# Anywhere in the working volume; and where squares lean in the picture by their own width.
ANYWHERE = ("--attitude-deg", 5, "--noise", 2, "--shot", 0.05)
LEANING = ("--distance-m", 0.6, 0.62, "--incidence-deg", 62, 64, "--azimuth-deg", -5, 5,
           "--along-m", -0.05, 0.05, "--camera-roll-deg", 30, 30, "--noise", 4)


class Moving(unittest.TestCase):
    def check(self, velocity, *options, where=ANYWHERE, shutter_ms=SHUTTER_MS, worst_mm=WORST_MM):
        with tempfile.TemporaryDirectory() as folder:
            made = run("simulate", "bar", "--out", folder, "--count", COUNT, "--seed", 51,
                       "--velocity", *velocity, "--shutter-ms", shutter_ms, "--min-visible", 8,
                       *where, *options)
            self.assertEqual(made.returncode, 0, made.stderr)
            pictures = sorted(Path(folder).glob("*.png"))
            self.assertEqual(len(pictures), COUNT)
            found = run("locate", "--json", "--require", "located", "--camera",
                        f"{folder}/camera.yaml", *pictures)
            self.assertEqual(found.returncode, 0, found.stdout)
            for picture, line in zip(pictures, found.stdout.splitlines(), strict=True):
                row, truth = json.loads(line), json.loads(picture.with_suffix(".json").read_text())
                error, chi2 = position_error_mm(row, truth), position_chi2(row, truth)
                print(f"{velocity} {options} {picture.name}: {error:.3f} mm, chi2_3 {chi2:.1f}")
                self.assertEqual(wrong_labels(row, truth), [])
                self.assertLess(error, worst_mm)
                self.assertLess(chi2, CHI2_3_MOST)

    def test_along_the_bar(self):
        self.check(ALONG)

    def test_across_the_bar(self):
        self.check(ACROSS)

    def test_at_45_degrees_to_the_bar(self):
        self.check(SLANTED)

    def test_along_the_bar_where_squares_lean_in_the_picture(self):
        self.check(ALONG, where=LEANING, shutter_ms=12, worst_mm=0.6)

    def test_along_the_bar_with_saturated_white(self):
        self.check(ALONG, "--gain", 1.8)

    def test_across_the_bar_with_saturated_white(self):
        self.check(ACROSS, "--gain", 1.8)

    def test_at_45_degrees_to_the_bar_with_saturated_white(self):
        self.check(SLANTED, "--gain", 1.8)

    def test_what_little_saturation_leaves_is_right_or_said_to_be_unsure(self):
        with tempfile.TemporaryDirectory() as folder:
            run("simulate", "bar", "--out", folder, "--count", COUNT, "--seed", 51, "--velocity",
                *ACROSS, "--shutter-ms", SHUTTER_MS, "--min-visible", 8, "--attitude-deg", 5,
                "--noise", 2, "--shot", 0.05, "--gain", 3)
            pictures = sorted(Path(folder).glob("*.png"))
            found = run("locate", "--json", "--camera", f"{folder}/camera.yaml", *pictures)
            for picture, line in zip(pictures, found.stdout.splitlines(), strict=True):
                row, truth = json.loads(line), json.loads(picture.with_suffix(".json").read_text())
                if row["state"] == "located":
                    print(f"{picture.name}: {position_error_mm(row, truth):.3f} mm, chi2_3 "
                          f"{position_chi2(row, truth):.1f}")
                    self.assertLess(position_chi2(row, truth), CHI2_3_MOST)


if __name__ == "__main__":
    unittest.main()
