# SPDX-License-Identifier: Apache-2.0
"""opms calibrate --check: pictures say whether a camera file still holds. To a check it is the same
whether the lens has changed or the file, so here the file does."""
import json
import math
import re
import tempfile
import unittest
from pathlib import Path

from cli_kit import CAMERA, DATA, INPUT, OK, RESULT, USAGE, CliTest, opms, png, rows

PICTURES = sorted((DATA / "grid").glob("*.png"))


def changed(text, key, change):
    """The text with another list of numbers for a key."""
    match = re.search(rf"(\b{key}:(?:\n  rows.*\n  cols.*\n  data:)?) \[(.*)\]", text)
    numbers = change([float(n) for n in match[2].split(",")])
    return text[:match.start()] + f"{match[1]} {numbers}" + text[match.end():]


def turned(R, degrees, axis):
    """The rotation, the camera turned about one of the detector's axes."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = [k for k in range(3) if k != axis]
    out = list(R)
    for k in range(3):
        out[3 * i + k] = c * R[3 * i + k] - s * R[3 * j + k]
        out[3 * j + k] = s * R[3 * i + k] + c * R[3 * j + k]
    return out


class Check(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.good = Path(cls.kept.name) / "good.yaml"
        result = opms("calibrate", "--grid", "a0-25", "--out", cls.good, *PICTURES)
        assert result.returncode == OK, result.stderr

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def check(self, camera, *arguments):
        return opms("calibrate", "--grid", "a0-25", "--check", camera, *arguments)

    def verdict(self, result, name):
        [row] = rows(result)
        self.assertEqual(row["schema"], "opms.calibrate_check/1")
        self.assertEqual(row["verdict"], name, row["reason"])
        self.assertEqual(result.returncode, {"valid": OK, "error": INPUT}.get(name, RESULT))
        return row

    def touched(self, key, change):
        return self.write("touched.yaml", changed(self.good.read_text(), key, change))

    def test_a_file_that_was_left_alone_is_valid(self):
        row = self.verdict(self.check(self.good, "--json", *PICTURES), "valid")
        self.assertLess(row["lens"]["chi2"], row["lens"]["chi2_limit"])
        self.assertEqual(row["mountings"], [])
        self.assertIn("nothing is known", row["reason"])
        self.assertEqual(len(row["pictures"]), len(PICTURES))

    def test_so_is_its_mounting_by_a_picture_on_the_footprint(self):
        row = self.verdict(self.check(self.good, "--json", "--footprint", "350,0,0", *PICTURES),
                           "valid")
        [mounting] = row["mountings"]
        self.assertEqual(mounting["image"], str(PICTURES[0]))
        self.assertLess(mounting["chi2"], mounting["chi2_limit"])
        self.assertEqual(row["reason"], "lens and mounting are as stated")

    def test_a_focal_length_off_by_half_a_percent_is_found(self):
        camera = self.touched("camera_matrix",
                              lambda k: [k[0] * 1.005, 0, k[2], 0, k[4] * 1.005, k[5], 0, 0, 1])
        row = self.verdict(self.check(camera, "--json", *PICTURES), "lens_touched")
        self.assertIn("calibrate again", row["advice"])
        self.assertLess(row["alone"]["lens"]["fx_px"], 587)

    def test_a_centre_off_by_five_pixels_is_found(self):
        camera = self.touched("camera_matrix",
                              lambda k: [k[0], 0, k[2] + 5, 0, k[4], k[5], 0, 0, 1])
        self.verdict(self.check(camera, "--json", *PICTURES), "lens_touched")

    def test_a_camera_turned_on_the_detector_by_half_a_degree_is_found(self):
        for axis in (0, 1):
            camera = self.touched("R_detector_camera", lambda R, a=axis: turned(R, 0.5, a))
            row = self.verdict(self.check(camera, "--json", "--footprint", "350,0,0", *PICTURES),
                               "camera_moved")
            turn = math.degrees(math.hypot(*row["mountings"][0]["change"][:3]))
            self.assertAlmostEqual(turn, 0.5, delta=0.1)
            self.verdict(self.check(camera, "--json", *PICTURES), "valid")  # not asked about

    def test_a_turn_about_the_vertical_shows_where_the_head_is_placed_well(self):
        camera = self.touched("R_detector_camera", lambda R: turned(R, 0.5, 2))
        # What the file was calibrated with is in its covariance: the head placed to 0.2 degrees.
        row = self.verdict(self.check(camera, "--json", "--footprint", "350,0,0", PICTURES[0],
                                      *PICTURES[1:]), "valid")
        self.assertGreater(math.degrees(row["mountings"][0]["shows_turn_rad"][2]), 0.5)
        exact = self.folder / "exact.yaml"
        result = opms("calibrate", "--grid", "a0-25", "--footprint-sigma", "0.2,0.03", "--out",
                      exact, *PICTURES)
        self.assertEqual(result.returncode, OK, result.stderr)
        exact.write_text(changed(exact.read_text(), "R_detector_camera",
                                 lambda R: turned(R, 0.5, 2)))
        self.verdict(self.check(exact, "--json", "--footprint", "350,0,0", "--footprint-sigma",
                                "0.2,0.03", *PICTURES), "camera_moved")

    def test_one_picture_gets_an_answer_and_says_how_sharp_it_is(self):
        [row] = rows(self.check(self.good, "--json", PICTURES[-1]))
        self.assertIn(row["verdict"], ("valid", "cannot_tell"))
        self.assertGreater(row["lens"]["shows_focal"], 0)
        self.assertNotIn("alone", row)

    def test_the_text_tells_figures_and_verdict(self):
        result = self.check(self.good, "--footprint", "350,0,0", *PICTURES)
        self.assertEqual(result.returncode, OK, result.stderr)
        for words in ("chi2", "would have shown", "mounting, ", f"{self.good}: VALID",
                      "by themselves"):
            self.assertIn(words, result.stdout)

    def test_the_file_is_not_written_to(self):
        before = self.good.read_bytes()
        self.check(self.good, *PICTURES)
        self.assertEqual(self.good.read_bytes(), before)

    def test_bad_input_is_told_and_exits_with_4(self):
        small = self.check(self.camera, "--json", PICTURES[0])
        self.assertIn("is 1024 x 768 px, but the camera file is for 64 x 48",
                      self.verdict(small, "error")["reason"])
        text = self.write("text.png", "no picture")
        self.assertIn(str(text), self.verdict(self.check(self.good, "--json", text),
                                              "error")["reason"])
        blank = self.write("large.png", png(1024, 768))
        self.assertIn("no grid is seen", self.verdict(self.check(self.good, "--json", blank),
                                                      "error")["reason"])
        result = self.check(self.folder / "none.yaml", PICTURES[0])
        self.assertEqual((result.returncode, result.stdout), (INPUT, ""))
        unmounted = self.write("unmounted.yaml", CAMERA[:CAMERA.index("opms:")])
        result = self.check(unmounted, "--footprint", "350,0,0", PICTURES[0])
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("does not say where the camera sits", result.stderr)

    def test_a_file_is_checked_or_written_and_not_both(self):
        for arguments in (("--check", self.good, "--out", self.folder / "out.yaml"), ()):
            result = opms("calibrate", "--grid", "a0-25", *arguments, PICTURES[0])
            self.assertEqual(result.returncode, USAGE, result.stderr)

    def test_a_file_of_opencv_without_covariance_can_be_checked(self):
        other = self.folder / "theirs.xml"
        text = self.good.read_text()
        bare = self.write("bare.yaml", text[:text.index("opms:")])
        self.assertEqual(opms("camera", "convert", bare, other).returncode, OK)
        row = self.verdict(self.check(other, "--json", *PICTURES), "valid")
        self.assertTrue(row["lens"]["covariance_assumed"])
        self.assertEqual(json.dumps(row).count("NaN"), 0)


if __name__ == "__main__":
    unittest.main()
