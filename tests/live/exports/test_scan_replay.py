# SPDX-License-Identifier: Apache-2.0
"""opms replay: a scan's poses and pairs once more."""
import csv
import json
import os
import shutil
import sqlite3
import unittest

from scan_kit import (BAR, FRAMES, INPUT, OK, RESULT, ScanTest, make_scan, opms, pictures_of)


def summary_of(found):
    return found[-1]


class SameCode(ScanTest):
    def test_the_stored_pictures_give_the_same_poses_to_the_last_bit(self):
        found = self.run_json("replay", self.scan)
        self.assertEqual([row["picture"] for row in found[:-1]], list(range(1, FRAMES + 1)))
        self.assertTrue(all(row["identical"] and row["position_mm"] == 0 for row in found[:-1]))
        summary = summary_of(found)
        self.assertEqual((summary["schema"], summary["compared"], summary["identical"]),
                         ("opms.replay.summary/1", FRAMES, FRAMES))
        self.assertTrue(summary["same_code"] and summary["same_camera"])
        self.assertEqual(summary["position_most_mm"], 0)

    def test_the_reference_points_give_the_same_poses_to_the_last_bit(self):
        summary = summary_of(self.run_json("replay", self.scan, "--from", "points"))
        self.assertEqual((summary["from"], summary["compared"], summary["identical"]),
                         ("points", FRAMES, FRAMES))

    def test_without_pictures_the_points_are_taken(self):
        make_scan(self.folder, "bare", "pictures=0", "frames=7")
        summary = summary_of(self.run_json("replay", self.folder / "bare"))
        self.assertEqual((summary["from"], summary["identical"]), ("points", 7))

    def test_every_third_picture_needs_not_the_ones_between(self):
        found = self.run_json("replay", self.scan, "--every", 3)
        self.assertEqual([row["picture"] for row in found[:-1]], [1, 4, 7, 10, 13])
        self.assertTrue(all(row["identical"] for row in found[:-1]))

    def test_a_scan_with_every_second_picture_is_replayed_as_far_as_there_are_pictures(self):
        make_scan(self.folder, "half", "pictures=2", "frames=8")
        summary = summary_of(self.run_json("replay", self.folder / "half"))
        self.assertEqual((summary["compared"], summary["identical"], summary["left_out"]),
                         (4, 4, 4))

    def test_pairs_are_made_again_and_are_the_same(self):
        summary = summary_of(self.run_json("replay", self.scan, "--pair"))
        self.assertEqual((summary["pairs"]["triggers"], summary["pairs"]["frames"]),
                         (FRAMES, FRAMES))
        self.assertEqual((summary["pairs"]["triggers_changed"],
                          summary["pairs"]["frames_changed"]), (0, 0))
        self.assertTrue(summary["pairs"]["sums_hold"])

    def test_a_name_in_the_folder_of_scans_is_enough(self):
        environment = {**os.environ, "OPMS_SCANS": str(self.scans)}
        result = opms("replay", "one", "--every", 14, env=environment)
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("1 poses from pictures: 1 identical", result.stdout)

    def test_out_holds_the_new_poses_and_what_changed(self):
        self.run_json("replay", self.scan, "--out", self.folder / "again")
        lines = (self.folder / "again" / "poses.jsonl").read_text().splitlines()
        poses = [json.loads(line) for line in lines]
        for pose, true in zip(poses, self.truth["poses"]):
            self.assertEqual(pose["t_ground_detector_m"], true["t_ground_detector_m"])
        with open(self.folder / "again" / "changes.csv", newline="", encoding="utf-8") as file:
            changes = list(csv.DictReader(file))
        self.assertEqual([row["identical"] for row in changes], ["1"] * FRAMES)


class Changed(ScanTest):
    def test_one_pose_that_was_recorded_otherwise_is_found_and_exits_with_1(self):
        make_scan(self.folder, "spoilt", "spoil=9")
        found = self.run_json("replay", self.folder / "spoilt", code=RESULT)
        changed = [row for row in found[:-1] if not row["identical"]]
        self.assertEqual([(row["picture"], row["differs"]) for row in changed],
                         [(9, ["detector"])])
        self.assertAlmostEqual(changed[0]["position_mm"], 1.0, places=9)
        self.assertAlmostEqual(summary_of(found)["position_rms_mm"], 1 / FRAMES ** 0.5, places=9)

    def test_one_bit_of_a_recorded_edge_is_found(self):
        make_scan(self.folder, "bit", "frames=4")
        with sqlite3.connect(self.folder / "bit" / "scan.sqlite") as book:
            edges = bytearray(book.execute("SELECT edges FROM locations WHERE number = 3")
                              .fetchone()[0])
            edges[-8] ^= 1  # the lowest bit of the last edge's last number
            book.execute("UPDATE locations SET edges = ? WHERE number = 3", (bytes(edges),))
        book.close()
        found = self.run_json("replay", self.folder / "bit", code=RESULT)
        self.assertEqual([row["differs"] for row in found[:-1]], [[], [], ["edges"], []])

    def test_a_pair_that_was_recorded_otherwise_is_found_and_exits_with_1(self):
        make_scan(self.folder, "swapped", "swap=9")
        found = self.run_json("replay", self.folder / "swapped", "--pair", "--every", 14,
                              code=RESULT)
        changed = [row for row in found if row["schema"] == "opms.replay.pair/1"]
        frames = [row for row in changed if "picture" in row]
        self.assertEqual([(row["picture"], row["now"]["trigger"], row["recorded"]["trigger"])
                          for row in frames], [(9, 9, 10)])

    def test_another_camera_file_moves_the_poses_and_is_no_failure(self):
        text = (BAR / "camera.yaml").read_text()
        self.assertIn("585.0", text)
        other = self.folder / "other.yaml"
        other.write_text(text.replace("585.0", "586.0"))
        found = self.run_json("replay", self.scan, "--camera", other)
        summary = summary_of(found)
        self.assertFalse(summary["same_camera"])
        self.assertEqual(summary["identical"], 0)
        # A focal length that is 1.7 in 1,000 longer: 0.5 m away, that is a millimetre or so.
        self.assertTrue(0.1 < summary["position_rms_mm"] < 5, summary)

    def test_the_same_camera_in_another_file_is_the_same_camera(self):
        copy = self.folder / "copy.yaml"
        shutil.copy(BAR / "camera.yaml", copy)
        summary = summary_of(self.run_json("replay", self.scan, "--camera", copy))
        self.assertTrue(summary["same_camera"])
        self.assertEqual(summary["identical"], FRAMES)

    def test_other_code_is_told_and_differences_are_then_no_failure(self):
        make_scan(self.folder, "old", "spoil=2", "frames=4")
        with sqlite3.connect(self.folder / "old" / "scan.sqlite") as book:
            book.execute("UPDATE scan_header SET value = ? WHERE key = 'versions_json'",
                         ('{"opms":"0.0.1","code":"0000000000000000"}',))
        book.close()
        result = opms("replay", self.folder / "old")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("4 poses from pictures: 3 identical", result.stdout)
        self.assertIn('other code: {"opms":"0.0.1"', result.stdout)


class BadInput(ScanTest):
    def test_a_missing_folder_is_said(self):
        self.refused("replay", self.folder / "none", says="none")

    def test_half_a_picture_is_named_and_the_others_are_done(self):
        scan = self.folder / "torn"
        shutil.copytree(self.scan, scan)
        torn = pictures_of(scan)[4]
        torn.write_bytes(torn.read_bytes()[:2000])
        found = self.run_json("replay", scan, code=INPUT)
        summary = summary_of(found)
        self.assertEqual((summary["compared"], summary["identical"]), (FRAMES - 1, FRAMES - 1))
        self.assertEqual(len(summary["problems"]), 1)
        self.assertIn(torn.name, summary["problems"][0])

    def test_a_camera_of_another_size_is_an_error(self):
        small = self.folder / "small.yaml"
        small.write_text((BAR / "camera.yaml").read_text().replace("1024", "640"))
        result = opms("replay", self.scan, "--camera", small, "--every", 14)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("1024", result.stderr)

    def test_a_folder_that_cannot_be_made_is_said(self):
        (self.folder / "file").write_text("in the way")
        self.refused("replay", self.scan, "--every", 14, "--out", self.folder / "file",
                     says="file")


if __name__ == "__main__":
    unittest.main()
