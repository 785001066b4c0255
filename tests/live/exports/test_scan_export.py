# SPDX-License-Identifier: Apache-2.0
"""opms export: CSV, and pictures with their poses. Python's csv and opms locate are the judges."""
import csv
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from scan_kit import (EXPOSURE_MIDDLE_NS, FRAMES, INPUT, OK, PREAMBLE, ScanTest, make_scan, opms,
                      pictures_of)

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench"))


def read_csv(path):
    """Rows of a file that must keep to RFC 4180."""
    text = path.read_bytes().decode("utf-8")
    assert text.count("\n") == len(text.splitlines()) or '"' in text
    assert text.endswith("\r\n")
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, strict=True))


def matrix_of(row):
    """Rotation of a row's quaternion."""
    x, y, z, w = (float(row[name]) for name in ("qx", "qy", "qz", "qw"))
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]


def matrix_of_angles(row):
    """Rz(psi) Ry(phi) Rx(theta), as docs/conventions.md has it."""
    psi, phi, theta = (math.radians(float(row[f"{name}_deg"])) for name in ("psi", "phi", "theta"))
    (cz, sz), (cy, sy), (cx, sx) = ((math.cos(a), math.sin(a)) for a in (psi, phi, theta))
    return [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,
            sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,
            -sy, cy * sx, cy * cx]


class CsvFile(ScanTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "scan.csv"
        [self.row] = self.run_json("export", self.scan, "--to", "csv", "--out", self.out)
        self.poses = read_csv(self.out)

    def test_each_picture_has_a_row_with_the_pose_and_its_time(self):
        self.assertEqual(len(self.poses), FRAMES)
        for row, true in zip(self.poses, self.truth["poses"]):
            self.assertEqual(int(row["picture"]), true["number"])
            self.assertEqual(row["state"], "located")
            for name, t_m in zip(("x_mm", "y_mm", "z_mm"), true["t_ground_detector_m"]):
                self.assertAlmostEqual(float(row[name]), 1e3 * t_m, places=9)
            self.assertEqual(int(row["frame_id"]), 500 + true["number"])

    def test_pulses_of_the_run_lie_on_the_scans_axis_to_the_nanosecond(self):
        for row in self.poses[PREAMBLE:]:
            self.assertEqual(row["pair"], "PAIRED")
            number = int(row["trigger"])
            ns = (number - PREAMBLE - 1) * 100_000_000 + EXPOSURE_MIDDLE_NS
            self.assertEqual(row["t_scan_s"], f"{ns // 10**9}.{ns % 10**9:09d}")
            self.assertEqual(row["mid_exposure"], "1")

    def test_pulses_before_the_start_have_negative_times(self):
        self.assertTrue(all(row["t_scan_s"].startswith("-") for row in self.poses[:PREAMBLE]))

    def test_quaternions_and_angles_are_the_same_rotation_as_the_matrix(self):
        for row, true in zip(self.poses, self.truth["poses"]):
            for a, b, c in zip(matrix_of(row), matrix_of_angles(row), true["R_ground_detector"]):
                self.assertAlmostEqual(a, c, places=12)
                self.assertAlmostEqual(b, c, places=12)

    def test_sigmas_are_those_of_the_covariance(self):
        rows = self.run_json("replay", self.scan, "--out", self.folder / "again")
        self.assertTrue(rows[-1]["same_code"])
        lines = (self.folder / "again" / "poses.jsonl").read_text().splitlines()
        for row, line in zip(self.poses, lines):
            covariance = json.loads(line)["covariance_ground_detector"]
            self.assertAlmostEqual(float(row["sigma_y_mm"]), 1e3 * math.sqrt(covariance[4][4]),
                                   places=9)
            self.assertAlmostEqual(float(row["sigma_rx_deg"]),
                                   math.degrees(math.sqrt(covariance[0][0])), places=9)

    def test_sensor_samples_stand_beside_it_with_the_pose_of_their_time(self):
        samples = read_csv(self.folder / "scan-sensors.csv")
        self.assertEqual(self.row["sensor_samples"], 5)
        before, on, between, after, late = samples
        for far in (before, after, late):
            self.assertEqual((far["x_mm"], far["qw"], far["pose_gap_s"]), ("", "", ""))
        second = self.poses[PREAMBLE + 1]
        for name in ("x_mm", "y_mm", "z_mm", "qx", "qy", "qz", "qw"):
            self.assertEqual(on[name], second[name])
        third = self.poses[PREAMBLE + 2]
        for name in ("x_mm", "y_mm", "z_mm"):
            self.assertAlmostEqual(float(between[name]),
                                   (float(second[name]) + float(third[name])) / 2, places=9)
        self.assertEqual(between["pose_gap_s"], "0.100000000")
        self.assertEqual((between["value_0"], between["value_1"], between["value_2"]),
                         ("0.75", "", ""))
        self.assertEqual(json.loads(late["data"]), {"note": 'a "quote", a comma'})

    def test_half_way_the_rotation_is_half_way_from_both_sides(self):
        _, on, between, _, _ = read_csv(self.folder / "scan-sensors.csv")
        third = self.poses[PREAMBLE + 2]

        def angle(a, b):
            m, n = matrix_of(a), matrix_of(b)
            return math.acos(max(-1.0, min(1.0, (sum(p * q for p, q in zip(m, n)) - 1) / 2)))
        self.assertAlmostEqual(angle(on, between), angle(between, third), places=7)
        self.assertAlmostEqual(angle(on, between) * 2, angle(on, third), places=7)

    def test_no_pose_is_made_up_across_a_longer_gap_than_is_allowed(self):
        out = self.folder / "strict.csv"
        self.run_json("export", self.scan, "--to", "csv", "--out", out, "--max-gap-s", 0.05)
        samples = read_csv(self.folder / "strict-sensors.csv")
        self.assertEqual([row["x_mm"] != "" for row in samples],
                         [False, True, False, False, False])

    def test_a_file_that_is_there_is_kept_unless_forced(self):
        self.out.write_text("mine")
        self.refused("export", self.scan, "--to", "csv", "--out", self.out, says="--force")
        self.assertEqual(self.out.read_text(), "mine")
        self.run_json("export", self.scan, "--to", "csv", "--out", self.out, "--force")
        self.assertEqual(len(read_csv(self.out)), FRAMES)


class Pictures(ScanTest):
    def test_opms_locate_finds_in_them_what_the_list_says(self):
        out = self.folder / "pictures"
        self.run_json("export", self.scan, "--to", "pictures", "--out", out)
        listed = json.loads((out / "poses.json").read_text())
        self.assertEqual([row["image"] for row in listed],
                         [f"picture_{n:06d}.png" for n in range(1, FRAMES + 1)])
        found = self.run_json("locate", "--camera", out / "camera.yaml", "--tilt-deg", 19.3,
                              *[out / row["image"] for row in listed])
        for row, now in zip(listed, found):
            self.assertEqual(now["state"], "located")
            gap = math.dist(row["t_ground_detector_m"], now["t_ground_detector_m"])
            self.assertLess(gap, 2e-5)  # without the hint, which they had in the scan

    def test_the_bench_reads_them_as_pictures_with_truth(self):
        try:
            from bench_truth import find_scenes
        except ImportError as missing:
            self.skipTest(str(missing))
        out = self.folder / "pictures"
        self.run_json("export", self.scan, "--to", "pictures", "--out", out)
        scenes = find_scenes(out)
        self.assertEqual(len(scenes), FRAMES)
        for scene, true in zip(scenes, self.truth["poses"]):
            self.assertAlmostEqual(scene.tilt_deg, 19.3)
            composed = scene.ground_bar @ scene.bar_camera @ scene.camera_detector
            for a, b, c in zip(composed.t, scene.ground_detector.t, true["t_ground_detector_m"]):
                self.assertAlmostEqual(a, c, places=9)
                self.assertEqual(b, c)

    def test_the_pictures_are_the_stored_ones_byte_by_byte(self):
        out = self.folder / "pictures"
        self.run_json("export", self.scan, "--to", "pictures", "--out", out)
        self.assertEqual([path.read_bytes() for path in sorted(out.glob("*.png"))],
                         [path.read_bytes() for path in pictures_of(self.scan)])

    def test_an_empty_folder_is_filled_and_a_full_one_is_kept(self):
        out = self.folder / "pictures"
        out.mkdir()
        self.run_json("export", self.scan, "--to", "pictures", "--out", out)
        self.refused("export", self.scan, "--to", "pictures", "--out", out, says="no empty folder")
        self.assertEqual(self.left_in(self.folder), ["pictures"])

    def test_half_a_picture_is_left_out_and_named(self):
        scan = self.folder / "torn"
        shutil.copytree(self.scan, scan)
        torn = pictures_of(scan)[2]
        torn.write_bytes(torn.read_bytes()[:999])
        result = opms("export", scan, "--to", "pictures", "--out", self.folder / "out")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(torn.name, result.stderr)
        self.assertEqual(len(list((self.folder / "out").glob("*.png"))), FRAMES - 1)


class BadInput(ScanTest):
    FORMS = ("csv", "mcap", "pictures")

    def export(self, form, scan=None, out=None):
        return ("export", scan or self.scan, "--to", form, "--out", out or self.folder / "out")

    def test_no_scan_gives_a_message_and_no_file(self):
        (self.folder / "empty").mkdir()
        for form in self.FORMS:
            for scan in ("none", "empty"):
                with self.subTest(form=form, scan=scan):
                    self.refused(*self.export(form, self.folder / scan), says=scan)
                    self.assertEqual(self.left_in(self.folder), ["empty"])

    def test_a_damaged_database_gives_a_message_and_no_file(self):
        scan = self.folder / "damaged"
        shutil.copytree(self.scan, scan)
        book = scan / "scan.sqlite"
        book.write_bytes(book.read_bytes()[:4096] + b"\x5a" * (book.stat().st_size - 4096))
        for form in self.FORMS:
            with self.subTest(form=form):
                self.refused(*self.export(form, scan), says="damaged")
                self.assertEqual(self.left_in(self.folder), ["damaged"])

    def test_a_full_disk_leaves_nothing_and_says_why(self):
        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
        for form in self.FORMS:
            with self.subTest(form=form):
                command = [os.environ["OPMS"], *map(str, self.export(form))]
                # A file that may not grow fails as a full disk does, in the middle of writing.
                result = subprocess.run(["/bin/sh", "-c", 'trap "" XFSZ; exec "$@"', "sh",
                                         *command], preexec_fn=small_files, capture_output=True,
                                        text=True, timeout=120)
                self.assertEqual(result.returncode, INPUT, result.stderr)
                self.assertIn("nothing of", result.stderr)
                self.assertEqual(self.left_in(self.folder), [])

    def test_a_folder_that_is_not_there_is_said(self):
        for form in self.FORMS:
            with self.subTest(form=form):
                self.refused(*self.export(form, out=self.folder / "no" / "out"), says="No such")

    def test_a_scan_without_poses_with_time_is_exported(self):
        make_scan(self.folder, "none", "frames=0", "samples=0")
        for form, name in (("csv", "a.csv"), ("mcap", "a.mcap"), ("pictures", "a")):
            [row] = self.run_json(*self.export(form, self.folder / "none", self.folder / name))
            self.assertEqual((row["poses"], row["pictures"]), (0, 0))
        self.assertEqual(opms("export", self.scan, "--to", "csv").returncode, 2)
        self.assertEqual(OK, 0)


if __name__ == "__main__":
    unittest.main()
