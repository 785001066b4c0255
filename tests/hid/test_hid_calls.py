# SPDX-License-Identifier: Apache-2.0
"""The calls that talk to the box: what they send, what they wait for, how they fail."""
import struct
import unittest

import box_wire as wire
from hid_kit import DISCONNECTED, HidTest


class Commands(HidTest):
    def test_arm_waits_for_the_box_to_say_so(self):
        probe = self.open()
        self.assertEqual(probe.ask("arm 4711")["status"], "OPMS_OK")
        self.assertEqual(self.box.commands.get_nowait(), (wire.ARM, 4711))
        self.assertEqual(probe.wait_item("event", kind=wire.EVENT_ARMED)["argument"], 4711)

    def test_arm_is_confirmed_by_a_status_where_the_event_got_lost(self):
        probe = self.open()
        self.box.silent = True
        probe.send("arm 5 20000")
        self.assertEqual(self.box.commands.get(timeout=20), (wire.ARM, 5))
        self.box.silent = False
        self.box.status()
        self.assertEqual(probe.reply("arm")["status"], "OPMS_OK")

    def test_arm_while_armed_is_refused_in_plain_words(self):
        probe = self.armed()
        reply = probe.ask("arm 8")
        self.assertEqual(reply["status"], "OPMS_ERR_REFUSED")
        self.assertIn("refuses to arm", reply["message"])
        self.assertIn("RUNNING", reply["message"])

    def test_session_ids_that_cannot_be_are_refused_here(self):
        probe = self.armed()
        self.assertEqual(probe.ask("arm 0")["status"], "OPMS_ERR_ARG")
        self.assertEqual(probe.ask("arm 7")["status"], "OPMS_ERR_ARG")

    def test_disarm_waits_for_the_stop(self):
        probe = self.armed()
        self.assertEqual(probe.ask("disarm")["status"], "OPMS_OK")
        self.assertEqual(self.box.state, wire.IDLE)

    def test_disarm_in_idle_is_confirmed_by_the_next_status(self):
        probe = self.open()
        probe.send("disarm 20000")
        self.assertEqual(self.box.commands.get(timeout=20), (wire.DISARM, 0))
        self.box.status()
        self.assertEqual(probe.reply("disarm")["status"], "OPMS_OK")

    def test_a_box_that_does_not_answer_ends_each_call_at_its_deadline(self):
        probe = self.open()
        self.box.mute |= {wire.COMMAND, wire.SETTINGS, wire.HISTORY}
        for command in ("ping 100", "arm 5 100", "disarm 100", "settings 100", "set 50000 100",
                        "history 7 1 5 100"):
            with self.subTest(command=command):
                self.assertEqual(probe.ask(command)["status"], "OPMS_ERR_TIMEOUT")
        self.box.trigger(1)

    def test_reports_flow_while_a_call_waits(self):
        probe = self.armed("callback=1", "poll=0")
        self.box.mute.add(wire.SETTINGS)
        probe.send("settings 3000")
        for number in range(1, 11):
            self.box.trigger(number)
        probe.wait_item("trigger", number=10)
        self.assertEqual([line for line in probe.seen if line.get("reply") == "settings"], [])
        self.assertEqual(probe.reply("settings")["status"], "OPMS_ERR_TIMEOUT")

    def test_an_unplug_ends_a_call_that_waits(self):
        probe = self.open("callback=1", "poll=0")
        self.box.mute.add(wire.COMMAND)
        probe.send("arm 5 60000")
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.assertEqual(probe.reply("arm")["status"], "OPMS_ERR_DEVICE")

    def test_closing_does_not_wait_for_a_box_that_is_mute(self):
        probe = self.armed()
        self.box.mute.add(wire.HISTORY)
        self.box.trigger(1)
        self.box.trigger(3)
        probe.wait_item("trigger", number=3)
        self.assertEqual(probe.ask("close")["status"], "OPMS_OK")


class Pings(HidTest):
    def test_a_pong_tells_when_its_ping_left(self):
        probe = self.open()
        ping = probe.ask("ping")
        pong = probe.wait_item("pong")
        self.assertEqual(pong["id"], ping["id"])
        self.assertLess(0, pong["sent"])
        self.assertLessEqual(pong["sent"], pong["t"])

    def test_pings_of_its_own_keep_coming(self):
        probe = self.open("ping=5")
        pongs = [probe.wait_item("pong") for _ in range(20)]
        self.assertEqual(len({p["id"] for p in pongs}), 20)
        self.assertTrue(all(p["sent"] > 0 for p in pongs))

    def test_a_pong_of_another_program_s_ping_has_no_time(self):
        probe = self.open()
        self.box.report(wire.pong(self.box.boot, 1, 12345, 10**9, 10**9))
        self.assertEqual(probe.wait_item("pong")["sent"], 0)


class Settings(HidTest):
    def test_settings_are_written_waited_for_and_read_back(self):
        probe = self.open()
        reply = probe.ask("set 50000")
        self.assertEqual(reply["status"], "OPMS_OK")
        self.assertEqual((reply["period_us"], reply["pending"]), (50000, False))
        sent = self.box.commands.get_nowait()
        self.assertEqual(sent[0], "settings")
        self.assertEqual(sent[1], struct.pack("<I", 50000) + wire.DEFAULT_SETTINGS[4:])
        self.assertEqual(probe.ask("settings")["period_us"], 50000)

    def test_the_defaults_are_those_of_the_document(self):
        probe = self.open()
        probe.ask("set 100000")
        self.assertEqual(self.box.commands.get_nowait()[1], wire.DEFAULT_SETTINGS)

    def test_a_refusal_says_why(self):
        probe = self.armed()
        reply = probe.ask("set 50000")
        self.assertEqual(reply["status"], "OPMS_ERR_REFUSED")
        self.assertIn("in IDLE only", reply["message"])

    def test_settings_out_of_range_never_leave_the_host(self):
        probe = self.open()
        reply = probe.ask("set 9999")
        self.assertEqual(reply["status"], "OPMS_ERR_ARG")
        self.assertIn("period", reply["message"])
        self.assertTrue(self.box.commands.empty())

    def test_other_settings_than_those_written_are_an_error(self):
        probe = self.open()
        other = struct.pack("<I", 70000) + wire.DEFAULT_SETTINGS[4:]
        self.box.garble[wire.SETTINGS] = lambda b: wire.settings(other)
        reply = probe.ask("set 50000")
        self.assertEqual(reply["status"], "OPMS_ERR_REFUSED")
        self.assertIn("other settings", reply["message"])

    def test_settings_whose_own_crc_is_wrong_are_refused(self):
        probe = self.open()
        self.box.garble[wire.SETTINGS] = lambda b: wire.seal(
            wire.SETTINGS, {4: wire.DEFAULT_SETTINGS, 36: b"\x12\x34"})
        reply = probe.ask("settings")
        self.assertEqual(reply["status"], "OPMS_ERR_DEVICE")
        self.assertIn("do not read", reply["message"])

    def test_a_busy_flash_is_waited_for(self):
        probe = self.open()
        failures = iter([b"", b""])
        self.box.garble[wire.SETTINGS] = lambda b: next(failures, b)
        self.assertEqual(probe.ask("set 50000")["status"], "OPMS_OK")


class History(HidTest):
    def test_a_range_is_read_in_order_with_what_is_not_held_marked(self):
        probe = self.armed()
        for number in range(1, 101):
            self.box.trigger(number)
        reply = probe.ask("history 7 90 20")
        self.assertEqual((reply["held"], reply["in_order"]), (11, 20))

    def test_gaps_wait_for_a_caller_and_both_get_all(self):
        probe = self.armed()
        self.box.trigger(1)
        for number in range(2, 60):
            self.box.trigger(number, told=False)
        self.box.trigger(60)
        reply = probe.ask("history 7 1 60")
        self.assertEqual((reply["status"], reply["in_order"]), ("OPMS_OK", 60))
        probe.wait_item("history", number=59)
        self.assertEqual([h["number"] for h in probe.items("history")], list(range(2, 60)))

    def test_arguments_that_cannot_be_are_refused(self):
        probe = self.open()
        for command in ("history 0 1 1", "history 7 0 1", "history 7 1 0", "history 7 1 8193"):
            with self.subTest(command=command):
                self.assertEqual(probe.ask(command)["status"], "OPMS_ERR_ARG")


class Bootloader(HidTest):
    def test_it_is_entered_with_the_magic_word_and_the_box_leaves_the_bus(self):
        probe = self.open()
        self.assertEqual(probe.ask("bootloader")["status"], "OPMS_OK")
        self.assertEqual(self.box.commands.get_nowait(), ("bootloader", wire.MAGIC_BOOTLOADER))

    def test_it_is_refused_while_armed(self):
        probe = self.armed()
        reply = probe.ask("bootloader")
        self.assertEqual(reply["status"], "OPMS_ERR_REFUSED")
        self.assertIn("not in this state", reply["message"])


if __name__ == "__main__":
    unittest.main()
