# SPDX-License-Identifier: Apache-2.0
"""The Python client's stream, by the package websockets, against the real server."""
import ssl
import tempfile
import threading
import unittest
from pathlib import Path

from console_kit import TOKEN, Bench
from serve_kit import load_client
from test_console_tls import make_certificate

client_module = load_client()
Client, ClientError = client_module.Client, client_module.ClientError


class ClientStream(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bench = Bench()
        cls.addClassCleanup(cls.bench.end)

    def client(self, token=TOKEN):
        client = Client(f"http://127.0.0.1:{self.bench.port}", token)
        self.addCleanup(client.close)
        return client

    def test_poses_come_as_they_are_published(self):
        poses = self.client().poses()
        seen = threading.Event()

        def publish():
            while not seen.wait(0.1):
                self.bench.ask("pose 1")

        # Nobody tells when the client is in, and what was published before does not come.
        publisher = threading.Thread(target=publish)
        publisher.start()
        try:
            first = next(poses)
            second = next(poses)
        finally:
            seen.set()
            publisher.join()
        self.assertEqual(second["picture"], first["picture"] + 1)
        self.assertEqual(second["missed"], 0)
        poses.close()

    def test_a_stream_takes_samples_and_answers(self):
        self.bench.ask("scan lane")
        with self.client().stream(kinds=()) as stream:
            self.assertEqual(stream.receive(60)["schema"], "opms.hello/1")
            stream.send_samples({"sensor": "md", "values": [1.0]})
            self.assertEqual(stream.receive(60), {"schema": "opms.accepted/1", "samples": 1})
            with self.assertRaises(TimeoutError):
                stream.receive(0.05)

    def test_a_wrong_token_is_refused_as_in_a_call(self):
        for act in (lambda c: c.stream(), lambda c: c.state()):
            with self.assertRaises(ClientError) as refused:
                act(self.client("wrong-token-of-the-tests"))
            self.assertEqual((refused.exception.status, refused.exception.code), (401, "token"))

    def test_iterating_ends_when_the_server_goes(self):
        with Bench() as bench, Client(f"http://127.0.0.1:{bench.port}", TOKEN) as client:
            messages = iter(client.stream())
            self.assertEqual(next(messages)["schema"], "opms.hello/1")
            bench.process.stdin.close()
            self.assertEqual(list(messages), [])

    def test_nobody_there_is_an_error_of_its_own(self):
        with Bench() as bench:
            url = f"http://127.0.0.1:{bench.port}"
        for act in (lambda c: c.stream(), lambda c: c.state()):
            with self.assertRaises(ClientError) as refused:
                act(Client(url, TOKEN))
            self.assertEqual(refused.exception.status, 0)
        for url in ("ftp://a", "127.0.0.1:80", "http://"):
            with self.assertRaises(ValueError):
                Client(url, TOKEN)

    def test_tls_with_a_certificate_of_one_s_own(self):
        with tempfile.TemporaryDirectory() as folder:
            cert, key = make_certificate(Path(folder), "own")
            with Bench("--cert", cert, "--key", key) as bench:
                context = ssl.create_default_context(cafile=cert)
                url = f"https://127.0.0.1:{bench.port}/api/v1/"
                with Client(url, TOKEN, context=context) as client, client.stream() as stream:
                    self.assertEqual(client.state()["state"], "idle")
                    self.assertEqual(stream.receive(60)["schema"], "opms.hello/1")
                with self.assertRaises(ClientError):
                    Client(url, TOKEN).state()


if __name__ == "__main__":
    unittest.main()
