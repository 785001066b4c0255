# SPDX-License-Identifier: Apache-2.0
"""opms locate on pictures that can and cannot be used."""
import os
import struct
import unittest

from cli_kit import INPUT, OK, RESULT, USAGE, CliTest, png, rows
from locate_schema import row_problems


class GoodPictures(CliTest):
    def test_a_picture_without_a_bar_is_absent_and_no_failure(self):
        result = self.locate("--json", self.blank)
        self.assertEqual((result.returncode, result.stderr), (OK, ""))
        [row] = rows(result)
        self.assertEqual((row["state"], row["squares"]), ("absent", []))
        self.assertEqual(list(row_problems(row)), [])

    def test_required_but_absent_exits_with_1(self):
        result = self.locate("--json", "--require", "located", self.blank)
        self.assertEqual(result.returncode, RESULT)
        self.assertEqual(rows(result)[0]["state"], "absent")

    def test_every_depth_and_colour_is_read(self):
        for bits in (8, 16):
            for channels in (1, 3, 4):
                with self.subTest(bits=bits, channels=channels):
                    path = self.write("kind.png", png(bits=bits, channels=channels))
                    result = self.locate("--json", path)
                    self.assertEqual(result.returncode, OK)
                    self.assertEqual(rows(result)[0]["state"], "absent")
                    self.assertEqual("is in colour" in result.stderr, channels > 1)

    def test_a_pgm_of_16_bit_is_read(self):
        path = self.write("p5.pgm", b"P5\n# made by a test\n64 48\n4095\n" + b"\x07\x00" * 64 * 48)
        result = self.locate("--json", "--white-level", 4095, path)
        self.assertEqual((result.returncode, rows(result)[0]["state"]), (OK, "absent"))

    def test_rows_keep_the_order_and_repeats_of_the_call(self):
        second = self.write("another.png", png(level=200))
        call = [second, self.blank, second, self.folder / "none.png", self.blank]
        result = self.locate("--json", *call)
        self.assertEqual([row["image"] for row in rows(result)], [str(c) for c in call])
        self.assertEqual([row["state"] for row in rows(result)],
                         ["absent", "absent", "absent", "error", "absent"])

    def test_without_json_each_picture_has_its_line(self):
        result = self.locate(self.blank, self.folder / "none.png")
        lines = result.stdout.splitlines()
        self.assertIn("X mm", lines[1])
        self.assertRegex(lines[2], r"blank\.png +absent +\d")
        self.assertRegex(lines[3], r"none\.png +error +cannot open")

    def test_following_and_tilt_are_accepted(self):
        result = self.locate("--json", "--follow", "--tilt-deg", -19.3, self.blank, self.blank)
        self.assertEqual([row["state"] for row in rows(result)], ["absent", "absent"])

    def test_the_other_bar_is_read_or_its_absence_from_the_build_is_said(self):
        result = self.locate("--json", "--bar", "apriltag33", self.blank)
        if result.returncode == USAGE:
            self.assertIn("built without libapriltag", result.stderr)
        else:
            self.assertEqual((result.returncode, rows(result)[0]["state"]), (OK, "absent"))

    def test_a_name_that_is_not_utf_8_does_not_break_the_row(self):
        name = os.fsencode(self.folder) + b"/f\xff.png"
        try:
            with open(name, "wb") as out:
                out.write(png())
        except OSError:
            self.skipTest("the file system refuses such names")
        result = self.locate("--json", os.fsdecode(name), errors="surrogateescape")
        self.assertEqual(rows(result)[0]["state"], "absent")


class BadPictures(CliTest):
    def error_of(self, path):
        """The reason of a bad picture; another one of the same call must still be done."""
        result = self.locate("--json", path, self.blank)
        self.assertEqual(result.returncode, INPUT, result.stderr)
        bad, good = rows(result)
        self.assertEqual(list(row_problems(bad)), [])
        self.assertEqual((bad["state"], good["state"]), ("error", "absent"))
        self.assertIn(f"{path}: {bad['reason']}", result.stderr)
        return bad["reason"]

    def test_a_missing_file(self):
        self.assertIn("No such file", self.error_of(self.folder / "none.png"))

    def test_a_folder(self):
        self.assertIn("directory", self.error_of(self.folder))

    def test_an_empty_file(self):
        self.assertIn("is empty", self.error_of(self.write("empty.png", b"")))

    def test_a_text_in_a_picture_s_clothes(self):
        self.assertIn("is no picture", self.error_of(self.write("text.png", "image_width: 64\n")))

    def test_another_size_names_both(self):
        reason = self.error_of(self.write("size.png", png(48, 64)))
        self.assertIn("48 x 64", reason)
        self.assertIn("64 x 48", reason)

    def test_truncated_anywhere(self):
        whole = png(level=0)
        noisy = bytearray(whole)
        for end in (9, 20, 30, len(whole) // 2, len(whole) - 16):
            with self.subTest(end=end):
                self.assertIn("damaged", self.error_of(self.write("cut.png", bytes(noisy[:end]))))

    def test_damaged_pixels(self):
        broken = bytearray(png())
        broken[50] ^= 0xff
        self.assertIn("damaged", self.error_of(self.write("broken.png", bytes(broken))))

    def test_a_header_that_claims_a_huge_picture_unpacks_nothing(self):
        for claim in ((2**31 - 1, 2**31 - 1), (100000, 100000), (0, 48)):
            with self.subTest(claim=claim):
                reason = self.error_of(self.write("bomb.png", png(claim=claim)))
                self.assertTrue("px, but" in reason or "damaged" in reason)

    def test_a_header_that_claims_the_right_size_for_too_few_pixels(self):
        self.assertIn("damaged", self.error_of(self.write("few.png", png(8, 8, claim=(64, 48)))))

    def test_other_formats_with_broken_headers(self):
        for name, content in (("a.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF"),
                              ("a.bmp", b"BM" + bytes(12) + struct.pack("<Iii", 40, 64, 48)),
                              ("a.tif", b"II*\0\x08\0\0\0\xff\xff" + bytes(40)),
                              ("a.pgm", b"P5 64 48"), ("b.pgm", b"P5\n#" + b"x" * 100)):
            with self.subTest(name=name):
                self.assertIn("damaged", self.error_of(self.write(name, content)))

    @unittest.skipUnless(os.path.exists("/dev/zero"), "no /dev/zero")
    def test_an_endless_file_is_given_up(self):
        self.assertIn("larger than", self.error_of("/dev/zero"))

    @unittest.skipIf(os.geteuid() == 0, "root reads everything")
    def test_a_file_without_permission(self):
        path = self.write("secret.png", png())
        path.chmod(0)
        self.assertIn("Permission denied", self.error_of(path))


class Overlays(CliTest):
    def test_every_picture_gets_one_whatever_its_state(self):
        (self.folder / "b").mkdir()
        twin = self.write("b/blank.png", png(level=30))
        out = self.folder / "new" / "overlays"
        result = self.locate("--json", "--overlay", out, self.blank, twin, self.folder / "none.png")
        self.assertEqual(result.returncode, INPUT)
        self.assertEqual(sorted(p.name for p in out.iterdir()),
                         ["blank-2.overlay.png", "blank.overlay.png"])
        for path in out.iterdir():
            self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_a_folder_that_cannot_be_made_names_it(self):
        result = self.locate("--json", "--overlay", self.blank / "x", self.blank)
        self.assertEqual((result.returncode, result.stdout), (INPUT, ""))
        self.assertIn(f"{self.blank / 'x'}: cannot make the overlay folder", result.stderr)

    def test_a_file_in_the_folder_s_place(self):
        result = self.locate("--overlay", self.blank, self.blank)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(f"{self.blank}: cannot make the overlay folder", result.stderr)

    def test_an_overlay_that_cannot_be_written_is_named_and_the_rest_done(self):
        out = self.folder / "out"
        (out / "blank.overlay.png").mkdir(parents=True)
        other = self.write("other.png", png())
        result = self.locate("--json", "--overlay", out, self.blank, other)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("blank.overlay.png: cannot write the overlay", result.stderr)
        self.assertEqual([row["state"] for row in rows(result)], ["absent", "absent"])
        self.assertTrue((out / "other.overlay.png").is_file())


if __name__ == "__main__":
    unittest.main()
