# SPDX-License-Identifier: Apache-2.0
"""The peers' table: time and accuracy of every detector on the same scenes, on one core."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from bench_geometry import Pose, pose_error
from bench_limit import edge_information, scene_limit
from bench_peers import Peer
from bench_pose import solve_corners, solve_with_shift
from bench_render import KINDS, Light, digitise, render_clean, smooth_ground
from bench_scenes import Scene
from bench_stats import rms
from bench_truth import Truth


@dataclass
class Entry:
    """One detector on one scene."""

    detector: str
    scene: str
    pictures: int = 0
    missing: str = ""
    by_picture: dict[int, list[float]] = field(default_factory=dict)  # times in ms
    errors: list[np.ndarray] = field(default_factory=list)    # detector's (w, d)
    shifted: list[np.ndarray] = field(default_factory=list)   # with the common edge shift
    limits_mm: list[float] = field(default_factory=list)      # of the located pictures

    def add_times(self, picture: int, times_ms: list[float]) -> None:
        self.by_picture.setdefault(picture, []).extend(times_ms)

    @property
    def times_ms(self) -> list[float]:
        return [t for times in self.by_picture.values() for t in times]

    @property
    def worst_picture_ms(self) -> float:
        """Of the slowest picture the median: a call that the system interrupts says nothing."""
        return max((float(np.median(t)) for t in self.by_picture.values()), default=float("nan"))

    @property
    def median_ms(self) -> float:
        return float(np.median(self.times_ms)) if self.times_ms else float("nan")

    @property
    def position_mm(self) -> float:
        return rms([np.linalg.norm(e[3:]) * 1e3 for e in self.errors])

    @property
    def shifted_mm(self) -> float:
        return rms([np.linalg.norm(e[3:]) * 1e3 for e in self.shifted])

    @property
    def position_max_mm(self) -> float:
        return max((np.linalg.norm(e[3:]) * 1e3 for e in self.errors), default=float("nan"))

    @property
    def angle_deg(self) -> float:
        return float(np.degrees(rms([np.linalg.norm(e[:3]) for e in self.errors])))

    @property
    def ratio(self) -> float:
        return self.position_mm / rms(self.limits_mm) if self.limits_mm else float("nan")


def draw(scene: Scene, light: Light, seed: int, kinds=KINDS) -> dict[str, list[np.ndarray]]:
    """Pictures by kind of bar; ground and noise are alike for all kinds."""
    pictures: dict[str, list[np.ndarray]] = {kind: [] for kind in kinds}
    for i, truth in enumerate(scene.truths):
        ground = smooth_ground(truth.lens, np.random.default_rng((seed, i, 0)), light)
        for kind in kinds:
            clean = render_clean(kind, truth.lens, truth.bar_camera, ground, light)
            noise = np.random.default_rng((seed, i, 1))
            pictures[kind].append(digitise(clean, light.noise, noise))
    return pictures


def limits_of(scene: Scene, light: Light) -> list[float]:
    p = light.photometry
    found = [scene_limit(t, edge_information(p.contrast, p.noise, p.blur_px))
             for t in scene.truths]
    return [limit.position_mm if limit else float("nan") for limit in found]


def detector_error(truth: Truth, bar_camera: Pose) -> np.ndarray:
    def place(pose: Pose) -> Pose:
        return truth.ground_bar @ pose @ truth.camera_detector
    return pose_error(place(truth.bar_camera), place(bar_camera))


def measure_peers(peers: list[Peer], scene: Scene, pictures: dict[str, list[np.ndarray]],
                  limits: list[float], with_poses: bool) -> list[Entry]:
    """One round: every peer on a picture before the next, so that what else the machine does
    falls upon all alike."""
    entries = [Entry(p.name, scene.name, len(scene.truths), p.missing) for p in peers]
    present = [(p, e) for p, e in zip(peers, entries) if p.detect is not None]
    cv2.setNumThreads(1)
    for peer, _ in present:
        peer.detect(pictures[peer.kind][0])
    for i, truth in enumerate(scene.truths):
        for peer, entry in present:
            tags, seconds = peer.detect(pictures[peer.kind][i])
            entry.add_times(i, [seconds * 1e3])
            if with_poses:
                add_pose(entry, truth, tags, limits[i])
    return entries


def add_pose(entry: Entry, truth: Truth, tags: dict[int, np.ndarray], limit_mm: float) -> None:
    pose = solve_corners(truth.lens, tags)
    if pose is None:
        return
    entry.errors.append(detector_error(truth, pose))
    entry.shifted.append(detector_error(truth, solve_with_shift(truth.lens, tags, pose)))
    entry.limits_mm.append(limit_mm)


def measure_scene(scene: Scene, peers: list[Peer], program: Path,
                  pictures: dict[str, list[np.ndarray]], limits: list[float], folder: Path,
                  rounds: int) -> list[Entry]:
    """libopms and the peers by turns; errors from the first round, times from all."""
    total: list[Entry] = []
    for number in range(rounds):
        entries = measure_libopms(program, scene, pictures["hope33"], limits, folder, 5,
                                  not peers)
        entries += measure_peers(peers, scene, pictures, limits, number == 0)
        for into, entry in zip(total, entries):
            for picture, times in entry.by_picture.items():
                into.add_times(picture, times)
        total = total or entries
    return total


def run_bench_locate(program: Path, scene: Scene, pictures: list[np.ndarray], folder: Path,
                     repeats: int, follow: bool) -> list[dict]:
    """Rows of bench_locate; raises where it fails."""
    folder.mkdir(parents=True, exist_ok=True)
    lens = scene.truths[0].lens
    numbers = (lens.width, lens.height, lens.fx, lens.fy, lens.cx, lens.cy, lens.k1, lens.k2,
               lens.p1, lens.p2, np.radians(scene.truths[0].tilt_deg))
    lines = [" ".join(repr(n) if isinstance(n, int) else repr(float(n)) for n in numbers)]
    for i, picture in enumerate(pictures):
        path = folder / f"{scene.name}_{i:04d}.raw"
        path.write_bytes(picture.tobytes())
        lines.append(str(path))
    try:
        done = subprocess.run([str(program), str(repeats), str(int(follow))],
                              input="\n".join(lines) + "\n", capture_output=True, text=True,
                              timeout=1800)
    finally:
        for line in lines[1:]:
            Path(line).unlink()
    if done.returncode:
        raise RuntimeError(done.stderr.strip()[-300:] or f"exit {done.returncode}")
    return [json.loads(line) for line in done.stdout.splitlines()]


LIBOPMS_MODES = {"cold": "libopms", "warm": "libopms, same picture again",
                 "follow": "libopms, following"}


def measure_libopms(program: Path, scene: Scene, pictures: list[np.ndarray],
                    limits: list[float], folder: Path, repeats: int,
                    follow: bool) -> list[Entry]:
    try:
        rows = run_bench_locate(program, scene, pictures, folder, repeats, follow)
    except (OSError, RuntimeError) as error:
        return [Entry("libopms", scene.name, len(pictures), str(error))]
    entries = {}
    for row in rows:
        entry = entries.setdefault(
            row["mode"], Entry(LIBOPMS_MODES[row["mode"]], scene.name, len(pictures)))
        entry.add_times(row["picture"], [t / 1e3 for t in row["us"]])
        if "R" in row:
            truth = scene.truths[row["picture"]]
            found = Pose(np.reshape(row["R"], (3, 3)), np.array(row["t"]))
            entry.errors.append(detector_error(truth, found))
            entry.limits_mm.append(limits[row["picture"]])
    return list(entries.values())


def entries_markdown(entries: list[Entry]) -> str:
    lines = ["| detector | located | ms median | p95 | slowest picture | slowest call | "
             "position RMS mm | max | with edge shift | angle RMS deg | ratio to limit |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    for e in entries:
        if e.missing:
            lines.append(f"| {e.detector} | not available: {e.missing[:80]} |" + " |" * 9)
            continue
        p95, most = np.percentile(e.times_ms, 95), max(e.times_ms)
        shifted = f"{e.shifted_mm:.3f}" if e.shifted else "(built in)"
        lines.append(f"| {e.detector} | {len(e.errors)}/{e.pictures} | {e.median_ms:.3f} | "
                     f"{p95:.3f} | {e.worst_picture_ms:.3f} | {most:.3f} | "
                     f"{e.position_mm:.3f} | {e.position_max_mm:.2f} | {shifted} | "
                     f"{e.angle_deg:.4f} | {e.ratio:.2f} |")
    return "\n".join(lines)


def entry_to_json(entry: Entry) -> dict:
    return {"detector": entry.detector, "scene": entry.scene, "pictures": entry.pictures,
            "missing": entry.missing, "located": len(entry.errors), "median_ms": entry.median_ms,
            "p95_ms": float(np.percentile(entry.times_ms, 95)) if entry.times_ms else None,
            "worst_picture_ms": entry.worst_picture_ms,
            "max_ms": max(entry.times_ms, default=None), "position_rms_mm": entry.position_mm,
            "position_max_mm": float(entry.position_max_mm), "shifted_rms_mm": entry.shifted_mm,
            "angle_rms_deg": entry.angle_deg, "ratio_to_limit": entry.ratio}
