# SPDX-License-Identifier: Apache-2.0
"""Latency, processor time and memory of the live system: `./run bench --live`.

Each row is one run of tests/bench/live/bench_live.cpp: at least 600 different pictures, rendered
beforehand and held in memory, box and camera simulated in the process; and one row with the real
firmware in the emulator. What the simulated devices need themselves is measured by a run without
a session and shown apart. A deadline is missed where the pose takes longer than a period. A pose
goes out with its pair; where a strobe is wired that is known with the next pulse's report.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

from bench_build import ROOT

CAMERA = ROOT / "tests/data/bar/camera.yaml"
RATES_HZ = (10, 30, 60)
SERVER = ROOT / "tests/emulator/box_server.mjs"
START_S = 120  # rendering and starting may take that long on a busy machine


HEAD = ("| | pictures | to the pose: p50, ms | p99 | p99.9 | most | missed deadlines | "
        "pose and pair: p50, ms | p99 | no buffer | cores, session | cores, generator | "
        "session, MB | grown, MB |\n|" + "---|" * 14)


def build(work: Path) -> Path | None:
    """A release build of its own, with the live system and this bench alone."""
    folder = work / "live"
    for command in (
        ["cmake", "-S", str(ROOT), "-B", str(folder), "-DCMAKE_BUILD_TYPE=Release",
         "-DOPMS_BUILD_TESTS=OFF", "-DOPMS_BENCH_LIVE=ON"],
        ["cmake", "--build", str(folder), "--target", "bench_live", "--parallel", "2"],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            print(f"bench: {' '.join(command)}:\n{done.stdout[-500:]}{done.stderr[-1000:]}",
                  file=sys.stderr)
            return None
    return next(path for path in folder.rglob("bench_live") if path.is_file())


def measure(program: Path, box: str, source: str, hz: float, seconds: float,
            *more: str) -> dict | None:
    done = subprocess.run(
        [str(program), box, source, str(CAMERA), str(hz), str(seconds), *more],
        capture_output=True, text=True, timeout=seconds + 4 * START_S)
    if done.returncode:
        print(f"bench: {done.stderr.strip()}", file=sys.stderr)
        return None
    return json.loads(done.stdout)


def simulated_rows(program: Path, pictures: str, seconds: float):
    for hz in RATES_HZ:
        text = f"{pictures},hz={hz},ping_ms=100"
        whole = measure(program, text, text, hz, seconds)
        alone = measure(program, text, text, hz, seconds, "--generator")
        if whole and alone:
            yield f"{hz} Hz, simulated box", whole, alone


def emulated_row(program: Path, pictures: str, seconds: float, firmware: Path | None):
    """The box is a process of its own here: its load is not in the figures."""
    firmware = firmware or ROOT / "build/firmware/opms-box.uf2"
    if not firmware.is_file() or shutil.which("node") is None:
        print(f"bench: no row with the emulated firmware: it needs node and {firmware} "
              "(./run firmware)", file=sys.stderr)
        return
    port = 47753
    server = subprocess.Popen(
        ["node", str(SERVER), "--port", str(port), "--wires", str(port + 1),
         "--firmware", str(firmware)], stdout=subprocess.PIPE, text=True)
    try:
        server.stdout.readline()
        server.stdout.readline()
        whole = measure(program, f"emulated:{port}", f"{pictures},wires={port + 1}", 10, seconds)
        if whole:
            yield "10 Hz, firmware in the emulator", whole, None
    finally:
        server.terminate()
        server.wait()


def row_text(name: str, whole: dict, alone: dict | None) -> str:
    located, published = whole["located_ms"], whole["published_ms"]
    cores = whole["cores"] - alone["cores"] if alone else whole["cores"]
    own = f"{alone['cores']:.2f}" if alone else "in it"
    cells = [name, whole["pictures"]]
    cells += [f"{located[figure]:.1f}" for figure in ("p50", "p99", "p999", "most")]
    cells += [whole["missed"], f"{published['p50']:.1f}", f"{published['p99']:.1f}"]
    cells += [whole["no_buffer"], f"{cores:.2f}", own, f"{whole['session_mb']:.0f}",
              f"{whole['grown_mb']:+.1f}"]
    return f"| {' | '.join(map(str, cells))} |"


def live(quick: bool, work: Path, firmware: Path | None) -> bool:
    """Print the table. @return Whether all rows are there and no deadline was missed."""
    program = build(work)
    if program is None:
        return False
    frames, seconds = (20, 4.0) if quick else (600, 60.0)
    cache = work / "live-pictures"
    cache.mkdir(parents=True, exist_ok=True)
    # One path for all rates, so that its pictures are rendered once.
    pictures = f"simulated:frames={frames},camera={CAMERA},cache={cache},path_period=0.1"
    rows = list(simulated_rows(program, pictures, seconds))
    simulated = len(rows)
    rows += list(emulated_row(program, pictures, seconds, firmware))
    print(HEAD)
    for row in rows:
        print(row_text(*row))
    missed = sum(whole["missed"] for _, whole, _ in rows)
    print(f"bench: live: {frames} different pictures, {seconds:.0f} s a row, "
          f"{missed} missed deadlines")
    return simulated == len(RATES_HZ) and missed == 0
