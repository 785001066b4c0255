# SPDX-License-Identifier: Apache-2.0
"""What the tests of opms::hid share: a fake box, and the probe program at the other end."""
import contextlib
import json
import os
import queue
import subprocess
import sys
import threading
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from fake_box import FakeBox  # noqa: E402

PROBE = os.environ.get("HID_PROBE", "hid_probe")
PATIENCE_S = 30  # only how long a broken test takes to fail
CONNECTED, DISCONNECTED, REBOOTED, SILENT, FAILED = 1, 2, 3, 4, 5
REPORTS, TRIGGERS, UNFILLED, ITEMS = 1, 2, 3, 4


class Probe:
    """The probe, its commands and its lines."""

    def __init__(self, port, *options):
        self.process = subprocess.Popen([PROBE, str(port), *options], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        self.lines = queue.Queue()
        self.seen = []
        self.unread = []   # items that came while an answer was waited for
        self.replies = []  # answers that came while an item was waited for
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(json.loads(line))
        self.lines.put(None)

    def next(self):
        line = self.lines.get(timeout=PATIENCE_S)
        if line is None:
            raise AssertionError(f"the probe ended ({self.process.wait()}); seen: {self.seen}")
        self.seen.append(line)
        return line

    def send(self, command):
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()

    def reply(self, name):
        """The next answer of that name; items before it can still be waited for."""
        while True:
            line = self.replies.pop(0) if self.replies else self.next()
            if line.get("reply") == name:
                return line
            if "item" in line:
                self.unread.append(line)

    def ask(self, command):
        self.send(command)
        return self.reply(command.split()[0])

    def wait_item(self, item, **fields):
        """The next item with these fields; what comes before it is kept in `seen`."""
        while True:
            line = self.unread.pop(0) if self.unread else self.next()
            if "reply" in line:
                self.replies.append(line)
            if line.get("item") == item and all(line.get(k) == v for k, v in fields.items()):
                return line

    def items(self, item):
        return [line for line in self.seen if line.get("item") == item]

    def close(self):
        if self.process.poll() is None:
            try:
                self.send("close")
            except OSError:
                pass
        try:
            self.process.wait(PATIENCE_S)
        finally:
            self.process.kill()
            self.reader.join(PATIENCE_S)
            with contextlib.suppress(BrokenPipeError):
                self.process.stdin.close()
            self.process.stdout.close()
        return self.process.returncode


class HidTest(unittest.TestCase):
    """A test with a fake box; `open()` connects a probe to it."""

    def setUp(self):
        self.box = FakeBox()
        self.addCleanup(self.box.close)

    def probe(self, *options, port=None):
        probe = Probe(port or self.box.port, *options)
        self.addCleanup(self._end, probe)
        return probe

    def _end(self, probe):
        self.assertEqual(probe.close(), 0, "the probe must end well")

    def open(self, *options):
        probe = self.probe(*options)
        self.assertEqual(probe.reply("open"), {"reply": "open", "status": "OPMS_OK",
                                               "message": ""})
        return probe

    def armed(self, *options, session=7):
        probe = self.open(*options)
        self.assertEqual(probe.ask(f"arm {session}")["status"], "OPMS_OK")
        self.box.state = 4
        return probe
