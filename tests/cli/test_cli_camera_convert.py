# SPDX-License-Identifier: Apache-2.0
"""opms camera: what a file says, and the same camera for other programs and back."""
import json
import os
import unittest

from cli_kit import CAMERA, INPUT, OK, USAGE, CliTest, opms, rows

COVARIANCES = (
    "  covariance_intrinsics: [" + ", ".join("0.01" if i % 9 == 0 else "0" for i in range(64)) +
    "]\n  covariance_detector_camera: [" +
    ", ".join("1e-6" if i % 7 == 0 else "0" for i in range(36)) + "]\n")
CHAIN = """\
cam0:
  camera_model: pinhole
  intrinsics: [60.0, 61.0, 31.5, 23.5]
  distortion_model: radtan
  distortion_coeffs: [-0.1, 0.02, 0.001, -0.001]
  resolution: [64, 48]
  T_cam_imu: [[1, 0], [0, 1]]
"""


class Show(CliTest):
    def show(self, content, *arguments):
        return opms("camera", "show", *arguments, self.write("shown.yaml", content))

    def test_lens_view_mounting_and_what_is_missing_are_told(self):
        result = self.show(CAMERA + "  shelf: 7\nvendor: some\n")
        self.assertEqual(result.returncode, OK, result.stderr)
        for words in ("ros, pictures of 64 x 48 px, camera 'test'", "fx px", "60.000", "in sight:",
                      "place mm", "-100.00", "missing: covariance_intrinsics",
                      "missing: covariance_detector_camera",
                      "also in the file: vendor, opms.shelf"):
            self.assertIn(words, result.stdout)

    def test_the_json_object_holds_the_same(self):
        [row] = rows(self.show(CAMERA + COVARIANCES, "--json"))
        self.assertEqual(row["schema"], "opms.camera/1")
        self.assertEqual((row["format"], row["name"]), ("ros", "test"))
        self.assertEqual(row["lens"]["fy_px"], 60.0)
        self.assertEqual(row["covariance_intrinsics"][7][7], 0.01)
        self.assertEqual(row["t_detector_camera_m"], [-0.1, 0.0, 0.4])
        # A pinhole of 64 px at f = 60 px sees 56 degrees; its barrel distortion, some more.
        self.assertTrue(56 < row["view_deg"][0] < 60, row["view_deg"])
        self.assertEqual([gap["key"] for gap in row["missing"]],
                         ["covariance_detector_camera_intrinsics"])

    def test_what_lens_and_mounting_share_needs_both_and_must_fit_them(self):
        shared = "  covariance_detector_camera_intrinsics: [{}" + ", 0" * 47 + "]\n"
        [row] = rows(self.show(CAMERA + COVARIANCES + shared.format("9e-5"), "--json"))
        self.assertEqual(row["covariance_detector_camera_intrinsics"][0][0], 9e-5)
        self.assertEqual(row["missing"], [])
        result = self.show(CAMERA + COVARIANCES + shared.format("2e-4"))
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("correlation above 1", result.stderr)
        result = self.show(CAMERA + shared.format("9e-5"), "--json")
        self.assertIn("stands without covariance_intrinsics", result.stderr)
        self.assertNotIn("covariance_detector_camera_intrinsics", rows(result)[0])


class Convert(CliTest):
    def convert(self, *arguments):
        return opms("camera", "convert", *arguments)

    def assert_same_camera(self, a, b):
        [m], [n] = (rows(opms("camera", "show", "--json", path)) for path in (a, b))
        for row in (m, n):
            row.pop("file")
            row.pop("format")
        self.assertEqual(m, n)

    def test_every_format_and_back_is_the_same_camera(self):
        start = self.write("start.yaml", CAMERA + COVARIANCES + "  shelf: 7\nvendor: [1, two]\n")
        there, back = self.folder / "there", self.folder / "back.yaml"
        for name in ("ros", "opencv-yaml", "opencv-xml", "kalibr"):
            with self.subTest(format=name):
                result = self.convert(start, there, "--to", name)
                self.assertEqual(result.returncode, OK, result.stderr)
                [row] = rows(opms("camera", "show", "--json", there))
                self.assertEqual(row["format"], name)
                self.assertEqual(self.convert(there, back).returncode, OK)
                self.assert_same_camera(start, back)
                there.unlink()
                back.unlink()

    def test_the_name_says_the_format_where_it_can(self):
        out = self.folder / "camera.xml"
        self.assertEqual(self.convert(self.camera, out).returncode, OK)
        self.assertTrue(out.read_text().startswith("<?xml"))
        result = self.convert(self.camera, self.folder / "camera.txt")
        self.assertEqual(result.returncode, USAGE)
        self.assertIn("--to ros|opencv-yaml|opencv-xml|kalibr", result.stderr)
        self.assertEqual(self.convert(self.camera, out, "--to", "tiff").returncode, USAGE)

    def test_what_a_chain_of_kalibr_holds_besides_goes_along(self):
        chain, out = self.write("chain.yaml", CHAIN), self.folder / "out.yaml"
        self.assertEqual(self.convert(chain, out).returncode, OK)
        self.assertIn("T_cam_imu: [[1, 0], [0, 1]]\n", out.read_text())
        self.assertIn('camera_name: "cam0"\n', out.read_text())

    def test_a_camera_of_several_is_taken_by_its_name(self):
        chain = self.write("two.yaml", CHAIN + CHAIN.replace("cam0", "cam1").replace("60.0", "70"))
        out = self.folder / "out.yaml"
        result = self.convert(chain, out)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("holds 2 cameras (cam0, cam1)", result.stderr)
        self.assertFalse(out.exists())
        result = self.convert(chain, out, "--cam", "cam1")
        self.assertEqual(result.returncode, OK)
        self.assertIn("cam0 is another camera", result.stderr)
        self.assertIn("data: [70.0,", out.read_text())

    def test_what_opencv_cannot_hold_is_told(self):
        start = self.write("start.yaml", CAMERA + "\"007\": bond\nempty: []\nfine: 1\n")
        out = self.folder / "out.xml"
        result = self.convert(start, out)
        self.assertEqual(result.returncode, OK)
        for name in ("007", "empty"):
            self.assertIn(f"{out}: {name} cannot be told to OpenCV", result.stderr)
        self.assertIn("<fine>1</fine>", out.read_text())

    def test_what_stands_there_and_is_no_camera_file_is_not_overwritten(self):
        out = self.write("list.yaml", "shopping: [bread]\n")
        for name in ("ros", "opencv-yaml", "opencv-xml", "kalibr"):
            result = self.convert(self.camera, out, "--to", name)
            self.assertEqual(result.returncode, INPUT)
            self.assertIn("not overwritten", result.stderr)
        self.assertEqual(out.read_text(), "shopping: [bread]\n")
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ["blank.png", "camera.yaml", "list.yaml"])

    def test_a_file_may_be_converted_in_its_place(self):
        self.write("camera.yaml", CAMERA + "vendor: some\n")
        before = opms("camera", "show", "--json", self.camera)
        self.assertEqual(self.convert(self.camera, self.camera, "--to", "opencv-yaml").returncode,
                         OK)
        after = opms("camera", "show", "--json", self.camera)
        old, new = json.loads(before.stdout), json.loads(after.stdout)
        self.assertEqual(new.pop("format"), "opencv-yaml")
        self.assertEqual(old.pop("format"), "ros")
        self.assertEqual(old, new)

    def test_any_command_takes_any_format(self):
        out = self.folder / "camera.xml"
        self.assertEqual(self.convert(self.camera, out).returncode, OK)
        result = self.locate("--json", self.blank, camera=out)
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(rows(result)[0]["state"], "absent")


if __name__ == "__main__":
    unittest.main()
