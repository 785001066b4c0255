# SPDX-License-Identifier: Apache-2.0
"""Many clients of the stream, slow and broken ones among them, against the real server."""
import json
import threading
import unittest

from console_kit import TOKEN, Bench, eventually
from ws_kit import BINARY, TEXT, Closed, RawSocket, Refused

CLIENTS, STALLED, POSES = 50, 10, 1500


class Follower(threading.Thread):
    """Reads poses up to the last one."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.socket = RawSocket(port, TOKEN, "/api/v1/stream?kinds=pose")
        self.socket.receive_schema("opms.hello/1")
        self.numbers, self.missed, self.failure = [], 0, None
        self.start()

    def run(self):
        try:
            while not self.numbers or self.numbers[-1] < POSES:
                message = self.socket.receive()
                if message["schema"] == "opms.missed/1":
                    self.missed += message["missed"]["pose"]
                else:
                    self.numbers.append(message["picture"])
        except Exception as failure:  # told by the test, in its own thread
            self.failure = failure


class Load(unittest.TestCase):
    def test_stalled_clients_delay_nobody_and_are_closed(self):
        with Bench("--stall-ms", 1000) as bench:
            stalled = [RawSocket(bench.port, TOKEN, "/api/v1/stream?squares=1", receive_bytes=4096)
                       for _ in range(STALLED)]
            fast = [Follower(bench.port) for _ in range(CLIENTS - STALLED)]
            eventually(lambda: bench.figures()["clients"] == CLIENTS, "50 clients")
            for first in range(0, POSES, 50):
                # The answer comes when all 50 calls of the listener have returned.
                self.assertEqual(bench.ask("pose 50"), "published 50")
                # As fast as the clients read, so that what is missed is missed by the slow alone.
                eventually(lambda: all(f.failure or f.numbers[-1:] >= [first + 50] for f in fast),
                           "the poses at the fast clients")
                self.assertEqual(bench.call("GET", "/api/v1/pose")[0], 200)
            for follower in fast:
                follower.join(60)
                self.assertIsNone(follower.failure)
                self.assertEqual(follower.missed, 0)
                self.assertEqual(follower.numbers, list(range(1, POSES + 1)))
            eventually(lambda: bench.figures()["stalled"] == STALLED, "the end of the stalled")
            figures = bench.figures()
            self.assertEqual(figures["published"], POSES)
            self.assertEqual(figures["lost"], 0)
            for client in stalled:
                with self.assertRaises((Closed, ConnectionError)):
                    while True:
                        client.receive()
                client.close()
            for follower in fast:
                follower.socket.close()
            eventually(lambda: bench.figures()["clients"] == 0, "the end of all clients")

    def test_a_slow_client_is_told_what_it_missed_and_loses_count_of_nothing(self):
        with Bench("--stall-ms", 60000) as bench:
            slow = RawSocket(bench.port, TOKEN, "/api/v1/stream?kinds=pose&squares=1",
                             receive_bytes=4096)
            slow.receive_schema("opms.hello/1")  # from here on it is told of all
            self.assertEqual(bench.ask("pose 2000"), "published 2000")
            eventually(lambda: bench.call("GET", "/api/v1/pose")[2].get("picture") == 2000,
                       "the last")
            slow.send({"type": "subscribe", "id": "sync"})
            poses, missed, last = 0, 0, 0
            while last < 2000:
                message = slow.receive()
                if message["schema"] == "opms.missed/1":
                    missed += message["missed"]["pose"]
                elif message["schema"] == "opms.pose/1":
                    self.assertEqual(len(message["squares"]), 20)
                    self.assertGreater(message["picture"], last)
                    last, poses = message["picture"], poses + 1
            self.assertGreater(missed, 0)
            self.assertEqual(poses + missed, 2000)
            slow.close()

    def test_no_more_clients_than_the_limit_and_a_place_comes_free(self):
        with Bench("--clients", 3) as bench:
            clients = [RawSocket(bench.port, TOKEN) for _ in range(3)]
            for client in clients:
                client.receive_schema("opms.hello/1")
            with self.assertRaises(Refused) as refused:
                RawSocket(bench.port, TOKEN)
            self.assertEqual(refused.exception.status, 503)
            self.assertEqual(json.loads(refused.exception.body)["error"]["code"], "clients")
            self.assertEqual(bench.call("GET", "/api/v1/state")[0], 200)
            clients.pop().close()
            eventually(lambda: bench.figures()["clients"] == 2, "a free place")
            clients.append(RawSocket(bench.port, TOKEN))
            clients[-1].receive_schema("opms.hello/1")
            for client in clients:
                client.close()

    def test_a_client_that_is_not_there_any_more_is_found_out(self):
        with Bench("--idle-ms", 4000) as bench:
            silent = RawSocket(bench.port, TOKEN)  # answers no ping
            alive = RawSocket(bench.port, TOKEN)
            alive.receive_schema("opms.hello/1")
            eventually(lambda: bench.ask("event") and alive.receive_schema("opms.event/1")
                       and bench.figures()["clients"] == 1, "the end of the silent one")
            silent.close()
            alive.close()


class Stream(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = Bench()

    @classmethod
    def tearDownClass(cls):
        cls.bench.end()

    def open(self, target="/api/v1/stream", **options):
        client = RawSocket(self.bench.port, TOKEN, target, **options)
        self.addCleanup(client.close)
        self.assertEqual(client.receive()["schema"], "opms.hello/1")
        return client

    def test_nobody_enters_without_the_token(self):
        for token in (None, "wrong"):
            with self.assertRaises(Refused) as refused:
                RawSocket(self.bench.port, token)
            self.assertEqual(refused.exception.status, 401)
        for headers, status in ((["Origin: http://evil.example"], 403),
                                (["Sec-Fetch-Site: cross-site"], 403)):
            with self.assertRaises(Refused) as refused:
                RawSocket(self.bench.port, TOKEN, headers=headers)
            self.assertEqual(refused.exception.status, status)
        for target, status in (("/api/v1/stream?kinds=all", 400), ("/api/v1/state", 400),
                               ("/elsewhere", 404)):
            with self.assertRaises(Refused) as refused:
                RawSocket(self.bench.port, TOKEN, target)
            self.assertEqual(refused.exception.status, status)

    def test_a_browser_s_token_is_a_subprotocol_and_is_not_sent_back(self):
        client = RawSocket(self.bench.port, None,
                           headers=[f"Sec-WebSocket-Protocol: opms.v1, opms.token.{TOKEN}"])
        self.addCleanup(client.close)
        self.assertEqual(client.headers["sec-websocket-protocol"], "opms.v1")

    def test_a_client_hears_the_kinds_that_it_chose(self):
        client = self.open("/api/v1/stream?kinds=event")
        self.bench.ask("pose 1")
        self.bench.ask("event")
        self.assertEqual(client.receive()["schema"], "opms.event/1")
        client.send({"type": "subscribe", "kinds": ["pose"], "id": 5})
        reply = client.receive_schema("opms.subscribed/1")
        self.assertEqual((reply["kinds"], reply["id"]), (["pose"], 5))
        self.bench.ask("event")
        self.bench.ask("pose 1")
        self.assertEqual(client.receive()["schema"], "opms.pose/1")

    def test_samples_go_in_by_the_stream(self):
        client = self.open()
        sample = {"sensor": "md", "t_scan_s": 1.5, "values": [1, -2]}
        self.bench.ask("scan")
        client.send({"type": "samples", "samples": sample, "id": "a"})
        self.assertEqual(client.receive_schema("opms.error/1")["error"]["code"], "state")
        self.bench.ask("scan lane")
        client.send({"type": "samples", "samples": [sample, sample], "id": "b"})
        reply = client.receive_schema("opms.accepted/1")
        self.assertEqual((reply["samples"], reply["id"]), (2, "b"))
        client.send({"type": "samples", "samples": [sample, {"sensor": "md"}]})
        self.assertEqual(client.receive_schema("opms.error/1")["error"]["code"], "value")

    def test_each_of_many_messages_at_once_is_answered_in_order(self):
        client = self.open("/api/v1/stream?kinds=")
        for i in range(200):
            client.send({"type": "subscribe", "id": i})
        for i in range(200):
            self.assertEqual(client.receive()["id"], i)

    def test_messages_that_are_no_json_are_answered_and_the_stream_goes_on(self):
        client = self.open("/api/v1/stream?kinds=")
        for text in (b"", b"{", b"[[[[[[[[[[[[[[[[[[", b"[]", b'{"type":7}', b'{"a":NaN}'):
            client.send_frame(TEXT, text)
            self.assertEqual(client.receive()["schema"], "opms.error/1", text)

    def test_messages_that_are_too_large_torn_or_not_text_end_that_client_alone(self):
        other = self.open("/api/v1/stream?kinds=pose")
        frames = [(TEXT, b" ", True, (1 << 20) + 1), (TEXT, b"", True, 1 << 62),
                  (BINARY, b"x", True, None), (TEXT, b"\xff", True, None), (3, b"", True, None),
                  (0, b"", True, None)]
        for frame in frames:
            client = self.open("/api/v1/stream?kinds=")
            client.send_frame(*frame)
            with self.assertRaises((Closed, ConnectionError)):
                client.receive()
        self.bench.ask("pose 1")
        self.assertEqual(other.receive()["schema"], "opms.pose/1")

    def test_the_server_says_goodbye_when_it_ends(self):
        with Bench() as bench:
            client = RawSocket(bench.port, TOKEN)
            client.receive_schema("opms.hello/1")
            bench.process.stdin.close()
            with self.assertRaises(Closed) as closed:
                client.receive()
            self.assertEqual(closed.exception.code, 1001)
            client.close()


if __name__ == "__main__":
    unittest.main()
