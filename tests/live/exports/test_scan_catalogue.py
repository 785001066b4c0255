# SPDX-License-Identifier: Apache-2.0
"""opms catalogue: which scans there are, whether they are sound, and away with them."""
import os
import shutil
import sqlite3
import subprocess
import unittest

from scan_kit import (BAR, FIXTURE, FRAMES, INPUT, OK, RESULT, USAGE, ScanTest, make_scan, opms,
                      pictures_of, png)


class Lists(ScanTest):
    def catalogue(self, *arguments, **kwargs):
        return self.run_json("catalogue", *arguments, "--folder", self.scans, **kwargs)

    def test_a_scan_is_listed_with_what_it_holds(self):
        [row] = self.catalogue("list")
        self.assertEqual({name: row[name] for name in (
            "schema", "name", "state", "begun", "mode", "triggers", "frames", "pairs", "poses",
            "poses_with_time", "pictures", "sensor_samples")}, {
                "schema": "opms.catalogue/1", "name": "one", "state": "whole",
                "begun": "2026-11-22T14:03:07Z", "mode": "position", "triggers": FRAMES,
                "frames": FRAMES, "pairs": FRAMES, "poses": FRAMES, "poses_with_time": FRAMES,
                "pictures": FRAMES, "sensor_samples": 5})
        self.assertAlmostEqual(row["duration_s"], 2.7, delta=0.01)

    def test_people_get_a_table(self):
        result = opms("catalogue", "list", "--folder", self.scans)
        self.assertEqual(result.returncode, OK)
        self.assertRegex(result.stdout.splitlines()[1], r"^one +2026-11-22T14:03:07Z +whole +2\.7")

    def test_the_environment_names_the_folder(self):
        result = opms("catalogue", "list", env={**os.environ, "OPMS_SCANS": str(self.scans)})
        self.assertIn("one", result.stdout)

    def test_no_scans_are_no_failure(self):
        result = opms("catalogue", "list", "--folder", self.folder)
        self.assertEqual((result.returncode, result.stdout), (OK, ""))
        self.assertIn("no scans", result.stderr)

    def test_no_folder_before_the_first_scan_is_no_failure_but_a_wrong_one_is(self):
        home = {**os.environ, "HOME": str(self.folder)}
        home.pop("OPMS_SCANS", None)
        self.assertEqual(opms("catalogue", "list", env=home).returncode, OK)
        self.refused("catalogue", "list", "--folder", self.folder / "wrong", says="wrong")

    def test_search_by_name_date_and_text(self):
        for options, found in (
                (("--name", "ON"), 1), (("--name", "two"), 0),
                (("--from", "2026-11-22"), 1), (("--from", "2026-11-23"), 0),
                (("--to", "2026-11-22"), 1), (("--to", "2026-11-21"), 0),
                (("--from", "2026-11-22T14:03:07Z"), 1), (("--from", "2026-11-22T14:03:08"), 0),
                (("--text", "UNPLUGGED"), 1), (("--text", "sandpit"), 1),
                (("--text", "fixture, "), 1), (("--text", "nowhere"), 0),
                (("--name", "one", "--text", "nowhere"), 0)):
            with self.subTest(options=options):
                self.assertEqual(len(self.catalogue("search", *options)), found)

    def test_a_date_that_is_none_is_wrong_use(self):
        for date in ("yesterday", "2026-02-31", "2026-11-22T25:00:00", "2026-11-22x"):
            result = opms("catalogue", "search", "--from", date, "--folder", self.scans)
            self.assertEqual(result.returncode, USAGE, date)

    def test_show_tells_the_settings_and_the_events(self):
        page, *events = self.catalogue("show", "one")
        self.assertEqual((page["settings"], page["end_reason"]), ({"place": "Sandpit 3"}, "stop"))
        self.assertTrue(page["pairing"]["sums_hold"])
        self.assertEqual({"scan.begun", "box.lost"} - {event["code"] for event in events}, set())
        text = opms("catalogue", "show", "one", "--folder", self.scans).stdout
        self.assertIn("Sandpit 3", text)
        self.assertIn("warning  box.lost", text)

    def test_a_scan_that_cannot_be_read_is_named_and_the_others_are_listed(self):
        shutil.copytree(self.scan, self.folder / "good")
        (self.folder / "bad").mkdir()
        (self.folder / "bad" / "scan.sqlite").write_text("no database" * 100)
        result = opms("catalogue", "list", "--folder", self.folder)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("good", result.stdout)
        self.assertIn("bad", result.stderr)


class Verify(ScanTest):
    def copy(self):
        scan = self.folder / "copy"
        shutil.copytree(self.scan, scan)
        return scan

    def problems(self, scan, code=RESULT):
        [row] = self.run_json("catalogue", "verify", scan, code=code)
        self.assertFalse(row["sound"])
        return "\n".join(row["problems"])

    def execute(self, scan, statement):
        with sqlite3.connect(scan / "scan.sqlite") as book:
            book.execute(statement)
        book.close()

    def test_a_good_scan_is_sound_and_every_picture_was_looked_at(self):
        [row] = self.run_json("catalogue", "verify", "--folder", self.scans)
        self.assertEqual((row["sound"], row["pictures"], row["problems"]), (True, FRAMES, []))

    def test_a_missing_picture_is_found(self):
        scan = self.copy()
        pictures_of(scan)[3].unlink()
        self.assertIn(pictures_of(self.scan)[3].name, self.problems(scan))

    def test_half_a_picture_is_found(self):
        scan = self.copy()
        torn = pictures_of(scan)[3]
        torn.write_bytes(torn.read_bytes()[:-500])
        self.assertIn(torn.name, self.problems(scan))

    def test_a_picture_of_another_size_is_found(self):
        scan = self.copy()
        pictures_of(scan)[3].write_bytes(png())
        self.assertIn(pictures_of(scan)[3].name, self.problems(scan))

    def test_a_frame_without_a_fate_breaks_the_sums(self):
        scan = self.copy()
        self.execute(scan, "DELETE FROM pairs WHERE frame = 9")
        self.assertIn(f"frames with a fate: {FRAMES - 1}", self.problems(scan))

    def test_a_frame_with_two_fates_is_found(self):
        scan = self.copy()
        self.execute(scan, "UPDATE pairs SET frame = 9, trigger_number = 9 WHERE frame = 10")
        problems = self.problems(scan)
        self.assertIn("frame 9 has two fates", problems)
        self.assertIn("trigger 9 has two fates", problems)

    def test_times_that_fall_are_found(self):
        scan = self.copy()
        self.execute(scan, "UPDATE poses SET t_scan_ns = t_scan_ns - 1000000000 WHERE number = 12")
        self.assertIn("pose 12 lies before", self.problems(scan))

    def test_a_damaged_database_is_found(self):
        scan = self.copy()
        book = bytearray((scan / "scan.sqlite").read_bytes())
        book[4096 * 3:] = b"\x5a" * (len(book) - 4096 * 3)
        (scan / "scan.sqlite").write_bytes(book)
        result = opms("catalogue", "verify", scan)
        self.assertIn(result.returncode, (RESULT, INPUT))
        self.assertIn("problem(s)", result.stdout)

    def test_a_scan_that_was_cut_off_is_mended_and_then_sound(self):
        make_scan(self.folder, "cut", "end=kill")
        [row] = self.run_json("catalogue", "list", "--folder", self.folder)
        self.assertEqual((row["state"], row["poses"]), ("cut off", FRAMES))
        self.assertIn("--mend", self.problems(self.folder / "cut"))
        mended, verdict = self.run_json("catalogue", "verify", "--mend", self.folder / "cut")
        self.assertTrue(mended["needed"] and verdict["sound"], (mended, verdict))
        [row] = self.run_json("catalogue", "list", "--folder", self.folder)
        self.assertEqual((row["state"], row["poses"]), ("recovered", FRAMES))

    def test_mending_what_is_whole_changes_nothing(self):
        scan = self.copy()
        before = (scan / "scan.sqlite").read_bytes()
        mended, verdict = self.run_json("catalogue", "verify", "--mend", scan)
        self.assertEqual((mended["needed"], verdict["sound"]), (False, True))
        self.assertEqual((scan / "scan.sqlite").read_bytes(), before)


class Recording(ScanTest):
    """One that goes on meanwhile."""

    def setUp(self):
        super().setUp()
        self.writer = subprocess.Popen([FIXTURE, str(BAR), str(self.folder), "now", "end=hold"],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.addCleanup(self.writer.wait, 60)
        self.addCleanup(self.writer.stdout.close)
        self.addCleanup(self.writer.stdin.close)
        self.writer.stdout.readline()

    def test_it_is_listed_as_such_and_cannot_be_deleted_or_mended(self):
        [row] = self.run_json("catalogue", "list", "--folder", self.folder)
        self.assertEqual(row["state"], "recording")
        self.refused("catalogue", "delete", "--yes", self.folder / "now", says="being recorded")
        result = opms("catalogue", "verify", "--mend", self.folder / "now")
        self.assertEqual(result.returncode, INPUT)
        self.assertTrue((self.folder / "now" / "scan.sqlite").exists())
        self.assertIsNone(self.writer.poll())

    def test_it_can_be_exported_as_far_as_it_is(self):
        result = opms("export", self.folder / "now", "--to", "csv", "--out",
                      self.folder / "now.csv")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("is being recorded", result.stderr)


class Delete(ScanTest):
    def setUp(self):
        super().setUp()
        self.copy = self.folder / "copy"
        shutil.copytree(self.scan, self.copy)

    def test_a_scan_is_gone_and_nothing_else(self):
        (self.folder / "other").mkdir()
        result = opms("catalogue", "delete", "--yes", "copy", "--folder", self.folder)
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertEqual(self.left_in(self.folder), ["other"])

    def test_without_yes_and_without_a_person_nothing_is_deleted(self):
        result = opms("catalogue", "delete", self.copy, stdin=subprocess.DEVNULL)
        self.assertEqual(result.returncode, USAGE)
        self.assertTrue((self.copy / "scan.sqlite").exists())

    def test_a_folder_that_is_no_scan_is_never_deleted(self):
        plain = self.folder / "plain"
        plain.mkdir()
        (plain / "letter.txt").write_text("dear")
        self.refused("catalogue", "delete", "--yes", plain, says="no folder of a scan")
        self.refused("catalogue", "delete", "--yes", self.folder, says="no folder of a scan")
        (self.folder / "link").symlink_to(self.copy)
        self.refused("catalogue", "delete", "--yes", self.folder / "link", says="no folder")
        self.assertTrue((plain / "letter.txt").exists())
        self.assertTrue((self.copy / "scan.sqlite").exists())

    def test_a_scan_with_a_foreign_file_in_it_is_kept(self):
        for place in (self.copy / "letter.txt", pictures_of(self.copy)[0].parent / "notes.doc"):
            place.write_text("dear")
            self.refused("catalogue", "delete", "--yes", self.copy, says=place.name)
            self.assertTrue((self.copy / "scan.sqlite").exists())
            place.unlink()

    def test_a_damaged_scan_can_be_deleted(self):
        book = self.copy / "scan.sqlite"
        book.write_bytes(book.read_bytes()[:5000])
        self.assertEqual(opms("catalogue", "delete", "--yes", self.copy).returncode, OK)
        self.assertEqual(self.left_in(self.folder), [])


if __name__ == "__main__":
    unittest.main()
