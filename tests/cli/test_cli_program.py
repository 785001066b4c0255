# SPDX-License-Identifier: Apache-2.0
"""The program as a whole: help, version, exit codes, and outputs that cannot be written."""
import os
import re
import subprocess
import unittest
from pathlib import Path

from cli_kit import INPUT, OK, OPMS, USAGE, CliTest, opms

HERE = Path(__file__).resolve().parent
VERSION_H = HERE.parents[1] / "libopms" / "include" / "opms" / "version.h"


class Program(CliTest):
    def test_help_names_every_command_and_the_exit_codes(self):
        result = opms("--help")
        self.assertEqual(result.returncode, OK)
        for word in ("locate", "Exit codes", "4 a file"):
            self.assertIn(word, result.stdout)

    def test_help_of_locate_is_the_golden_one(self):
        result = opms("locate", "--help")
        self.assertEqual(result.returncode, OK)
        self.assertEqual(result.stdout, (HERE / "locate_help.stdout").read_text())
        self.assertEqual(result.stderr, "")

    def test_version_is_the_header_s(self):
        numbers = re.findall(r"#define OPMS_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)",
                             VERSION_H.read_text())
        self.assertEqual(opms("--version").stdout, "opms " + ".".join(numbers) + "\n")

    def test_wrong_use_exits_with_2_and_says_why_on_stderr(self):
        calls = [[], ["fly"], ["locate"], ["locate", "--camera", self.camera],
                 ["locate", self.blank],
                 ["locate", "--camera", self.camera, "--bar", "ruler", self.blank],
                 ["locate", "--camera", self.camera, "--tilt-deg", "steep", self.blank],
                 ["locate", "--camera", self.camera, "--tilt-deg", "nan", self.blank],
                 ["locate", "--camera", self.camera, "--tilt-deg", "90.1", self.blank],
                 ["locate", "--camera", self.camera, "--require", "luck", self.blank],
                 ["locate", "--camera", self.camera, "--white-level", "-1", self.blank],
                 ["locate", "--camera", self.camera, "--colour", self.blank]]
        for call in calls:
            with self.subTest(call=call):
                result = opms(*call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertNotEqual(result.stderr, "")

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_a_full_disk_is_an_error_that_says_so(self):
        with open("/dev/full", "w") as full:
            result = subprocess.run([OPMS, "locate", "--camera", self.camera, "--json", self.blank],
                                    stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        self.assertEqual(result.returncode, INPUT)
        self.assertIn("cannot write results: No space left", result.stderr)

    def test_a_reader_that_goes_away_ends_the_run_without_noise(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        result = subprocess.run([OPMS, "locate", "--camera", self.camera, "--json"] +
                                [self.blank] * 3, stdout=write_end, stderr=subprocess.PIPE,
                                text=True, timeout=60)
        os.close(write_end)
        self.assertEqual(result.returncode, INPUT)
        self.assertEqual(result.stderr, "")


if __name__ == "__main__":
    unittest.main()
