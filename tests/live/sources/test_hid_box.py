# SPDX-License-Identifier: Apache-2.0
"""The live system's box over opms::hid, against the box that is written in Python."""
import os
import socket
import sys
import unittest
from pathlib import Path

os.environ["HID_PROBE"] = os.environ["HID_BOX_PROBE"]
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "hid"))
import box_wire as wire  # noqa: E402
from fake_box import FakeBox  # noqa: E402
from hid_kit import CONNECTED, DISCONNECTED, Probe  # noqa: E402

DEVICE, USAGE = 2, 1


class HidBox(unittest.TestCase):
    def box(self, **options):
        box = FakeBox(**options)
        self.addCleanup(box.close)
        return box

    def probe(self, place, *options, code=0):
        probe = Probe(place, *options)
        self.addCleanup(lambda: self.assertEqual(probe.close(), code))
        return probe

    def opened(self, box, *options):
        probe = self.probe(f"emulated:{box.port}", *options)
        reply = probe.reply("open")
        self.assertTrue(reply["ok"], reply)
        self.assertEqual(reply["name"], f"emulated:{box.port}")
        return probe

    def test_a_run_from_arming_over_the_start_to_its_end(self):
        probe = self.opened(self.box(live=True))
        probe.wait_item("link", change=CONNECTED)
        self.assertTrue(probe.ask("settings")["ok"])
        self.assertTrue(probe.ask("arm")["ok"])
        self.assertEqual(probe.wait_item("trigger", number=1)["session"], 4711)
        probe.wait_item("event", kind=wire.EVENT_WAITING)
        self.assertTrue(probe.ask("start")["ok"])
        probe.wait_item("event", kind=wire.EVENT_START)
        probe.wait_item("trigger")
        self.assertTrue(probe.ask("disarm")["ok"])

    def test_pings_come_by_themselves(self):
        probe = self.opened(self.box())
        for _ in range(3):
            probe.wait_item("pong")

    def test_lost_pulses_are_filled_by_the_port(self):
        box = self.box()
        probe = self.opened(box)
        self.assertTrue(probe.ask("arm")["ok"])
        box.state = 4
        box.trigger(1)
        box.trigger(2, told=False)
        box.trigger(3)
        self.assertEqual(probe.wait_item("history")["number"], 2)

    def test_an_unplugged_box_comes_back(self):
        box = self.box()
        probe = self.opened(box)
        self.assertTrue(probe.ask("identity")["ok"])
        box.detach()
        probe.wait_item("link", change=DISCONNECTED)
        self.assertFalse(probe.ask("identity")["ok"])
        box.attach()
        probe.wait_item("link", change=CONNECTED)
        self.assertTrue(probe.ask("identity")["ok"])

    def test_a_box_that_is_not_there_is_a_device_error(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        probe = self.probe(f"emulated:{port}", code=1)
        reply = probe.reply("open")
        self.assertEqual((reply["ok"], reply["kind"]), (False, DEVICE))
        self.assertIn(f"port {port} is not running", reply["text"])

    def test_a_text_that_is_no_box_is_a_usage_error(self):
        reply = self.probe("usb", code=1).reply("open")
        self.assertEqual((reply["ok"], reply["kind"]), (False, USAGE))

    def test_a_box_that_is_missing_at_first_is_sought(self):
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        probe = self.probe(f"emulated:{port}", "wait")
        self.assertTrue(probe.reply("open")["ok"])
        probe.wait_item("link", change=DISCONNECTED)
        refused = probe.ask("arm")
        self.assertFalse(refused["ok"])
        self.assertIn("not been found", refused["text"])
        self.box(port=port)
        probe.wait_item("link", change=CONNECTED)
        self.assertTrue(probe.ask("arm")["ok"])


if __name__ == "__main__":
    unittest.main()
