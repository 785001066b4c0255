# SPDX-License-Identifier: Apache-2.0
"""`opms box`: what it shows, sets and checks, against a box that is written in Python."""
import json
import re
import signal
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path

from cli_kit import OK, OPMS, RESULT, USAGE, opms, rows

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "hid"))
import box_wire as wire  # noqa: E402
from fake_box import UNIQUE_ID, FakeBox  # noqa: E402

DEVICE, LOST = 3, 5
VERBS = ("list", "info", "monitor", "settings", "selftest")


class BoxTest(unittest.TestCase):
    """A test with a box that runs by itself; its preamble is short, to save time."""

    def setUp(self):
        self.box = FakeBox(live=True)
        self.addCleanup(self.box.close)
        self.place = f"emulated:{self.box.port}"
        self.box.settings = wire.DEFAULT_SETTINGS[:12] + wire.DEFAULT_SETTINGS[12:16] + \
            b"".join(gap.to_bytes(2, "little") for gap in (20, 40, 30, 0, 0, 0, 0, 0))

    def call(self, verb, *arguments):
        return opms("box", verb, "--box", self.place, *arguments)


class Usage(unittest.TestCase):
    def test_every_verb_explains_itself(self):
        text = opms("box", "--help").stdout
        for verb in VERBS:
            with self.subTest(verb=verb):
                self.assertIn(verb, text)
                result = opms("box", verb, "--help")
                self.assertEqual((result.returncode, result.stderr), (OK, ""))
                self.assertIn("--box", result.stdout)
                self.assertIn("--json", result.stdout)

    def test_wrong_use_exits_with_2_and_says_why_on_stderr(self):
        calls = [[], ["fly"], ["info", "--box", "usb"], ["info", "--box", "hid:12"],
                 ["info", "--box", "hid:e66178c1a3551e2g"], ["info", "--box", "emulated:0"],
                 ["info", "--box", "emulated:65536"], ["info", "--box", "emulated:"],
                 ["monitor", "--seconds", "0"], ["monitor", "--seconds", "nan"],
                 ["monitor", "--seconds", "-1"], ["selftest", "--wait-start", "-1"],
                 ["settings", "--trig", "up"], ["settings", "--sync", "2hz"],
                 ["settings", "--width-us", "-5"], ["settings", "--wait-timeout-s", "65536"],
                 ["list", "extra"]]
        for call in calls:
            with self.subTest(call=call):
                result = opms("box", *call)
                self.assertEqual(result.returncode, USAGE)
                self.assertEqual(result.stdout, "")
                self.assertNotEqual(result.stderr, "")

    def test_no_emulated_box_exits_with_3_and_names_the_port(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        for verb in VERBS:
            with self.subTest(verb=verb):
                result = opms("box", verb, "--box", f"emulated:{port}")
                self.assertEqual((result.returncode, result.stdout), (DEVICE, ""))
                self.assertIn(str(port), result.stderr)


class Show(BoxTest):
    def test_list_names_the_box(self):
        row, = rows(self.call("list", "--json"))
        self.assertEqual((row["schema"], row["kind"], row["unique_id"]),
                         ("opms.box.list/1", "box", UNIQUE_ID))
        self.assertIn(UNIQUE_ID, self.call("list").stdout)

    def test_info_tells_identity_status_and_settings(self):
        result = self.call("info", "--json")
        self.assertEqual(result.returncode, OK)
        row, = rows(result)
        self.assertEqual(row["schema"], "opms.box.info/1")
        self.assertEqual(row["identity"]["unique_id"], UNIQUE_ID)
        self.assertEqual(row["identity"]["git_hash"], "0123456789abcdef0123")
        self.assertEqual(row["status"]["state"], "IDLE")
        self.assertEqual(row["settings"]["preamble_ms"], [20, 40, 30])
        text = self.call("info").stdout
        for word in (UNIQUE_ID, "0.2.0", "IDLE", "20 40 30 ms"):
            self.assertIn(word, text)

    def test_a_box_of_another_protocol_exits_with_3_and_names_both_versions(self):
        self.box.version = 9
        result = self.call("info")
        self.assertEqual(result.returncode, DEVICE)
        self.assertIn("protocol version 9, this program 1", result.stderr)


class Settings(BoxTest):
    def test_they_are_shown_as_the_box_has_them(self):
        row, = rows(self.call("settings", "--json"))
        self.assertEqual(row["schema"], "opms.box.settings/1")
        self.assertEqual((row["period_us"], row["width_us"], row["debounce_us"]),
                         (100000, 1000, 1.0))
        self.assertTrue(row["stored"])
        self.assertTrue(self.box.commands.empty(), "to show is not to write")

    def test_what_is_given_changes_and_the_rest_stays(self):
        row, = rows(self.call("settings", "--json", "--period-ms", "12.5", "--debounce-us", "0.024",
                              "--preamble", "15,25", "--trig", "active-low", "--start", "falling",
                              "--strobe", "active-low", "--sync", "1hz", "--wait-timeout-s", "60"))
        self.assertEqual((row["period_us"], row["width_us"], row["debounce_us"]),
                         (12500, 1000, 0.024))
        self.assertEqual(row["preamble_ms"], [15, 25])
        body = self.box.settings
        self.assertEqual(body[8:12], (3).to_bytes(4, "little"))
        self.assertEqual((body[12], body[13], body[14]), (0b1111, 1, 60))
        row, = rows(self.call("settings", "--json", "--preamble", "off"))
        self.assertEqual((row["preamble_ms"], row["period_us"]), ([], 12500))
        row, = rows(self.call("settings", "--json", "--defaults", "--width-us", "2000"))
        self.assertEqual((row["period_us"], row["width_us"]), (100000, 2000))
        self.assertEqual(row["preamble_ms"], [100, 200, 100, 300, 100])

    def test_values_out_of_range_are_refused_and_not_sent(self):
        for call in (["--period-ms", "9.999"], ["--period-ms", "10.0005"], ["--period-ms", "nan"],
                     ["--period-ms", "1e300"], ["--width-us", "9"], ["--width-us", "99001"],
                     ["--debounce-us", "0.01"], ["--debounce-us", "10001"], ["--preamble", ""],
                     ["--preamble", "100,,100"], ["--preamble", "100,"], ["--preamble", "0"],
                     ["--preamble", "9"], ["--preamble", "20,20,20,20,20,20,20,20,20"],
                     ["--preamble", "65536"], ["--preamble", "1e2"]):
            with self.subTest(call=call):
                result = self.call("settings", *call)
                self.assertEqual((result.returncode, result.stdout), (USAGE, ""))
                self.assertNotEqual(result.stderr, "")
        self.assertTrue(self.box.commands.empty())

    def test_a_box_that_runs_refuses_them_with_its_reason(self):
        self.box.state = wire.RUNNING
        self.box.due_ns = self.box.now_ns() + 10**12
        result = self.call("settings", "--period-ms", "50")
        self.assertEqual(result.returncode, RESULT)
        self.assertIn("in IDLE only", result.stderr)


class Monitor(BoxTest):
    def test_a_run_is_watched_from_arm_to_stop(self):
        result = self.call("monitor", "--json", "--arm", "--start", "--seconds", "3")
        self.assertEqual(result.returncode, OK, result.stderr)
        seen = rows(result)
        self.assertTrue(all(row["schema"] == "opms.box.monitor/1" for row in seen))
        running = [row for row in seen if row["state"] == "RUNNING"][-1]
        self.assertAlmostEqual(running["rate_hz"], 10, places=3)
        self.assertEqual(running["jitter_ns"], 0)
        self.assertEqual(running["first_run_number"], 5)
        self.assertGreater(running["latency_ms"], 0)
        self.assertIn(running["clock"]["state"], ("coarse", "fitted"))
        kinds = [news["event"]["kind"] for row in seen for news in row["news"] if "event" in news]
        self.assertEqual(len(kinds), 4, kinds)
        self.assertEqual(self.box.state, wire.IDLE)

    def test_a_pulse_that_is_late_shows_as_jitter(self):
        self.box.settings = (20000).to_bytes(4, "little") + self.box.settings[4:]
        late = self.box._pulse

        def pulse():
            if self.box.number == 20:
                self.box.due_ns += 1_000_000
            late()
        self.box._pulse = pulse
        result = self.call("monitor", "--json", "--arm", "--start", "--seconds", "2")
        self.assertEqual(max(row["jitter_ns"] for row in rows(result)), 1_000_000)

    def test_lost_reports_are_filled_and_no_failure(self):
        self.box.lose = {3, 7, 8}
        result = self.call("monitor", "--json", "--arm", "--start", "--seconds", "2.5")
        self.assertEqual(result.returncode, OK, result.stderr)
        counters = rows(result)[-1]["counters"]
        self.assertEqual((counters["triggers_filled"], counters["triggers_unfilled"]), (3, 0))

    def test_pulses_that_are_lost_for_good_exit_with_5(self):
        self.box.lose = {3}
        self.box.stalls.add(wire.HISTORY)
        result = self.call("monitor", "--arm", "--start", "--seconds", "2.5")
        self.assertEqual(result.returncode, LOST)
        self.assertIn("pulses were lost", result.stderr)

    def test_a_box_that_is_gone_at_the_end_exits_with_3(self):
        process = subprocess.Popen([OPMS, "box", "monitor", "--box", self.place, "--json",
                                    "--seconds", "2"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        process.stdout.readline()
        self.box.detach()
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, DEVICE)
        self.assertIn("not plugged in", err)
        self.assertFalse(json.loads(out.splitlines()[-1])["connected"])

    def test_ctrl_c_stops_the_box_and_ends_well(self):
        process = subprocess.Popen([OPMS, "box", "monitor", "--box", self.place, "--arm"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual((process.returncode, self.box.state), (OK, wire.IDLE))

    def test_without_json_there_is_a_line_a_second(self):
        lines = self.call("monitor", "--seconds", "1.5").stdout.splitlines()
        self.assertTrue(lines and all(re.match(r" +[0-9.]+ s  IDLE", line) for line in lines))


class Selftest(BoxTest):
    def checks(self, *arguments):
        result = self.call("selftest", "--json", *arguments)
        return result, {row["check"]: row for row in rows(result)}

    def assert_failed(self, check, words, code=RESULT):
        result, checks = self.checks()
        self.assertEqual(result.returncode, code, result.stdout)
        self.assertEqual([name for name, row in checks.items() if row["result"] == "failed"],
                         [check])
        self.assertIn(words, checks[check]["text"])

    def test_a_good_box_passes_every_check(self):
        result, checks = self.checks()
        self.assertEqual(result.returncode, OK, result.stdout)
        self.assertEqual(list(checks), ["identity", "status", "settings", "clock", "arm",
                                        "preamble", "run", "reports", "stop", "history",
                                        "losses"])
        self.assertEqual({row["result"] for row in checks.values()}, {"ok"})
        self.assertIn("the box is well", result.stderr)

    def test_a_preamble_with_a_wrong_gap_is_named(self):
        self.box.wrong_gap_us = 5
        self.assert_failed("preamble", "gap 1 is 20.005000 ms, should be 20 ms")

    def test_lost_reports_exit_with_5(self):
        self.box.lose = {15}
        result, checks = self.checks()
        self.assertEqual(checks["losses"]["result"], "failed")
        self.assertIn("another cable", checks["losses"]["text"])
        self.assertIn(result.returncode, (RESULT, LOST))

    def test_a_history_that_tells_other_times_is_found(self):
        def other(answer):
            changed = bytearray(answer[:62])
            changed[20] ^= 1
            return bytes(changed) + wire.crc16(bytes(changed)).to_bytes(2, "little")
        self.box.garble[wire.HISTORY] = other
        self.assert_failed("history", "another time than it reported")

    def test_a_box_in_use_is_left_alone(self):
        self.box.state, self.box.session = wire.WAITING, 5
        result, checks = self.checks()
        self.assertEqual(result.returncode, RESULT)
        self.assertIn("--stop", checks["idle"]["text"])
        self.assertEqual(self.box.state, wire.WAITING)
        result, checks = self.checks("--stop")
        self.assertEqual(result.returncode, OK, result.stdout)

    def test_settings_that_status_does_not_confirm_are_named(self):
        other = self.box.settings[:14] + b"\5\0" + self.box.settings[16:]
        self.box.garble[wire.SETTINGS] = lambda b: wire.settings(other)
        self.assert_failed("settings", "STATUS says")

    def test_a_jumper_brings_every_pulse_of_trig_to_start(self):
        self.box.jumper_cycles = 125001
        result, checks = self.checks("--loopback")
        self.assertEqual(result.returncode, OK, result.stdout)
        self.assertIn("all 5 pulses of TRIG", checks["loopback"]["text"])

    def test_with_a_jumper_the_end_of_trigs_first_pulse_starts_a_run(self):
        self.box.jumper_cycles = 125001
        before = self.box.settings
        result, checks = self.checks("--loopback")
        self.assertEqual(result.returncode, OK, result.stdout)
        self.assertEqual(checks["loopback-run"]["result"], "ok")
        self.assertIn("us from START to the first, 0 ns off", checks["loopback-run"]["text"])
        self.assertEqual(self.box.settings, before, "settings of before")

    def test_a_pulse_that_comes_back_in_another_length_is_named(self):
        self.box.jumper_cycles = 100000
        _, checks = self.checks("--loopback")
        self.assertEqual(checks["loopback"]["result"], "failed")
        self.assertIn("800.000 us, TRIG sends 1000 us", checks["loopback"]["text"])

    def test_a_jumper_that_is_not_there_is_named(self):
        result, checks = self.checks("--loopback")
        self.assertEqual(result.returncode, RESULT)
        self.assertIn("check the jumper", checks["loopback"]["text"])
        self.assertEqual(self.box.settings[16:22], b"\x14\0\x28\0\x1e\0", "settings of before")


if __name__ == "__main__":
    unittest.main()
