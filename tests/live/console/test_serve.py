# SPDX-License-Identifier: Apache-2.0
"""`opms serve`: a Master PC's scan from the software start to the stop, and the program's end."""
import signal
import sqlite3
import tempfile
import unittest
from pathlib import Path

from console_kit import eventually
from serve_kit import CAMERA, TOKEN, Serve, load_client, run
from ws_kit import Closed, RawSocket

client_module = load_client()
Client, ClientError = client_module.Client, client_module.ClientError


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def serve(self, *options, **more):
        serve = Serve(self.folder, *options, **more)
        self.addCleanup(serve.kill)
        return serve

    def client(self, serve, token=TOKEN):
        client = Client(serve.url, token)
        self.addCleanup(client.close)
        return client

    def rows(self, scan, question):
        base = sqlite3.connect(self.folder / "scans" / scan / "scan.sqlite")
        try:
            return base.execute(question).fetchall()
        finally:
            base.close()


class Scan(Folder):
    def run_until(self, client, poses):
        """Start, press START when the box is READY, and wait for poses on the scan's axis."""
        eventually(lambda: client.state()["state"] == "ready", "READY")
        client.press_start()
        eventually(lambda: client.state()["poses"] >= poses, "poses")

    def a_picture(self, client, format):
        """The newest picture: a busy machine needs its buffer, and there is none for a moment."""
        def try_it():
            try:
                return client.picture(format)
            except ClientError as error:
                if error.status != 404:
                    raise
                return None
        return eventually(try_it, "a picture")

    def test_a_master_starts_follows_and_stops_a_scan(self):
        table = self.folder / "gpr.csv"
        table.write_text("t_scan_s,depth\n0.5,0.12\n0.75,0.13\n")
        serve = self.serve("--sensor", f"gpr={table}")
        client = self.client(serve)
        with self.assertRaises(ClientError) as refused:
            client.stop()
        self.assertEqual((refused.exception.status, refused.exception.code), (409, "state"))
        eventually(lambda: client.state()["camera_connected"] and client.state()["box_connected"],
                   "the devices")
        self.assertEqual(client.scan("lane 3"), "lane 3")
        stream = RawSocket(serve.port, TOKEN, "/api/v1/stream?kinds=pose")
        self.addCleanup(stream.close)
        self.run_until(client, 8)
        self.assertEqual(client.send_samples([
            {"sensor": "md", "t_scan_s": 0.25, "t_bound_s": 0.001, "number": 1, "values": [1.5]},
            {"sensor": "md", "values": [2.5, -1]}]), 2)
        timed = []
        while len(timed) < 5:
            message = stream.receive()
            # Pulses of the preamble have times before the start, in another rhythm.
            if message["schema"] == "opms.pose/1" and (message["t_scan_s"] or -1) >= 0:
                timed.append(message)
        stream.close()
        # A busy machine may lose pictures; what it gives has its own pulse's time.
        for before, after in zip(timed, timed[1:]):
            pulses = after["trigger"] - before["trigger"]
            self.assertGreater(pulses, 0)
            self.assertAlmostEqual(after["t_scan_s"] - before["t_scan_s"], 0.1 * pulses, delta=0.01)
        located = [pose for pose in timed if pose["state"] == "located"]
        self.assertTrue(located)
        self.assertEqual(len(located[0]["covariance"]), 6)
        self.assertEqual(self.a_picture(client, "png")[:4], b"\x89PNG")
        self.assertEqual(self.a_picture(client, "jpeg")[:2], b"\xff\xd8")
        end = client.stop()
        self.assertEqual(end["reason"], "stop")
        self.assertTrue(end["pairing"]["sums_hold"])
        summary = client.scan_summary("lane 3")
        self.assertGreaterEqual(summary["poses_with_time"], 8)
        self.assertEqual(summary["sensor_samples"], 4)
        self.assertEqual([s["name"] for s in client.scans()], ["lane 3"])
        self.assertEqual(self.rows("lane 3", "PRAGMA integrity_check"), [("ok",)])
        self.assertEqual(client.state()["state"], "idle")

    def test_a_second_scan_follows_and_a_name_that_is_taken_gets_a_number(self):
        serve = self.serve("--pictures", "none")
        client = self.client(serve)
        eventually(lambda: client.state()["camera_connected"] and client.state()["box_connected"],
                   "the devices")
        names = []
        for _ in range(2):
            names.append(client.scan("lane"))
            with self.assertRaises(ClientError) as refused:
                client.scan("other")
            self.assertEqual(refused.exception.status, 409)
            client.stop()
        self.assertEqual(names, ["lane", "lane-2"])

    def test_sigterm_stops_the_scan_closes_its_recording_and_says_goodbye(self):
        serve = self.serve()
        client = self.client(serve)
        eventually(lambda: client.state()["camera_connected"] and client.state()["box_connected"],
                   "the devices")
        client.scan("cut")
        self.run_until(client, 3)
        stream = RawSocket(serve.port, TOKEN)
        self.assertEqual(serve.end(signal.SIGTERM), 0, serve.said())
        with self.assertRaises(Closed) as closed:
            while True:
                stream.receive()
        self.assertEqual(closed.exception.code, 1001)
        stream.close()
        again = self.client(self.serve())
        summary = again.scan_summary("cut")
        self.assertEqual(summary["ended"]["reason"], "stop")
        self.assertGreaterEqual(summary["poses_with_time"], 3)

    def test_sigint_without_a_scan_ends_at_once(self):
        serve = self.serve()
        self.assertEqual(serve.end(signal.SIGINT), 0, serve.said())


class Entrance(Folder):
    def test_without_a_token_file_a_token_is_made_and_told(self):
        serve = self.serve(token=None)
        token = serve.said().split("token of this run: ")[1].split()[0]
        self.assertEqual(len(token), 43)
        self.assertEqual(self.client(serve, token).version()["api"], "v1")
        with self.assertRaises(ClientError) as refused:
            self.client(serve, token[:-1] + "!").state()
        self.assertEqual((refused.exception.status, refused.exception.code), (401, "token"))

    def test_other_machines_need_a_token_file_and_tls(self):
        secret = self.folder / "token"
        secret.write_text(TOKEN)
        secret.chmod(0o600)
        open_to_all = ["--camera", CAMERA, "--box", "simulated", "--source", "simulated",
                       "--listen", "0.0.0.0:0"]
        for options, word in (([], "--token-file"), (["--insecure"], "--token-file"),
                              (["--token-file", secret], "--cert"),
                              (["--token-file", secret, "--cert", secret], "--key")):
            code, out, said = run(*open_to_all, *options)
            self.assertEqual((code, out), (2, ""), said)
            self.assertIn(word, said)

    def test_a_token_that_others_can_read_is_refused(self):
        secret = self.folder / "token"
        secret.write_text(TOKEN)
        secret.chmod(0o644)
        code, _, said = run("--camera", CAMERA, "--box", "simulated", "--source", "simulated",
                            "--token-file", secret)
        self.assertEqual(code, 4)
        self.assertIn("chmod 600", said)

    def test_wrong_options_are_a_matter_of_use(self):
        base = ["--camera", CAMERA, "--box", "simulated", "--source", "simulated"]
        for options in (["--listen", "somewhere"], ["--sensor", "md"], ["--sensor", "a b=c"],
                        ["--cert", "a.pem"]):
            code, _, said = run(*base, *options)
            self.assertEqual(code, 2, said)
        code, _, said = run("--box", "simulated", "--source", "simulated")
        self.assertEqual(code, 2)
        self.assertIn("--camera", said)

    def test_a_port_that_is_taken_is_named(self):
        serve = self.serve()
        code, _, said = run("--camera", CAMERA, "--box", "simulated", "--source",
                            f"simulated:camera={CAMERA},frames=1,pictures=blank",
                            "--listen", f"127.0.0.1:{serve.port}")
        self.assertEqual(code, 4)
        self.assertIn(f"127.0.0.1:{serve.port} cannot be listened on", said)


if __name__ == "__main__":
    unittest.main()
