# SPDX-License-Identifier: Apache-2.0
"""TLS with a certificate that is made for the test."""
import http.client
import socket
import ssl
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

from console_kit import TOKEN, Bench
from ws_kit import RawSocket


def make_certificate(folder, name):
    cert, key = folder / f"{name}.pem", folder / f"{name}.key"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
         "-nodes", "-keyout", key, "-out", cert, "-days", "2", "-subj", "/CN=opms test",
         "-addext", "subjectAltName=IP:127.0.0.1"], check=True, capture_output=True)
    return cert, key


class Tls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        folder = Path(cls.folder.name)
        cls.cert, cls.key = make_certificate(folder, "own")
        cls.other, _ = make_certificate(folder, "other")
        cls.bench = Bench("--cert", cls.cert, "--key", cls.key)
        cls.addClassCleanup(cls.bench.end)

    def get(self, context, headers=None):
        connection = http.client.HTTPSConnection("127.0.0.1", self.bench.port, context=context,
                                                 timeout=60)
        try:
            connection.request("GET", "/api/v1/state", headers={
                "Authorization": f"Bearer {TOKEN}", **(headers or {})})
            response = connection.getresponse()
            response.read()
            return response.status
        finally:
            connection.close()

    def test_who_trusts_the_certificate_is_served(self):
        context = ssl.create_default_context(cafile=self.cert)
        self.assertEqual(self.get(context), 200)
        own = f"https://127.0.0.1:{self.bench.port}"
        self.assertEqual(self.get(context, {"Origin": own}), 200)
        self.assertEqual(self.get(context, {"Origin": own.replace("https", "http")}), 403)

    def test_another_certificate_is_not_taken_for_the_server_s(self):
        with self.assertRaises(ssl.SSLCertVerificationError):
            self.get(ssl.create_default_context(cafile=self.other))

    def test_protocols_older_than_tls_1_2_are_refused(self):
        context = ssl.create_default_context(cafile=self.cert)
        context.set_ciphers("ALL:@SECLEVEL=0")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # that is the point
            context.minimum_version = ssl.TLSVersion.TLSv1
            context.maximum_version = ssl.TLSVersion.TLSv1_1
        with self.assertRaises((ssl.SSLError, ConnectionError)):
            self.get(context)

    def test_plain_http_gets_nothing_from_a_tls_port(self):
        with socket.create_connection(("127.0.0.1", self.bench.port), timeout=60) as plain:
            plain.sendall(b"GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\n\r\n")
            try:
                self.assertNotIn(b"HTTP/1.1", plain.recv(1000))
            except ConnectionError:
                pass
        self.assertEqual(self.get(ssl.create_default_context(cafile=self.cert)), 200)

    def test_the_stream_runs_both_ways_over_tls(self):
        context = ssl.create_default_context(cafile=self.cert)
        client = RawSocket(self.bench.port, TOKEN, "/api/v1/stream?kinds=pose",
                           wrap=lambda s: context.wrap_socket(s, server_hostname="127.0.0.1"))
        self.assertEqual(client.receive()["schema"], "opms.hello/1")
        self.bench.ask("pose 300")  # while the client sends, too
        for i in range(50):
            client.send({"type": "subscribe", "id": i})
        poses, replies = 0, []
        while poses < 300 or len(replies) < 50:
            message = client.receive()
            if message["schema"] == "opms.pose/1":
                poses += 1
            elif message["schema"] == "opms.missed/1":
                poses += message["missed"]["pose"]
            else:
                replies.append(message["id"])
        self.assertEqual(replies, list(range(50)))
        client.close()


class BadCertificates(unittest.TestCase):
    def test_files_that_are_no_certificate_or_another_s_key_are_named(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            cert, key = make_certificate(folder, "one")
            _, other_key = make_certificate(folder, "two")
            for arguments, culprit in ((("--cert", key, "--key", key), key),
                                       (("--cert", folder / "none", "--key", key), "none"),
                                       (("--cert", cert, "--key", other_key), other_key)):
                with self.assertRaises(ValueError) as said:
                    Bench(*arguments)  # its first line is no port, but what is wrong
                self.assertIn(str(culprit), str(said.exception))


if __name__ == "__main__":
    unittest.main()
