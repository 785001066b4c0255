# SPDX-License-Identifier: Apache-2.0
"""opms calibrate: what it refuses, and that a camera file is there whole or not at all."""
import os
import unittest

from cli_kit import CAMERA, DATA, INPUT, OK, USAGE, CliTest, opms, png, rows
from grey_png import grey_pixels, pgm

PICTURES = sorted((DATA / "grid").glob("*.png"))


def with_hidden_marker(path):
    """A picture as PGM in which something grey lies on the marker, which is near its middle."""
    width, height, pixels = grey_pixels(path.read_bytes())
    pixels = bytearray(pixels)
    for row in range(330, 430):
        pixels[row * width + 530:row * width + 650] = bytes([90]) * 120
    return pgm(width, height, pixels)


class Calibrate(CliTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out" / "camera.yaml"
        self.out.parent.mkdir()

    def calibrate(self, *arguments, out=None):
        return opms("calibrate", "--grid", "a0-25", "--out", out or self.out, *arguments)

    def assert_no_file(self):
        self.assertEqual(list(self.out.parent.iterdir()), [])

    def test_wrong_use_exits_with_2_and_says_why_on_stderr(self):
        good = ["calibrate", "--grid", "a0-25", "--out", self.out]
        calls = [["calibrate"], good, ["calibrate", "--grid", "a0-25", self.blank],
                 ["calibrate", "--out", self.out, self.blank],
                 ["calibrate", "--grid", "a0-30", "--out", self.out, self.blank]]
        for footprint in ("350", "350,0", "350,0,0,0", "350,0,nan", "350,0,x", "1e9,0,0", "",
                          "350,0,0 ", "350;0;0"):
            calls.append([*good, f"--footprint={footprint}", self.blank])
        for sigma in ("0.5", "-0.5,0.1", "0.5,-0.1", "0.5,inf", "1,2,3"):
            calls.append([*good, f"--footprint-sigma={sigma}", self.blank])
        for place in ("a.png", "=350,0,0", "a.png=350,0"):
            calls.append([*good, f"--footprint-image={place}", self.blank])
        calls.append([*good, "--footprint", "350,0,0", self.blank, "--footprint-image",
                      f"{self.blank}=350,0,0"])
        calls.append([*good, self.blank, "--footprint-image", "b.png=350,0,0",
                      "--footprint-image", "b.png=350,1,0"])
        for call in calls:
            with self.subTest(call=call):
                result = opms(*call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertNotEqual(result.stderr, "")
        self.assert_no_file()

    def test_pictures_of_mixed_sizes_are_refused_by_name(self):
        other = self.write("other.png", png(80, 60))
        result = self.calibrate("--json", *PICTURES, other)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("mixed sizes", result.stderr)
        self.assertIn("80 x 60", result.stderr)
        self.assertIn(str(other), result.stderr)
        [row] = rows(result)
        self.assertEqual((row["schema"], row["state"]), ("opms.calibrate/1", "error"))
        self.assertIn("mixed sizes", row["reason"])
        self.assert_no_file()

    def test_a_file_that_is_no_picture_is_refused_by_name(self):
        text = self.write("text.png", "no picture")
        result = self.calibrate(*PICTURES, text)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(f"{text}: is no picture", result.stderr)
        self.assert_no_file()

    def test_pictures_without_a_grid_are_left_out_and_too_few_remain(self):
        blank = self.write("large.png", png(1024, 768))
        result = self.calibrate(PICTURES[0], PICTURES[1], blank)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(f"{blank}: left out: no grid is seen", result.stderr)
        self.assertIn("2 usable pictures; at least 3", result.stderr)
        self.assert_no_file()

    def test_one_picture_many_times_is_one_picture(self):
        result = self.calibrate(*[PICTURES[0]] * 4)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("is the same picture as", result.stderr)
        self.assertIn("1 usable picture; at least 3", result.stderr)
        self.assert_no_file()

    def test_without_a_picture_on_the_footprint_there_is_no_file(self):
        blank = self.write("large.png", png(1024, 768))
        result = self.calibrate(blank, *PICTURES)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("no picture on the footprint can be used", result.stderr)
        self.assertIn(str(blank), result.stderr)
        self.assert_no_file()

    def test_a_hidden_marker_is_labelled_from_the_picture_before_or_after(self):
        hidden = self.write("hidden.pgm", with_hidden_marker(PICTURES[0]))
        for pictures in ([PICTURES[0], hidden, *PICTURES[1:]], [hidden, *PICTURES]):
            with self.subTest(first=pictures[0].name):
                result = self.calibrate("--json", *pictures)
                self.assertEqual(result.returncode, OK, result.stderr)
                [row] = rows(result)
                [picture] = [p for p in row["pictures"] if p["image"] == str(hidden)]
                self.assertEqual(picture["labelled_from"], str(PICTURES[0]))
                self.assertIn("marker hidden", result.stderr)
                self.assertLess(abs(row["t_detector_camera_m"][0] + 0.1), 2e-3)

    def test_a_hidden_marker_far_from_any_other_picture_is_left_out_and_said_so(self):
        hidden = self.write("hidden.pgm", with_hidden_marker(PICTURES[0]))
        result = self.calibrate("--json", *PICTURES, hidden)
        [row] = rows(result)
        picture = row["pictures"][-1]
        self.assertEqual(picture["state"], "unlabelled")
        self.assertIn("marker is hidden", picture["left_out"])
        self.assertIn(f"{hidden}: left out: the marker is hidden", result.stderr)

    def test_what_stands_at_out_and_is_no_camera_file_is_not_overwritten(self):
        self.out.write_text("shopping: [bread, milk]\n")
        for out in (self.out, self.out.parent):
            with self.subTest(out=out):
                result = self.calibrate(*PICTURES, out=out)
                self.assertEqual(result.returncode, INPUT)
                self.assertIn(f"{out}: ", result.stderr)
                self.assertIn("not overwritten", result.stderr)
                self.assertEqual(result.stdout, "")
        self.assertEqual(self.out.read_text(), "shopping: [bread, milk]\n")
        gone = self.folder / "gone" / "camera.yaml"
        result = self.calibrate(*PICTURES, out=gone)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("does not exist", result.stderr)

    def test_unknown_keys_of_an_old_file_survive_and_its_own_are_new(self):
        self.out.write_text(CAMERA + "  serial: \"007\"\n"
                            "vendor: {lens: 'f/2: \"wide\"', n: [1, ~]}\nbinning_x: 0\n"
                            "\"007\": !bond |\n  two\n  lines\n")
        os.chmod(self.out, 0o640)
        result = self.calibrate(*PICTURES)
        self.assertEqual(result.returncode, OK, result.stderr)
        text = self.out.read_text()
        self.assertIn('  serial: "007"\n', text)
        self.assertIn('vendor: {lens: "f/2: \\"wide\\"", n: [1, null]}\n', text)
        self.assertIn("binning_x: 0\n", text)
        self.assertIn('"007": !<!bond> "two\\x0alines\\x0a"\n', text)
        self.assertIn('camera_name: "test"\n', text)
        self.assertIn("image_width: 1024\n", text)
        self.assertNotIn("60.0", text)
        self.assertEqual(os.stat(self.out).st_mode & 0o777, 0o640)
        self.assertEqual(list(self.out.parent.iterdir()), [self.out])
        again = self.calibrate("--name", "new: \"name\"", *PICTURES)
        self.assertEqual(again.returncode, OK, again.stderr)
        self.assertIn('camera_name: "new: \\"name\\""\n', self.out.read_text())
        self.assertIn('vendor: {lens: "f/2: \\"wide\\"", n: [1, null]}\n', self.out.read_text())

    def test_the_table_tells_lens_place_and_file(self):
        result = self.calibrate(*PICTURES)
        self.assertEqual(result.returncode, OK)
        for words in ("fx px", "place mm", "turned about it: sigma", "residual",
                      f"written: {self.out}"):
            self.assertIn(words, result.stdout)


if __name__ == "__main__":
    unittest.main()
