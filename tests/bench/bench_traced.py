# SPDX-License-Identifier: Apache-2.0
"""Path-traced pictures: what a camera sees of the bar between grass, in sun and shade, as often as
one likes and by a renderer that nobody here wrote (Mitsuba 3).

The pictures have the form of all pictures with truth, and stay: another program may try them.
"""

from __future__ import annotations

import ctypes
import importlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from bench_geometry import Lens, Pose, inside, project, square_corners
from bench_scenes import (HOPE_DETECTOR_CAMERA, HOPE_LENS, TILT_DEG, axis_rotation, random_head)
from bench_truth import Truth, truth_to_json, write_camera_yaml

HERE = Path(__file__).resolve().parent
LLVM = "libLLVM.so.19.1"  # of Debian 12 and 13; 15 and 16 fail on processors with AVX-512
SAMPLES, SAMPLES_AT_ONCE = 64, 16  # a pixel
SQUARES_LEAST = 8
SPEED_M_S, SHUTTER_S = 0.6, (0.008, 0.012)
HEAD_TILT_RAD = np.radians(6)
HEAD_ABOVE_M = 0.02  # the ground of the bar lies below its face
FULL_SCALE = 255.0


@dataclass(frozen=True)
class Rig:
    """A camera and how it sits on the detector."""

    lens: Lens
    detector_camera: Pose


HOPE_RIG = Rig(HOPE_LENS, HOPE_DETECTOR_CAMERA)


def prepare_mitsuba() -> str | None:
    """Installs Mitsuba into this Python's environment, and loads it. What is missing, else None."""
    if not importlib.util.find_spec("mitsuba"):
        if sys.prefix == sys.base_prefix:
            return "Mitsuba is not installed (pip install mitsuba)"
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet",
                        "--disable-pip-version-check", "-r",
                        str(HERE / "requirements-traced.txt")], check=False)
        importlib.invalidate_caches()
    try:
        ctypes.CDLL(LLVM)
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", LLVM)
    except OSError:
        pass  # Mitsuba then looks for one itself
    try:
        import mitsuba
        mitsuba.set_variant("llvm_ad_mono")
    except ImportError as error:
        return f"Mitsuba cannot be used, is {LLVM} installed? {error}"
    return None


def another_rig(rng: np.random.Generator) -> Rig:
    """A camera of another size and lens, mounted nearly as the HOPE camera but turned."""
    f = rng.uniform(500, 850)
    lens = Lens(1280, 960, f, f * rng.uniform(0.995, 1.005), *rng.uniform((600, 450), (680, 510)),
                *rng.uniform((-0.2, 0.02, -0.0015, -0.0015), (-0.05, 0.06, 0.0015, 0.0015)))
    mount = HOPE_DETECTOR_CAMERA
    R = (mount.R @ axis_rotation(1, rng.uniform(-0.08, 0.08))
         @ axis_rotation(2, rng.uniform(-np.pi, np.pi)))
    return Rig(lens, Pose(R, mount.t + rng.uniform(-0.03, 0.03, 3)))


def random_truth(image: Path, rig: Rig, rng: np.random.Generator) -> Truth:
    """Anywhere in the working volume where enough of the bar is in view."""
    tilt_deg = float(rng.choice([0.0, TILT_DEG]))
    ground_bar = Pose(axis_rotation(1, -np.radians(tilt_deg)), np.zeros(3))
    while True:
        head = random_head(rng, HEAD_TILT_RAD)
        head = Pose(head.R, head.t + [0, 0, HEAD_ABOVE_M])
        bar_camera = ground_bar.inverse() @ head @ rig.detector_camera
        px, seen = project(rig.lens, bar_camera, square_corners())
        if (inside(rig.lens, px, 2) & seen).all(1).sum() >= SQUARES_LEAST:
            return Truth(image, rig.lens, bar_camera, ground_bar, rig.detector_camera, head,
                         tilt_deg, None)


def random_movement(rng: np.random.Generator) -> np.ndarray:
    """Way in the ground's plane while the shutter is open, m."""
    heading = rng.uniform(0, 2 * np.pi)
    way = SPEED_M_S * rng.uniform(*SHUTTER_S)
    return way * np.array([np.cos(heading), np.sin(heading), 0])


def radiance(truth: Truth, movement_m: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The picture in parts of the bar's white, with the blur of a lens."""
    import mitsuba as mi

    from traced_lens import lens_sensor
    from traced_scene import field
    things, white = field(rng, truth.ground_bar, truth.ground_detector,
                          np.radians(truth.tilt_deg))
    camera = lens_sensor(truth.lens, truth.ground_bar @ truth.bar_camera, movement_m,
                         float(rng.uniform(0.4, 0.8)))
    scene = mi.load_dict({"type": "scene", "integrator": {"type": "path", "max_depth": 4},
                          "camera": camera, **things})
    seed = int(rng.integers(1 << 30))
    parts = [np.array(mi.render(scene, spp=SAMPLES_AT_ONCE, seed=seed + i))[:, :, 0]
             for i in range(SAMPLES // SAMPLES_AT_ONCE)]
    return np.mean(parts, 0) / white


def exposed(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Grey levels with shot and read noise. Half of the pictures are exposed too long: white then
    is up to three times as light as the sensor can tell."""
    white = rng.uniform(0.5, 0.95) if rng.uniform() < 0.5 else rng.uniform(1.0, 3.0)
    grey = FULL_SCALE * white * picture
    read, shot = rng.uniform(0.5, 2.5), rng.uniform(0.015, 0.09)
    grey = grey + rng.standard_normal(grey.shape) * np.sqrt(read**2 + shot * grey)
    return np.clip(np.rint(grey), 0, FULL_SCALE).astype(np.uint8)


def trace(folder: Path, rig: Rig, count: int, moving: bool, seed: int) -> None:
    """A folder of pictures with truth, in place of what it held."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_camera_yaml(folder / "camera.yaml", rig.lens, rig.detector_camera)
    for i in range(count):
        rng = np.random.default_rng((seed, i))
        truth = random_truth(folder / f"{folder.name}_{i:04d}.png", rig, rng)
        movement_m = random_movement(rng) if moving else np.zeros(3)
        cv2.imwrite(str(truth.image), exposed(radiance(truth, movement_m, rng), rng))
        extra = {"movement_m": movement_m.tolist(), "seed": [seed, i]}
        truth.image.with_suffix(".json").write_text(
            json.dumps(truth_to_json(truth, extra), indent=1))
        print(f"bench: {folder.name}: {i + 1} of {count} pictures", file=sys.stderr)


def traced_folders(work: Path, count: int, seed: int) -> Iterator[Path]:
    """Still and moving pictures of the HOPE camera, and still ones of another, by the seed."""
    another = another_rig(np.random.default_rng(seed))
    for name, rig, moving in (("traced-hope", HOPE_RIG, False), ("traced-other", another, False),
                              ("traced-motion", HOPE_RIG, True)):
        trace(work / name, rig, count, moving, seed)
        yield work / name
