# SPDX-License-Identifier: Apache-2.0
"""What the tests of recorded scans share: a small scan, and the program on it."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cli"))
from cli_kit import DATA, INPUT, OK, RESULT, USAGE, opms, png, rows  # noqa: E402,F401

FIXTURE = os.environ.get("SCAN_FIXTURE", "scan_fixture")
BAR = DATA / "bar"
EXPOSURE_MIDDLE_NS = 1032 + 20_000 + 2_000_000  # start edge to pulse, delay, half of 4 ms
PREAMBLE, FRAMES = 6, 14


def make_scan(folder, name, *keys, pictures=BAR):
    """Record a scan. @return What the writer says is in it."""
    made = subprocess.run([FIXTURE, str(pictures), str(folder), name, *keys], capture_output=True,
                          text=True, timeout=300)
    if made.returncode != 0:
        raise AssertionError(made.stderr)
    return json.loads(made.stdout)


class ScanTest(unittest.TestCase):
    """Tests on one scan, "one" in the folder `scans`; each has a folder of its own to write to."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.scans = Path(folder.name) / "scans"
        cls.truth = make_scan(cls.scans, "one")
        cls.scan = cls.scans / "one"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_json(self, *arguments, code=OK, **kwargs):
        """Rows of a run that ends with @p code."""
        result = opms(*arguments, "--json", **kwargs)
        self.assertEqual(result.returncode, code, result.stderr + result.stdout)
        return rows(result)

    def refused(self, *arguments, code=INPUT, says=""):
        """@return The message of a run that fails."""
        result = opms(*arguments)
        self.assertEqual(result.returncode, code, result.stderr + result.stdout)
        self.assertIn(says, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        return result.stderr

    def left_in(self, folder):
        return sorted(path.name for path in Path(folder).iterdir())


def pictures_of(scan):
    return sorted(Path(scan).rglob("*.png"))
