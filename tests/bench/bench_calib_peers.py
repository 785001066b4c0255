# SPDX-License-Identifier: Apache-2.0
"""Calibration: time and residual beside OpenCV's calibrateCamera, node extraction, and the whole
way from pictures to the camera file.

Times are CPU times of one thread, the smallest of some repeats, so that a busy machine makes them
little longer.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import numpy as np

from bench_geometry import Lens, Pose, exp_so3, inside, project
from bench_report import machine
from bench_scenes import HOPE_LENS

PICTURES = 12
PITCH_M = 0.025
HALF_X, HALF_Y = 16, 22  # nodes of the grid a0-25 on each side of the centre
NOISE_PX = 0.03
# title, most nodes of a picture
SIZES = (("some 300", 300), ("some 1,000", 1000))
FASTER, RESIDUAL_MORE = 3.0, 1.001
NODES_MS, NODES_RMS_PX, FILE_S = 2.0, 0.03, 0.2


@dataclass(frozen=True)
class View:
    """Nodes of one picture."""

    target_m: np.ndarray  # (N, 2)
    px: np.ndarray  # (N, 2)


@dataclass(frozen=True)
class Answer:
    """Of one calibration: CPU time, lens (fx fy cx cy k1 k2 p1 p2), residual of all nodes."""

    seconds: float
    lens: np.ndarray
    rms_px: float


def cpu_seconds(call: Callable[[], object], repeats: int) -> tuple[float, object]:
    """The smallest CPU time of `repeats` calls, and what the last one gave."""
    least, result = np.inf, None
    for _ in range(repeats):
        start = time.process_time()
        result = call()
        least = min(least, time.process_time() - start)
    return least, result


def lift_pose(rng: np.random.Generator) -> Pose:
    """Camera to grid: looking down from 0.35 to 0.6 m, leaning up to some 30 degrees."""
    down = exp_so3(np.array([np.pi, 0.0, 0.0]))
    R = down @ exp_so3(np.array([0, 0, rng.uniform(-3, 3)])) @ exp_so3(
        np.r_[rng.uniform(-0.45, 0.45, 2), 0.0])
    at = np.array([*rng.uniform(-0.08, 0.08, 2), 0.0])
    return Pose(R, at - rng.uniform(0.35, 0.6) * R[:, 2])


def simulated_view(lens: Lens, most: int, rng: np.random.Generator) -> View:
    i, j = np.mgrid[-HALF_X:HALF_X + 1, -HALF_Y:HALF_Y + 1]
    target_m = np.column_stack([i.ravel(), j.ravel()]) * PITCH_M
    points = np.column_stack([target_m, np.zeros(len(target_m))])
    while True:
        px, seen = project(lens, lift_pose(rng), points)
        shown = np.nonzero(inside(lens, px, 3) & seen)[0]
        if len(shown) >= most / 2:
            break
    shown = np.sort(rng.permutation(shown)[:most])
    noise = NOISE_PX * rng.standard_normal((len(shown), 2))
    return View(target_m[shown], px[shown] + noise)


def solve_libopms(views: list[View], lens: Lens) -> Callable[[], object]:
    from opms import calib
    sigmas = [np.full(len(v.px), NOISE_PX) for v in views]

    def solve():
        calibrator = calib.Calibrator(lens.width, lens.height)
        for view, sigma_px in zip(views, sigmas):
            calibrator.add(view.target_m, view.px, sigma_px)
        return calibrator, calibrator.solve()

    return solve


def calibrate_libopms(views: list[View], lens: Lens, repeats: int) -> Answer:
    seconds, (calibrator, result) = cpu_seconds(solve_libopms(views, lens), repeats)
    found = result.lens
    numbers = [getattr(found, n) for n in ("fx_px", "fy_px", "cx_px", "cy_px",
                                           "k1", "k2", "p1", "p2")]
    residuals = np.concatenate([calibrator.residuals(k)[0] for k in range(len(views))])
    return Answer(seconds, np.array(numbers), rms_length(residuals))


def calibrate_opencv(views: list[View], lens: Lens, repeats: int) -> Answer:
    import cv2
    cv2.setNumThreads(1)
    target = [np.column_stack([v.target_m, np.zeros(len(v.px))]).astype(np.float32)
              for v in views]
    seen = [v.px.astype(np.float32).reshape(-1, 1, 2) for v in views]
    seconds, answer = cpu_seconds(
        lambda: cv2.calibrateCamera(target, seen, (lens.width, lens.height), None, None,
                                    flags=cv2.CALIB_FIX_K3), repeats)
    rms_px, matrix, distortion = answer[:3]
    numbers = np.r_[matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2],
                    distortion.ravel()[:4]]
    return Answer(seconds, numbers, rms_px)


def rms_length(residuals: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum(residuals**2, axis=1))))


def against_opencv(seed: int, repeats: int) -> tuple[list[str], list[tuple[str, bool]]]:
    try:
        import cv2
    except ImportError as error:
        return [f"OpenCV is not installed: {error}"], []
    lines = ["| 12 simulated pictures, nodes in hand | nodes | ms | RMS residual px | "
             "focal length off by px |", "|---|---|---|---|---|"]
    verdicts = []
    for title, most in SIZES:
        rng = np.random.default_rng((seed, most))
        views = [simulated_view(HOPE_LENS, most, rng) for _ in range(PICTURES)]
        nodes = sum(len(v.px) for v in views)
        own = calibrate_libopms(views, HOPE_LENS, repeats)
        peer = calibrate_opencv(views, HOPE_LENS, repeats)
        for name, answer in (("libopms", own), (f"OpenCV {cv2.__version__}", peer)):
            lines.append(f"| {name}, {title} each | {nodes} | {1e3 * answer.seconds:.2f} | "
                         f"{answer.rms_px:.5f} | {answer.lens[0] - HOPE_LENS.fx:+.4f} |")
        factor = peer.seconds / own.seconds
        verdicts += [
            (f"calibration, {title} nodes each: {factor:.1f} x faster than OpenCV "
             f"(asked {FASTER:g})", factor >= FASTER),
            (f"calibration, {title} nodes each: residual {own.rms_px:.5f} px, OpenCV's "
             f"{peer.rms_px:.5f} (asked: the same or lower)",
             own.rms_px <= RESIDUAL_MORE * peer.rms_px)]
    return lines, verdicts


def read_grey(path: Path) -> np.ndarray:
    import cv2
    pixels = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if pixels is None:
        raise SystemExit(f"bench: {path}: no picture")
    return pixels


def nodes_off_px(nodes: np.ndarray, truth_file: Path) -> np.ndarray:
    """Distance of nodes from where the picture's truth has them."""
    truth = json.loads(truth_file.read_text())
    lens = Lens(*truth["image"], **truth["camera"])
    at = Pose(np.array(truth["R_bar_camera"]), np.array(truth["t_bar_camera_m"]))
    target_m = (nodes["label"] - 50) * PITCH_M
    px, _ = project(lens, at, np.column_stack([target_m, np.zeros(len(target_m))]))
    return nodes["px"] - px


def extraction(pictures: list[Path], repeats: int) -> tuple[list[str], list[tuple[str, bool]]]:
    from opms import grid
    first = read_grey(pictures[0])
    detector = grid.Detector(first.shape[1], first.shape[0])
    times, off, counts = [], [], []
    for path in pictures:
        pixels = read_grey(path)
        seconds, found = cpu_seconds(lambda: detector.detect(pixels), repeats)
        times.append(1e3 * seconds)
        counts.append(len(found.nodes))
        if path.with_suffix(".json").exists():
            off.append(nodes_off_px(found.nodes, path.with_suffix(".json")))
    median = float(np.median(times))
    rms = float(np.sqrt(np.mean(np.concatenate(off)**2))) if off else np.nan
    lines = ["| node extraction | pictures | nodes, median | ms median | slowest | "
             "RMS off the truth px |", "|---|---|---|---|---|---|",
             f"| libopms | {len(pictures)} | {np.median(counts):.0f} | {median:.2f} | "
             f"{max(times):.2f} | {rms:.4f} |"]
    verdicts = [(f"node extraction: median {median:.2f} ms (asked {NODES_MS:g})",
                 median <= NODES_MS)]
    if off:
        verdicts.append((f"nodes: {rms:.4f} px RMS (asked {NODES_RMS_PX:g})",
                         rms <= NODES_RMS_PX))
    return lines, verdicts


def camera_file(opms: Path, pictures: list[Path], work: Path, repeats: int
                ) -> tuple[list[str], list[tuple[str, bool]]]:
    """The program from its start to the file's rename, reading and decoding included."""
    if not opms.is_file():
        return [f"{opms} is missing"], [(f"{opms} is missing", False)]
    out = work / "bench_camera.yaml"
    command = [str(opms), "calibrate", "--grid", "a0-25", "--footprint", "350,0,0", "--out",
               str(out), *map(str, pictures)]
    least = np.inf
    for _ in range(repeats):
        out.unlink(missing_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(command, capture_output=True, text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode or not out.exists():
            print(f"bench: {' '.join(command)}:\n{done.stderr[-1000:]}", file=sys.stderr)
            return ["opms calibrate failed"], [("opms calibrate failed", False)]
        least = min(least, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    lines = ["| from pictures to camera file | pictures | s |", "|---|---|---|",
             f"| opms calibrate, decoding included | {len(pictures)} | {least:.3f} |"]
    return lines, [(f"{len(pictures)} pictures to camera file: {least:.3f} s (asked {FILE_S:g})",
                    least <= FILE_S)]


def calibration(opms: Path, folder: Path, work: Path, seed: int, quick: bool
                ) -> tuple[str, bool]:
    """The tables with their verdicts as Markdown; are all figures reached?"""
    pictures = sorted(folder.glob("*.png"))[:PICTURES]
    if not pictures:
        raise SystemExit(f"bench: {folder}: no pictures of the grid (*.png)")
    repeats = 3 if quick else 15
    parts = [against_opencv(seed, repeats), extraction(pictures, repeats),
             camera_file(opms, pictures, work, max(3, repeats // 3))]
    verdicts = [v for _, own in parts for v in own]
    said = [f"- {'reached' if good else 'MISSED'}: {text}" for text, good in verdicts]
    text = "\n\n".join([f"Measured on {machine()}."] + ["\n".join(own) for own, _ in parts]
                       + ["\n".join(said)])
    return text, all(good for _, good in verdicts)
