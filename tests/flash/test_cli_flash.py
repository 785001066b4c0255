# SPDX-License-Identifier: Apache-2.0
"""`opms box flash` as users call it, up to the point where it would touch a device."""
import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

OPMS = os.environ.get("OPMS", "opms")
USAGE, INPUT = 2, 4


def flash(*arguments):
    return subprocess.run([OPMS, "box", "flash", *map(str, arguments)], capture_output=True,
                          text=True, timeout=120)


def block(family=0xE48BFF56, number=0, count=1):
    head = struct.pack("<8I", 0x0A324655, 0x9E5D5157, 0x2000, 0x10000000, 256, number, count,
                       family)
    return head + bytes(476) + struct.pack("<I", 0x0AB16F30)


class BadCalls(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, content):
        path = self.folder / "file.uf2"
        path.write_bytes(content)
        return path

    def test_usage_errors_end_with_2(self):
        good = self.write(block())
        for call in ([], ["--box", "usb", good], ["--box", "hid:12", good], [good, "more"],
                     ["--box", "hid:0123456789ABCDEF", "--no-enter", good], ["--what", good]):
            with self.subTest(call=call):
                result = flash(*call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertTrue(result.stderr)

    def test_bad_files_end_with_4_and_are_named(self):
        cases = ((b"", "empty"), (b"\x7fELF", "no UF2 file"), (block()[:300], "within"),
                 (block(family=0xE48BFF59), "another microcontroller"),
                 (block(count=2), "cut short"), (block(), "checksum"))
        for content, word in cases:
            with self.subTest(word=word):
                path = self.write(content)
                result = flash(path)
                self.assertEqual(result.returncode, INPUT)
                self.assertIn(str(path), result.stderr)
                self.assertIn(word, result.stderr)

    def test_a_file_that_is_not_there_ends_with_4(self):
        result = flash(self.folder / "none.uf2")
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("none.uf2", result.stderr)

    def test_json_tells_the_reason_on_stdout(self):
        result = flash("--json", self.write(b"text"))
        self.assertEqual(result.returncode, INPUT)
        row = json.loads(result.stdout)
        self.assertEqual(row["schema"], "opms.box-flash/1")
        self.assertEqual(row["state"], "failed")
        self.assertIn("no UF2 file", row["reason"])

    def test_help_names_the_options(self):
        result = flash("--help")
        self.assertEqual(result.returncode, 0)
        for option in ("--box", "--no-enter", "--json", "--no-progress"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    unittest.main()
