# SPDX-License-Identifier: Apache-2.0
"""Opening, unplugging, restarting, and boxes that cannot be used."""
import socket
import threading
import unittest

import box_wire as wire
from fake_box import UNIQUE_ID, FakeBox
from hid_kit import (CONNECTED, DISCONNECTED, FAILED, REBOOTED, SILENT, HidTest)


class Opening(HidTest):
    def refused(self, *options, port=None):
        probe = self.probe(*options, port=port)
        reply = probe.reply("open")
        return reply["status"], reply["message"]

    def test_the_identity_is_read_before_anything_else(self):
        probe = self.open()
        identity = probe.ask("identity")
        self.assertEqual(identity["boot"], self.box.boot)
        self.assertEqual(identity["git"], "0123456789abcdef0123")
        self.assertEqual(identity["first_byte"], 0xE6)
        self.assertTrue(identity["connected"])
        self.assertEqual(probe.wait_item("link")["change"], CONNECTED)

    def test_a_box_of_another_protocol_is_refused_with_both_versions_named(self):
        self.box.version = 2
        status, message = self.refused()
        self.assertEqual(status, "OPMS_ERR_VERSION")
        self.assertIn("protocol version 2, this program 1", message)

    def test_an_identity_without_its_magic_is_refused(self):
        self.box.garble[wire.IDENTITY] = lambda b: wire.seal(wire.IDENTITY, {4: b"NOPE"})
        status, message = self.refused()
        self.assertEqual(status, "OPMS_ERR_DEVICE")
        self.assertIn("identity does not read", message)

    def test_an_identity_that_fails_twice_is_read_a_third_time(self):
        answers = iter([b"", b"short"])
        self.box.garble[wire.IDENTITY] = lambda b: next(answers, b)
        self.open()

    def test_no_server_is_a_clear_error(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        status, message = self.refused(port=port)
        self.assertEqual(status, "OPMS_ERR_DEVICE")
        self.assertIn(f"the emulated box on port {port} is not running", message)

    def test_a_box_that_another_host_has_is_a_clear_error(self):
        self.open()
        status, message = self.refused("open=300")
        self.assertIn(status, ("OPMS_ERR_DEVICE", "OPMS_ERR_TIMEOUT"))
        self.assertTrue("another program" in message or "did not answer" in message, message)

    def test_another_id_than_the_box_s_is_refused_and_the_box_s_is_named(self):
        status, message = self.refused("id=0000000000000001")
        self.assertEqual(status, "OPMS_ERR_DEVICE")
        self.assertIn(UNIQUE_ID, message)

    def test_the_case_of_an_id_does_not_matter(self):
        self.open("id=" + UNIQUE_ID.upper())

    def test_an_id_that_is_none_is_refused(self):
        status, message = self.refused("id=xyz")
        self.assertEqual(status, "OPMS_ERR_ARG")
        self.assertIn("16 hex digits", message)

    def test_a_box_that_is_mute_ends_at_the_deadline(self):
        self.box.mute.add(wire.IDENTITY)
        status, _ = self.refused("open=500")
        self.assertEqual(status, "OPMS_ERR_TIMEOUT")

    def test_options_out_of_their_ranges_are_refused(self):
        for option in ("queue=15", "queue=1000001", "open=0"):
            with self.subTest(option=option):
                self.assertEqual(self.refused(option)[0], "OPMS_ERR_ARG")

    def test_rubbish_instead_of_a_box_is_survived(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            def talk():
                host, _ = server.accept()
                with host:
                    host.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                    host.recv(1)
            thread = threading.Thread(target=talk)
            thread.start()
            status, _ = self.refused("open=400", port=server.getsockname()[1])
            self.assertIn(status, ("OPMS_ERR_DEVICE", "OPMS_ERR_TIMEOUT"))
            thread.join()


class Replug(HidTest):
    def test_a_replug_is_told_and_what_was_lost_meanwhile_is_fetched(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        for number in range(2, 6):
            self.box.trigger(number)
        self.box.attach()
        probe.wait_item("link", change=CONNECTED)
        self.box.trigger(6)
        self.assertEqual([probe.wait_item("history")["number"] for _ in range(4)], [2, 3, 4, 5])
        counters = probe.ask("counters")
        self.assertEqual((counters["connections"], counters["reboots"]), (2, 0))

    def test_an_unplug_in_the_midst_of_filling_goes_on_after_the_replug(self):
        probe = self.armed()

        def five_answers(answer):
            if self.box.history_gets == 5:
                self.box.mute.add(wire.HISTORY)
            return answer
        self.box.garble[wire.HISTORY] = five_answers
        self.box.trigger(1)
        for number in range(2, 40):
            self.box.trigger(number, told=False)
        self.box.trigger(40)
        probe.wait_item("history", number=11)
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.box.mute.clear()
        self.box.selection = None
        self.box.attach()
        probe.wait_item("history", number=39)
        self.assertEqual([h["number"] for h in probe.items("history")], list(range(2, 40)))

    def test_a_restart_is_told_and_nothing_is_asked_across_it(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.reboot()
        self.box.status()
        link = probe.wait_item("link", change=REBOOTED)
        self.assertEqual(link["boot"], self.box.boot)
        self.assertEqual(probe.ask("arm 8")["status"], "OPMS_OK")
        self.box.trigger(1)
        probe.wait_item("trigger", number=1, session=8)
        counters = probe.ask("counters")
        self.assertEqual((counters["reboots"], counters["missed"], counters["reports_lost"]),
                         (1, 0, 0))

    def test_a_restart_while_away_is_told_after_the_replug(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.box.reboot()
        self.box.attach()
        probe.wait_item("link", change=CONNECTED)
        probe.wait_item("link", change=REBOOTED)
        self.assertEqual(probe.ask("counters")["reboots"], 1)

    def test_calls_while_unplugged_fail_at_once_and_work_after_it(self):
        probe = self.armed()
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        for command in ("ping", "arm 9", "disarm", "settings", "set 50000", "history 7 1 5",
                        "bootloader"):
            with self.subTest(command=command):
                self.assertEqual(probe.ask(command)["status"], "OPMS_ERR_DEVICE")
        self.assertFalse(probe.ask("identity")["connected"])
        self.box.attach()
        probe.wait_item("link", change=CONNECTED)
        self.assertEqual(probe.ask("settings")["status"], "OPMS_OK")

    def test_calls_work_as_soon_as_the_connection_is_told(self):
        probe = self.open("callback=2", "poll=0")
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.box.attach()
        probe.wait_item("link", change=CONNECTED)  # and its teller is still on the way back
        self.assertTrue(probe.ask("identity")["connected"])
        self.assertEqual(probe.ask("ping")["status"], "OPMS_OK")

    def test_another_box_at_the_same_place_is_not_taken_for_the_first(self):
        probe = self.armed()
        self.box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.box.unique_id = "0011223344556677"
        self.box.attach()
        failed = probe.wait_item("link", change=FAILED)
        self.assertIn("0011223344556677", failed["message"])
        self.box.detach()
        self.box.unique_id = UNIQUE_ID
        self.box.attach()
        probe.wait_item("link", change=CONNECTED)

    def test_a_server_that_dies_and_comes_back_is_a_replug(self):
        probe = self.armed()
        port = self.box.port
        self.box.close()
        probe.wait_item("link", change=DISCONNECTED)
        again = FakeBox(port=port)
        self.addCleanup(again.close)
        probe.wait_item("link", change=CONNECTED)
        self.assertEqual(probe.ask("ping")["status"], "OPMS_OK")

    def test_silence_is_told_once(self):
        probe = self.open()
        probe.wait_item("link", change=SILENT)
        self.box.session = 3
        self.box.trigger(1)
        probe.wait_item("trigger", number=1)
        self.assertEqual(len([i for i in probe.items("link") if i["change"] == SILENT]), 1)


if __name__ == "__main__":
    unittest.main()
