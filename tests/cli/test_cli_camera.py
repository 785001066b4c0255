# SPDX-License-Identifier: Apache-2.0
"""The camera file: what is refused names the field and its line, what may be missing may be."""
import unittest

from cli_kit import CAMERA, INPUT, OK, CliTest, rows

COVARIANCE_6 = "[" + ", ".join("1e-8" if i % 7 == 0 else "0" for i in range(36)) + "]"
COVARIANCE_8 = "[" + ", ".join("0.01" if i % 9 == 0 else "0" for i in range(64)) + "]"


def changed(old, new):
    assert CAMERA.count(old) == 1, old
    return CAMERA.replace(old, new)


class BadCameras(CliTest):
    def assert_refused(self, content, *words):
        camera = self.write("bad.yaml", content)
        result = self.locate("--json", self.blank, camera=camera)
        self.assertEqual((result.returncode, result.stdout), (INPUT, ""), result.stderr)
        for word in (str(camera), *words):
            self.assertIn(word, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)

    def test_files_that_are_no_camera_file(self):
        self.assert_refused("", "is not a camera file")
        self.assert_refused("just words", "is not a camera file")
        self.assert_refused("- 1\n- 2\n", "is not a camera file")
        self.assert_refused("a: [1, 2\n", "is not valid YAML", "line 2")
        self.assert_refused(b"a: \0\n", "binary data")
        self.assert_refused("# " + "x" * 1050000, "larger than 1 MiB")
        self.assert_refused("a: &x [*x]\n", "line 1: anchors and aliases")
        self.assert_refused("[" * 30000, "nested too deeply")

    def test_a_missing_file_and_a_folder(self):
        for camera, word in ((self.folder / "none.yaml", "No such file"),
                             (self.folder, "is a directory")):
            result = self.locate(self.blank, camera=camera)
            self.assertEqual((result.returncode, result.stdout), (INPUT, ""))
            self.assertIn(str(camera), result.stderr)
            self.assertIn(word, result.stderr)

    def test_each_missing_field_is_named(self):
        self.assert_refused(changed("image_width: 64\n", ""), "image_width is missing")
        self.assert_refused(changed("image_height: 48\n", ""), "image_height is missing")
        self.assert_refused(changed("distortion_model: plumb_bob\n", ""),
                            "distortion_model is missing")
        self.assert_refused(changed("camera_matrix:", "camera_matrices:"),
                            "camera_matrix is missing")
        self.assert_refused(changed("  cols: 5\n", ""),
                            "line 10: distortion_coefficients.cols is missing")

    def test_a_key_that_appears_twice(self):
        self.assert_refused(CAMERA.replace("image_width: 64", "image_width: 64\nimage_width: 65"),
                            "line 2: image_width appears twice")

    def test_numbers_that_are_none(self):
        for bad in ("nan", ".nan", ".NaN", "inf", "-.inf", "1e999"):
            self.assert_refused(changed("31.5", bad), "line 7: camera_matrix.data[2] is not finite")
        for bad in ("wide", "0x40", "1,5", "[1]", "'6 0'", "~"):
            self.assert_refused(changed("image_width: 64", f"image_width: {bad}"),
                                "line 1: image_width")
        self.assert_refused(changed("-0.1, 0.0, 0.4", "-0.1, 0.0, .nan"),
                            "line 16: opms.t_detector_camera_m[2] is not finite")

    def test_sizes_outside_the_range(self):
        for bad in ("0", "-64", "16385", "64.5"):
            self.assert_refused(changed("image_width: 64", f"image_width: {bad}"),
                                "line 1: image_width must be a whole number from 1 to 16384")

    def test_lists_of_the_wrong_length(self):
        self.assert_refused(changed(", 0.0, 0.0, 1.0]", ", 0.0, 1.0]"),
                            "line 7: camera_matrix.data has 8 numbers, must have 9")
        self.assert_refused(changed("  rows: 3\n", "  rows: 2\n"), "line 5: camera_matrix.rows")
        self.assert_refused(changed("[-0.1, 0.0, 0.4]", "[-0.1, 0.0]"),
                            "opms.t_detector_camera_m has 2 numbers, must have 3")
        self.assert_refused(CAMERA + "  covariance_intrinsics: [1, 2]\n",
                            "line 17: opms.covariance_intrinsics has 2 numbers, must have 64")

    def test_other_camera_models_are_refused_by_name(self):
        self.assert_refused(changed("plumb_bob", "equidistant"),
                            "line 8: distortion_model is 'equidistant'")
        self.assert_refused(changed("plumb_bob", "rational_polynomial"), "rational_polynomial")
        self.assert_refused(changed("-0.001, 0.0]", "-0.001, 0.01]"),
                            "line 12: distortion_coefficients.data has k3 other than 0")
        self.assert_refused(changed("60.0, 0.0, 31.5", "60.0, 0.1, 31.5"), "skew")

    def test_cameras_that_no_one_can_use(self):
        self.assert_refused(changed("[60.0,", "[-60.0,"), "focal length")
        self.assert_refused(changed("-0.1, 0.02", "-9, 0.02"), "the camera cannot be used")

    def test_a_rotation_that_is_none(self):
        self.assert_refused(changed("0, 1, 0, 0, 0, -1]", "0, 1, 0, 0, 0, 1]"),
                            "line 15: opms.R_detector_camera is a mirror image")
        self.assert_refused(changed("[-1, 0, 0, 0, 1,", "[-1, 0, 0, 0.1, 1,"), "is not a rotation")

    def test_covariances_that_are_none(self):
        key = "  covariance_detector_camera: "
        self.assert_refused(CAMERA + key + COVARIANCE_6.replace("1e-8", "-1e-8", 1) + "\n",
                            "line 17: opms.covariance_detector_camera has a negative variance")
        self.assert_refused(CAMERA + key + COVARIANCE_6.replace(" 0,", " 1e-9,", 1) + "\n",
                            "is not symmetric")

    def test_another_version(self):
        self.assert_refused(changed("version: 1", "version: 2"), "line 14: opms.version is not 1")


class GoodCameras(CliTest):
    def assert_taken(self, content, note=""):
        camera = self.write("good.yaml", content)
        result = self.locate("--json", self.blank, camera=camera)
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(rows(result)[0]["state"], "absent")
        self.assertIn(note, result.stderr)
        self.assertEqual(result.stderr == "", note == "")

    def test_the_opms_mapping_and_each_of_its_keys_may_be_missing(self):
        start = CAMERA.index("opms:")
        self.assert_taken(CAMERA[:start])
        self.assert_taken(CAMERA[:start] + "opms:\n")
        self.assert_taken(changed("  version: 1\n", ""))
        self.assert_taken(changed("  t_detector_camera_m: [-0.1, 0.0, 0.4]\n", ""),
                          "there will be no detector pose")

    def test_everything_that_may_be_there(self):
        self.assert_taken(
            CAMERA + f"  covariance_intrinsics: {COVARIANCE_8}\n"
            f"  covariance_detector_camera: {COVARIANCE_6}\n"
            "  grid: a0-25\n  footprint: {x_m: 0.35, y_m: 0, yaw_rad: 0}\n"
            "  residual_rms_px: 0.05\n  date: 2026-01-31T12:00:00Z\n"
            "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n")

    def test_four_coefficients_and_a_byte_order_mark(self):
        self.assert_taken(changed("cols: 5", "cols: 4").replace("-0.001, 0.0]", "-0.001]"))
        self.assert_taken("\ufeff" + CAMERA)

    def test_an_unknown_key_is_noted(self):
        self.assert_taken(CAMERA + "  colour: red\n", "line 17: opms.colour is unknown")


if __name__ == "__main__":
    unittest.main()
