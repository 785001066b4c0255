# SPDX-License-Identifier: Apache-2.0
"""`opms serve` as users start it, with a simulated box and camera."""
import importlib.util
import os
import select
import signal
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CAMERA = ROOT / "tests/data/bar/camera.yaml"
TOKEN = "token-of-the-tests-0123456789"


def load_client():
    """bindings/python/opms/client.py alone: it needs nothing of the package's extension."""
    path = ROOT / "bindings/python/opms/client.py"
    spec = importlib.util.spec_from_file_location("opms_client", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(*arguments, timeout_s=120):
    """`opms serve` that ends by itself. @return exit code, stdout, stderr."""
    done = subprocess.run([os.environ["OPMS"], "serve", *map(str, arguments)],
                          capture_output=True, text=True, timeout=timeout_s, check=False)
    return done.returncode, done.stdout, done.stderr


class Serve:
    def __init__(self, folder, *options, token=TOKEN):
        self.folder = Path(folder)
        self.talk = tempfile.TemporaryFile("w+")
        arguments = ["--camera", CAMERA, "--box", "simulated", "--listen", "127.0.0.1:0",
                     "--source", f"simulated:camera={CAMERA},frames=6,pictures=lazy",
                     "--folder", self.folder / "scans", *options]
        if token:
            secret = self.folder / "token"
            secret.write_text(token + "\n")
            secret.chmod(0o600)
            arguments += ["--token-file", secret]
        self.process = subprocess.Popen(
            [os.environ["OPMS"], "serve", *map(str, arguments)], stdout=subprocess.PIPE,
            stderr=self.talk, text=True)
        ready, _, _ = select.select([self.process.stdout], [], [], 120)
        self.url = self.process.stdout.readline().strip() if ready else ""
        if not self.url.startswith("http"):
            self.kill()
            raise AssertionError(f"opms serve does not listen: {self.said()}")
        self.port = int(self.url.split(":")[2].split("/")[0])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()

    def said(self):
        # Without a seek: the program writes at the same offset.
        return os.pread(self.talk.fileno(), 1 << 20, 0).decode()

    def end(self, number=signal.SIGTERM, timeout_s=120):
        """@return The exit code."""
        self.process.send_signal(number)
        return self.process.wait(timeout_s)

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.talk.close()
