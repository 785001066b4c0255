# SPDX-License-Identifier: Apache-2.0
"""`opms box` and the very firmware that users flash, in the emulated RP2040.

Skipped where Node, its packages or the built firmware are missing (./run firmware builds it).
"""
import os
import shutil
import subprocess
import unittest
from pathlib import Path

from cli_kit import OK, RESULT, opms, rows

ROOT = Path(__file__).resolve().parents[2]
SERVER = ROOT / "tests/emulator/box_server.mjs"
FIRMWARE = Path(os.environ.get("OPMS_FIRMWARE", ROOT / "build/firmware/opms-box.bin"))
NODE = shutil.which("node")
READY = (NODE and SERVER.exists() and FIRMWARE.exists()
         and (SERVER.parent / "node_modules").is_dir())


@unittest.skipUnless(READY, "no Node, or the firmware is not built")
class Firmware(unittest.TestCase):
    def setUp(self):
        self.server = subprocess.Popen(
            [NODE, SERVER, "--port", "0", "--firmware", FIRMWARE],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(self.stop)
        told = self.server.stdout.readline().strip()
        self.assertRegex(told, r"^emulated box on 127\.0\.0\.1:\d+$")
        self.place = "emulated:" + told.rsplit(":", 1)[1]

    def stop(self):
        self.server.terminate()
        self.server.communicate(timeout=60)

    def call(self, verb, *arguments):
        return opms("box", verb, "--box", self.place, *arguments)

    def test_the_selftest_finds_nothing_wrong(self):
        result = self.call("selftest", "--json")
        bad = [row for row in rows(result) if row["result"] != "ok"]
        self.assertEqual((result.returncode, bad), (OK, []), result.stderr)

    def test_settings_are_kept_and_a_running_box_refuses_others(self):
        row, = rows(self.call("settings", "--json", "--period-ms", "20", "--preamble", "10,30"))
        self.assertEqual((row["period_us"], row["preamble_ms"], row["stored"]),
                         (20000, [10, 30], True))
        self.assertEqual(rows(self.call("settings", "--json"))[0]["settings_crc"],
                         row["settings_crc"])

    def test_a_run_at_50_hz_is_watched_without_a_loss(self):
        self.call("settings", "--period-ms", "20", "--preamble", "10,30")
        result = self.call("monitor", "--json", "--arm", "--start", "--seconds", "3")
        self.assertEqual(result.returncode, OK, result.stderr)
        seen = rows(result)
        running = [row for row in seen if row["state"] == "RUNNING"][-1]
        self.assertAlmostEqual(running["rate_hz"], 50, places=3)
        self.assertEqual(running["jitter_ns"], 0)
        self.assertEqual((seen[-1]["counters"]["reports_lost"], seen[-1]["dropped"]), (0, 0))

    def test_a_lone_arm_waits_for_start_and_is_stopped(self):
        self.call("settings", "--preamble", "off")
        result = self.call("monitor", "--json", "--arm", "--seconds", "1.5")
        self.assertEqual(result.returncode, OK, result.stderr)
        self.assertIn("WAITING", [row["state"] for row in rows(result)])
        self.assertNotEqual(self.call("selftest").returncode, RESULT)


if __name__ == "__main__":
    unittest.main()
