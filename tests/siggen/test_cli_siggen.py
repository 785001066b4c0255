# SPDX-License-Identifier: Apache-2.0
"""`opms siggen` as users call it, where there is no such chip."""
import os
import subprocess
import unittest

OPMS = os.environ.get("OPMS", "opms")
USAGE, DEVICE = 2, 3


def siggen(*arguments):
    return subprocess.run([OPMS, "siggen", *map(str, arguments)], capture_output=True, text=True,
                          timeout=120)


class BadCalls(unittest.TestCase):
    def test_usage_errors_end_with_2(self):
        for call in ([], ["--start", -1], ["--start", "x"], ["--start", 1, "--trig", 1],
                     ["--start", 1, "--trig", 2, "--strobe", 2],
                     ["--start", 1, "--strobe", 2], ["--start", 1, "--max-jitter-us", 5],
                     ["--start", 1, "--expect-period-us", 5], ["--start", 1, "--count", 0],
                     ["--start", 1, "--period-ms", 0], ["--start", 1, "--period-ms", "nan"],
                     ["--start", 1, "--period-ms", 1, "--width-us", 1000],
                     ["--start", 1, "--width-us", -5], ["--start", 1, "--period-ms", "1e300"],
                     ["--start", 1, "--period-ms", 10, "--glitch-us", 5000],
                     ["--start", 1, "--active-low", "sync"],
                     ["--start", 1, "--trig", 2, "--max-jitter-us", -1]):
            with self.subTest(call=call):
                result = siggen("--chip", "/dev/no-such-chip", *call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertTrue(result.stderr)

    def test_a_chip_that_is_not_there_ends_with_3_and_is_named(self):
        for chip, path in (("/dev/no-such-chip", "/dev/no-such-chip"), ("no-chip", "/dev/no-chip"),
                           ("987654", "/dev/gpiochip987654"), ("/dev/null", "/dev/null")):
            with self.subTest(chip=chip):
                result = siggen("--chip", chip, "--start", 1, "--json")
                self.assertEqual(result.returncode, DEVICE)
                self.assertEqual(result.stdout, "")
                self.assertIn(f"{path} cannot be opened", result.stderr)

    def test_help_names_the_options(self):
        result = siggen("--help")
        self.assertEqual(result.returncode, 0)
        for option in ("--chip", "--start", "--trig", "--strobe", "--glitch-us", "--json"):
            self.assertIn(option, result.stdout)


if __name__ == "__main__":
    unittest.main()
