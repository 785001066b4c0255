# SPDX-License-Identifier: Apache-2.0
"""A trigger box that does what a test tells it, behind the emulated box's socket.

It is independent of the firmware and of the library: docs/emulated-box.md and docs/wire.md are all
that it was written from. A test sends what reports it likes, or lets the box run by itself
(`live`): then ARM sends the preamble and a START on the line begins a run.
"""
import queue
import socket
import struct
import threading
import time

import box_wire as wire

ATTACHED, DETACHED, INPUT, DONE = 1, 2, 3, 4
OUTPUT, GET, SET, LINE, PLUG, POWER = 16, 17, 18, 19, 20, 21
OK, STALLED, GONE, TIMED_OUT = range(4)
UNIQUE_ID = "e66178c1a3551e2b"
MASK = 0xFFFFFFFF


class FakeBox:
    """One box, one host at a time. Faults are attributes that a test sets."""

    def __init__(self, live=False, port=0):
        self.lock = threading.RLock()
        self.listener = socket.create_server(("127.0.0.1", port))
        self.port = self.listener.getsockname()[1]
        self.host = None
        self.live = live
        self.unique_id = UNIQUE_ID
        self.version = wire.PROTOCOL
        self.boot, self.session = 0x1234ABCD, 0
        self.report_number = self.event_number = self.number = self.first_run = 0
        self.state = wire.IDLE
        self.start_ns = 0
        self.pulses = {}           # number: (time_ns, flags), what HISTORY tells
        self.settings, self.last_set, self.pending_reads = wire.DEFAULT_SETTINGS, 0, 0
        self.selection = None      # token, session, next, end
        self.attached = True
        self.mute, self.stalls = set(), set()  # report ids that are not answered, or stalled
        self.garble = {}           # report id: function of the bytes of an answer
        self.lose = set()          # numbers of pulses that are not reported
        self.lose_history = 0      # answers to GET HISTORY that get lost on the way
        self.wrong_gap_us = 0      # makes the second pulse of a preamble come late
        self.silent = False        # nothing is reported
        self.jumper_cycles = 0     # TRIG is wired to START, which sees pulses of this length
        self.commands = queue.Queue()
        self.history_gets = 0
        self.closing = False
        self.threads = [threading.Thread(target=self._serve, daemon=True)]
        self.threads += [threading.Thread(target=self._live, daemon=True)] if live else []
        for thread in self.threads:
            thread.start()

    # --- what a test does ----------------------------------------------------------------------

    def now_ns(self):
        return time.monotonic_ns() // 8 * 8

    def send(self, kind, payload=b""):
        with self.lock:
            if self.host:
                try:
                    self.host.sendall(struct.pack("<IB", len(payload) + 1, kind) + payload)
                except OSError:
                    self.host = None

    def report(self, data):
        if self.attached and not self.silent:
            self.send(INPUT, data)

    def next_report(self):
        self.report_number = (self.report_number + 1) & MASK
        return self.report_number

    def trigger(self, number, told=True, flags=wire.RUN_FLAG, time_ns=None, gaps=(0, 0)):
        """A pulse; told=False: its report gets lost on the way."""
        with self.lock:
            time_ns = number * 100_000_000 if time_ns is None else time_ns
            self.number = number
            self.pulses[number] = (time_ns, flags)
            data = wire.trigger(self.boot, self.session, self.next_report(), number, time_ns, flags,
                                self.start_ns, self.first_run, gaps)
            if told:
                self.report(data)

    def status(self):
        with self.lock:
            self.report(wire.status(self.boot, self.session, self.next_report(), self.state,
                                    self.now_ns() // 1000, self.number, self.first_run,
                                    self.settings))

    def event(self, kind, argument=0, detail=0, time_ns=None):
        with self.lock:
            self.event_number += 1
            self.report(wire.event(self.boot, self.session, self.next_report(), self.event_number,
                                   kind, self.state, time_ns or self.now_ns(), argument, detail))

    def detach(self):
        with self.lock:
            self.attached = False
            self.send(DETACHED)

    def attach(self):
        with self.lock:
            self.attached = True
            self._say_attached()

    def reboot(self):
        with self.lock:
            self.boot += 1
            self.session = self.report_number = self.event_number = self.number = 0
            self.state, self.pulses, self.selection = wire.IDLE, {}, None

    def drop_host(self):
        """The server's process dies."""
        with self.lock:
            if self.host:
                self.host.shutdown(socket.SHUT_RDWR)

    def close(self):
        self.closing = True
        try:
            self.listener.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.listener.close()
        self.drop_host()
        for thread in self.threads:
            thread.join(5)

    # --- the socket ----------------------------------------------------------------------------

    def _say_attached(self):
        serial, product = self.unique_id.encode(), b"OPMS trigger box"
        self.send(ATTACHED, struct.pack("<HHHB", 0x1209, 1, 0x0020, len(serial)) + serial +
                  bytes([len(product)]) + product)

    def _serve(self):
        while not self.closing:
            try:
                host, _ = self.listener.accept()
            except OSError:
                return
            host.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            with self.lock:
                self.host = host
                if self.attached:
                    self._say_attached()
            try:
                while self._take_message(host):
                    pass
            except OSError:
                pass
            with self.lock:
                self.host = None
            host.close()

    def _take_message(self, host):
        head = self._exactly(host, 5)
        if not head:
            return False
        length, kind = struct.unpack("<IB", head)
        payload = self._exactly(host, length - 1)
        if payload is None:
            return False
        with self.lock:
            self._handle(kind, payload)
        return True

    @staticmethod
    def _exactly(host, size):
        data = b""
        while len(data) < size:
            part = host.recv(size - len(data))
            if not part:
                return None
            data += part
        return data

    def _done(self, request, status, data=b""):
        self.send(DONE, struct.pack("<IB", request, status) + data)

    def _handle(self, kind, payload):
        if kind == LINE:
            line, level, delay_ns = struct.unpack("<BBQ", payload)
            if line == 0 and level and self.live:
                threading.Timer(delay_ns / 1e9, self._start).start()
        elif kind == PLUG:
            self.attach() if payload[0] else self.detach()
        elif kind == POWER:
            self.detach()
            self.reboot()
            self.attach()
        elif kind in (OUTPUT, GET, SET):
            self._transfer(kind, struct.unpack_from("<I", payload)[0], payload[4:])

    def _transfer(self, kind, request, data):
        report_id = data[0]
        if not self.attached:
            self._done(request, GONE)
        elif report_id in self.mute:
            return
        elif report_id in self.stalls:
            self._done(request, STALLED)
        elif kind == GET:
            answer = self._get(report_id)
            if report_id == wire.HISTORY and self.lose_history:
                self.lose_history -= 1
                answer = bytes(64)
            answer = self.garble.get(report_id, lambda b: b)(answer)
            self._done(request, OK if answer else STALLED, answer or b"")
        elif not wire.reads(data, report_id):
            self.commands.put(("malformed", data))
            self._done(request, OK)
        else:
            self._done(request, OK)
            (self._command if kind == OUTPUT else self._set)(data)

    # --- the box -------------------------------------------------------------------------------

    def _get(self, report_id):
        if report_id == wire.IDENTITY:
            return wire.identity(self.boot, self.unique_id, self.version)
        if report_id == wire.SETTINGS:
            self.pending_reads = max(0, self.pending_reads - 1)
            return wire.settings(self.settings, self.last_set, self.pending_reads > 0)
        if report_id == wire.HISTORY:
            return self._history()
        return None

    def _history(self):
        self.history_gets += 1
        token, session, at, end = self.selection or (0, 0, 0, 0)
        entries = []
        while at < end and len(entries) < 2:
            time_ns, flags = self.pulses.get(at, (0, wire.NOT_HELD_FLAG))
            entries.append((at, time_ns, flags))
            at += 1
        if self.selection:
            self.selection = (token, session, at, end)
        held = session if session == self.session else 0
        return wire.history(self.boot, token, held, end - at, entries)

    def _set(self, data):
        if data[0] == wire.HISTORY:
            token, session, first, count = struct.unpack_from("<HIIH", data, 2)
            self.commands.put(("history", session, first, count))
            self.selection = (token, session, first, first + count)
        elif data[0] == wire.SETTINGS:
            self.commands.put(("settings", data[4:36]))
            self.last_set = 0 if self.state == wire.IDLE else wire.REFUSED_STATE
            self.pending_reads = 3
            if self.last_set == 0:
                self.settings = data[4:36]
            else:
                self.event(wire.EVENT_REFUSED, wire.SETTINGS, self.last_set)
        elif data[0] == wire.BOOTLOADER:
            self.commands.put(("bootloader", struct.unpack_from("<I", data, 4)[0]))
            if self.state == wire.IDLE:
                self.detach()
            else:
                self.event(wire.EVENT_REFUSED, wire.BOOTLOADER, wire.REFUSED_STATE)

    def _command(self, data):
        opcode, argument = data[2], struct.unpack_from("<I", data, 4)[0]
        self.commands.put((opcode, argument))
        if opcode == wire.PING:
            received = self.now_ns()
            self.report(wire.pong(self.boot, self.next_report(), argument, received,
                                  self.now_ns()))
        elif opcode == wire.ARM and self.state == wire.IDLE:
            self.session, self.number, self.first_run = argument, 0, 0
            self.start_ns, self.pulses = 0, {}
            self.state = wire.ARMED
            self.event(wire.EVENT_ARMED, argument)
        elif opcode == wire.ARM:
            self.event(wire.EVENT_REFUSED, wire.COMMAND + 256 * wire.ARM, wire.REFUSED_STATE)
        elif opcode == wire.DISARM and self.state != wire.IDLE:
            self.state = wire.IDLE
            self.event(wire.EVENT_STOP, self.number)

    # --- a box that runs by itself ---------------------------------------------------------------

    def _live(self):
        last_status = self.now_ns()
        while not self.closing:
            with self.lock:
                if self.state == wire.ARMED:
                    self._begin_preamble()
                elif self.state in (wire.PREAMBLE, wire.RUNNING) and self.now_ns() >= self.due_ns:
                    self._pulse()
                if self.now_ns() - last_status >= 1_000_000_000:
                    last_status = self.now_ns()
                    self.status()
            time.sleep(0.002)

    def _begin_preamble(self):
        self.gaps_ms = [gap for gap in struct.unpack_from("<8H", self.settings, 16) if gap]
        self.late = self.wrong_gap_us
        self.due_ns = self.now_ns() + 10_000_000
        self.state = wire.PREAMBLE if self.gaps_ms else wire.WAITING
        if not self.gaps_ms:
            self.event(wire.EVENT_WAITING, 0)

    def _pulse(self):
        number, due_ns = self.number + 1, self.due_ns
        flags = wire.RUN_FLAG if self.state == wire.RUNNING else wire.PREAMBLE_FLAG
        gaps = [self._gap_us(due_ns, number - 1), self._gap_us(None, number - 1)]
        self.trigger(number, number not in self.lose, flags, due_ns, gaps)
        if self.jumper_cycles and flags == wire.PREAMBLE_FLAG:
            if self._start_takes_the_end_of_a_pulse():
                self._run(due_ns + 1000 * struct.unpack_from("<I", self.settings, 4)[0])
                return
            self.event(wire.EVENT_GLITCH, self.jumper_cycles)
        if flags == wire.RUN_FLAG:
            self.due_ns = due_ns + 1000 * struct.unpack_from("<I", self.settings)[0]
        elif number <= len(self.gaps_ms):
            self.due_ns = due_ns + 1_000_000 * self.gaps_ms[number - 1] + 1000 * self.late
            self.late = 0
        else:
            self.state = wire.WAITING
            self.event(wire.EVENT_WAITING, number)

    def _gap_us(self, time_ns, before):
        """From pulse `before` to this time, or (None) from the one before it to it."""
        if time_ns is None:
            return self._gap_us(self.pulses[before][0], before - 1) if before in self.pulses else 0
        gap = time_ns // 1000 - self.pulses[before][0] // 1000 if before in self.pulses else 0
        return gap if gap < 1 << 24 else 0

    def _start_takes_the_end_of_a_pulse(self):
        """With the jumper: is START's edge the one opposite to that which begins TRIG's pulses?"""
        trig_active_low, start_falling_edge = self.settings[12] & 1, self.settings[12] >> 1 & 1
        return trig_active_low != start_falling_edge

    def _start(self):
        with self.lock:
            if self.state == wire.WAITING:
                self._run(self.now_ns())

    def _run(self, start_ns):
        self.start_ns = start_ns
        self.first_run = self.number + 1
        debounce, = struct.unpack_from("<I", self.settings, 8)
        self.due_ns = self.start_ns + 8 * (debounce + 4)
        self.state = wire.RUNNING
        self.event(wire.EVENT_START, self.first_run, time_ns=self.start_ns)
