# SPDX-License-Identifier: Apache-2.0
"""opms calibrate on path-traced pictures of the grid, judged by the camera they were made with,
and what the camera file is good for."""
import json
import math
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from grid_truth import LENS, chi2, rms, rotation_vector
from truth import position_error_mm

OPMS = os.environ.get("OPMS", "opms")
DATA = Path(__file__).resolve().parents[1] / "data"
PICTURES = sorted((DATA / "grid").glob("*.png"))
CHI2_95_OF_8, CHI2_95_OF_6, CHI2_999_OF_6 = 15.5, 12.6, 22.5


def run(*arguments):
    call = [OPMS, *map(str, arguments)]
    return subprocess.run(call, capture_output=True, text=True, timeout=300)


def numbers_of_file(path, key):
    """The list of numbers that a camera file has for a key."""
    return [float(n) for n in re.search(rf"\b{key}: \[(.*)\]", path.read_text())[1].split(",")]


class Calibration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = Path(cls.folder.name) / "camera.yaml"
        result = run("calibrate", "--grid", "a0-25", "--json", "--out", cls.out, "--name", "lift",
                     *PICTURES)
        assert result.returncode == 0, result.stderr
        cls.row = json.loads(result.stdout)
        cls.truth = json.loads(PICTURES[0].with_suffix(".json").read_text())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def mounting_chi2(self, row):
        error = rotation_vector(row["R_detector_camera"], self.truth["R_detector_camera"])
        error += [t - m for t, m in zip(self.truth["t_detector_camera_m"],
                                        row["t_detector_camera_m"])]
        return chi2(error, row["covariance_detector_camera"])

    def test_all_pictures_are_used_and_the_residual_is_that_of_the_nodes(self):
        self.assertEqual(self.row["state"], "calibrated")
        self.assertEqual(self.row["pictures_used"], len(PICTURES))
        self.assertLess(self.row["residual_rms_px"], 0.03)
        self.assertEqual(self.row["warnings"], [])

    def test_the_lens_lies_in_its_stated_region(self):
        lens = self.row["lens"]
        values = [lens.get(f"{name}_px", lens.get(name)) for name in LENS]
        error = [self.truth["camera"][name] - value for name, value in zip(LENS, values)]
        distance = chi2(error, self.row["covariance_intrinsics"])
        print(f"lens: chi2 {distance:.1f} of 8")
        self.assertLess(distance, CHI2_95_OF_8)
        self.assertLess(abs(error[0]), 1.0)  # and the region says something

    def test_the_camera_on_the_detector_lies_in_its_stated_region(self):
        distance = self.mounting_chi2(self.row)
        print(f"camera on the detector: chi2 {distance:.2f} of 6")
        self.assertLess(distance, CHI2_95_OF_6)

    def test_so_it_does_where_the_head_is_said_to_stand_without_error(self):
        """In these pictures it does; what is left is the camera's own uncertainty."""
        result = run("calibrate", "--grid", "a0-25", "--json", "--out", self.out.with_name("exact"),
                     "--footprint", "350,0,0", "--footprint-sigma", "0,0", *PICTURES)
        row = json.loads(result.stdout)
        distance = self.mounting_chi2(row)
        print(f"camera on the detector, exact footprint: chi2 {distance:.2f} of 6")
        self.assertLess(distance, CHI2_95_OF_6)
        self.assertLess(math.dist(row["t_detector_camera_m"], self.truth["t_detector_camera_m"]),
                        0.2e-3)

    def test_the_file_holds_the_very_numbers_of_the_result(self):
        lens = self.row["lens"]
        self.assertEqual(numbers_of_file(self.out, "data")[0], lens["fx_px"])
        for key, name in (("R_detector_camera", "R_detector_camera"),
                          ("covariance_intrinsics", "covariance_intrinsics"),
                          ("covariance_detector_camera", "covariance_detector_camera")):
            self.assertEqual(numbers_of_file(self.out, key), sum(self.row[name], []))
        self.assertEqual(numbers_of_file(self.out, "t_detector_camera_m"),
                         self.row["t_detector_camera_m"])
        self.assertRegex(self.out.read_text(), r'camera_name: "lift"')
        self.assertRegex(self.out.read_text(), r'date: "20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ"')

    def test_the_file_locates_the_bar_as_well_as_the_true_camera(self):
        errors = []
        for picture in sorted((DATA / "bar").glob("*.png")):
            truth = json.loads(picture.with_suffix(".json").read_text())
            result = run("locate", "--json", "--require", "located", "--tilt-deg",
                         truth["bar_tilt_deg"], "--camera", self.out, picture)
            self.assertEqual(result.returncode, 0, result.stderr)
            row = json.loads(result.stdout)
            self.assertEqual(row["covariance_includes"],
                             ["image", "intrinsics", "detector_camera"])
            errors.append(1e3 * math.dist(row["t_ground_detector_m"],
                                          truth["t_ground_detector_m"]))
            print(f"{picture.name}: detector {errors[-1]:.3f} mm, camera "
                  f"{position_error_mm(row, truth):.3f} mm")
        self.assertEqual(len(errors), 4)
        self.assertLess(rms(errors), 0.6)

    def test_the_detectors_pose_lies_in_its_stated_region(self):
        """With the head said to stand without error, lens and image are all that is left."""
        exact = self.out.with_name("exact.yaml")
        run("calibrate", "--grid", "a0-25", "--footprint-sigma", "0,0", "--out", exact, *PICTURES)
        for picture in sorted((DATA / "bar").glob("*.png")):
            truth = json.loads(picture.with_suffix(".json").read_text())
            row = json.loads(run("locate", "--json", "--tilt-deg", truth["bar_tilt_deg"],
                                 "--camera", exact, picture).stdout)
            error = rotation_vector(row["R_ground_detector"], truth["R_ground_detector"])
            error += [t - m for t, m in zip(truth["t_ground_detector_m"],
                                            row["t_ground_detector_m"])]
            distance = chi2(error, row["covariance_ground_detector"])
            print(f"{picture.name}: detector chi2 {distance:.1f} of 6")
            self.assertLess(distance, CHI2_999_OF_6)

    def test_a_footprint_counts_for_the_picture_it_names(self):
        """The head named 10 mm further right puts the camera 10 mm further left on it. A copy of
        the picture is no second witness, and is left out."""
        copy = self.out.with_name("again.png")
        copy.write_bytes(PICTURES[0].read_bytes())
        result = run("calibrate", "--grid", "a0-25", "--json", "--out", self.out.with_name("two"),
                     "--footprint-image", f"{PICTURES[0]}=350,10,0", *PICTURES, "--footprint-image",
                     f"{copy}=350,0,0")
        row = json.loads(result.stdout)
        self.assertEqual([place["y_m"] for place in row["footprints"]], [0.01])
        self.assertAlmostEqual(row["t_detector_camera_m"][1],
                               self.row["t_detector_camera_m"][1] - 0.01, places=4)
        self.assertIn(f"{copy}: left out: is the same picture as {PICTURES[0]}", result.stderr)
        self.assertIn(f"{copy}: is not used, so its footprint does not count", result.stderr)


if __name__ == "__main__":
    unittest.main()
