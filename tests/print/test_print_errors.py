# SPDX-License-Identifier: Apache-2.0
"""Wrong use and files that cannot be written: exit codes, words, and nothing left behind."""
import tempfile
import unittest
from pathlib import Path

from print_kit import INPUT, OK, USAGE, opms


class ErrorsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def assert_usage(self, words, *arguments):
        result = opms("print", *arguments)
        self.assertEqual(result.returncode, USAGE, result.stderr)
        self.assertIn(words, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertEqual(self.names(), [])

    def test_wrong_use_is_told(self):
        out = ("--out", self.folder / "x.pdf")
        self.assert_usage("--out", "bar")
        self.assert_usage("poster", "poster", *out)
        self.assert_usage(".pdf or .svg", "bar", "--out", self.folder / "x.png")
        self.assert_usage("qr", "bar", *out, "--bar", "qr")
        self.assert_usage("a5", "bar", *out, "--tile", "a5")
        self.assert_usage("--bar goes with", "grid", *out, "--bar", "hope33")
        self.assert_usage("print grid", "bar", *out, "--footprint", "350,0,0")
        self.assert_usage("print grid", "bar", *out, "--head-diameter-mm", "200")

    def test_an_absurd_footprint_is_told(self):
        out = ("--out", self.folder / "x.pdf")
        for text in ("350", "350,0", "350,0,0,0", "350;0;0", "a,b,c", "350,0,0x", " "):
            self.assert_usage("three numbers", "grid", *out, f"--footprint={text}")
        for text in ("nan,0,0", "inf,0,0", "1e9,0,0"):
            self.assert_usage("finite", "grid", *out, f"--footprint={text}")
        self.assert_usage("no mark", "grid", *out, "--footprint", "5000,0,0")
        for diameter in ("0", "-5", "nan", "1e6"):
            self.assert_usage("20 to 800 mm", "grid", *out, f"--head-diameter-mm={diameter}")

    def test_a_file_that_cannot_be_written_is_named(self):
        missing = self.folder / "nowhere" / "x.pdf"
        result = opms("print", "bar", "--out", missing)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn(str(missing), result.stderr)
        self.assertIn("No such file or directory", result.stderr)

    def test_a_failed_write_leaves_nothing_aside(self):
        # Given a folder where the second tile should go
        (self.folder / "bar-2.svg" / "kept").mkdir(parents=True)
        result = opms("print", "bar", "--tile", "a3", "--out", self.folder / "bar.svg")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("bar-2.svg", result.stderr)
        self.assertFalse([name for name in self.names() if "part" in name])

    def test_an_old_file_is_replaced_whole(self):
        out = self.folder / "bar.pdf"
        out.write_bytes(b"old")
        result = opms("print", "bar", "--out", out)
        self.assertEqual(result.returncode, OK)
        self.assertTrue(out.read_bytes().startswith(b"%PDF"))
        self.assertEqual(self.names(), ["bar.pdf"])
        self.assertEqual(result.stdout, f"{out}: 1 page of 1040 x 190 mm\n")


if __name__ == "__main__":
    unittest.main()
