# SPDX-License-Identifier: Apache-2.0
"""What the bench needs besides the library: its timing programs, and Napa where it may be had."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent


def build_program(name: str, release: Path, work: Path) -> Path | None:
    """Builds a timing program against the release build, installed into the bench's own folder."""
    prefix, build = work / "installed", work / "program"
    commands = [
        ["cmake", "--install", str(release), "--prefix", str(prefix)],
        ["cmake", "-S", str(HERE), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release",
         f"-DCMAKE_PREFIX_PATH={prefix}"],
        ["cmake", "--build", str(build), "--target", name],
    ]
    for command in commands:
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            print(f"bench: {' '.join(command)}:\n{done.stdout[-500:]}{done.stderr[-1000:]}",
                  file=sys.stderr)
            return None
    return build / name


def install_napa() -> None:
    """Into this Python's own environment only; a failure means that Napa is not available."""
    if importlib.util.find_spec("napa_vision") or sys.prefix == sys.base_prefix:
        return
    print("bench: installing Napa to measure it. It is under the PolyForm Noncommercial licence "
          "1.0.0 and no part of this project; --no-napa leaves it out.", file=sys.stderr)
    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet",
                    "--disable-pip-version-check", "-r", str(HERE / "requirements-napa.txt")],
                   check=False)
    importlib.invalidate_caches()
