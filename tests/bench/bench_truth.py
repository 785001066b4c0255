# SPDX-License-Identifier: Apache-2.0
"""Pictures with truth: NAME.png, NAME.json and the folder's camera.yaml."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench_geometry import Lens, Pose


@dataclass(frozen=True)
class Photometry:
    """What the limit needs: black to white, noise at the edge, Gaussian blur."""

    contrast: float
    noise: float
    blur_px: float


@dataclass(frozen=True)
class Truth:
    image: Path
    lens: Lens
    bar_camera: Pose
    ground_bar: Pose
    detector_camera: Pose | None
    ground_detector: Pose | None
    tilt_deg: float
    photometry: Photometry | None  # stated by the renderer, else measured from the picture

    @property
    def camera_detector(self) -> Pose:
        if self.detector_camera is None:
            return Pose(np.eye(3), np.zeros(3))
        return self.detector_camera.inverse()


def find_scenes(folder: Path) -> list[Truth]:
    """All pictures of a bar in a folder that have a truth, by name."""
    scenes = []
    for image in sorted(folder.glob("*.png")):
        path = image.with_suffix(".json")
        data = json.loads(path.read_text()) if path.exists() else {}
        if "R_bar_camera" in data and data.get("kind") != "grid":
            scenes.append(parse_truth(image, data))
    return scenes


def parse_truth(image: Path, data: dict) -> Truth:
    camera = data["camera"]
    lens = Lens(*(int(n) for n in data["image"]),
                **{name: float(camera.get(name, 0.0))
                   for name in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")})
    bar_camera = Pose(np.array(data["R_bar_camera"], float),
                      np.array(data["t_bar_camera_m"], float))
    ground_bar = Pose(np.array(data.get("R_ground_bar", np.eye(3)), float), np.zeros(3))
    detector_camera = optional_pose(data, "detector_camera")
    ground_detector = optional_pose(data, "ground_detector")
    if ground_detector is None and detector_camera is not None:
        ground_detector = ground_bar @ bar_camera @ detector_camera.inverse()
    return Truth(image, lens, bar_camera, ground_bar, detector_camera, ground_detector,
                 float(data.get("bar_tilt_deg", 0.0)), stated_photometry(data))


def optional_pose(data: dict, name: str) -> Pose | None:
    if f"R_{name}" not in data or f"t_{name}_m" not in data:
        return None
    return Pose(np.array(data[f"R_{name}"], float), np.array(data[f"t_{name}_m"], float))


def stated_photometry(data: dict) -> Photometry | None:
    """Only a still, uniformly lit, noisy scene is described by three numbers."""
    stated = data.get("render", data)
    try:
        contrast = float(stated["contrast"])
        noise, blur = float(stated["noise"]), float(stated["blur_px"])
    except (KeyError, TypeError, ValueError):
        return None
    return Photometry(contrast, noise, blur) if noise > 0 and blur > 0 else None


def write_camera_yaml(path: Path, lens: Lens, detector_camera: Pose | None) -> None:
    """A camera file (ROS camera_info with the project's own mapping)."""
    def row(values) -> str:
        return "[" + ", ".join(repr(float(v)) for v in np.ravel(values)) + "]"

    projection = np.c_[lens.matrix, np.zeros(3)]
    lines = [f"image_width: {lens.width}", f"image_height: {lens.height}", "camera_name: bench",
             "camera_matrix:", "  rows: 3", "  cols: 3", f"  data: {row(lens.matrix)}",
             "distortion_model: plumb_bob", "distortion_coefficients:", "  rows: 1", "  cols: 5",
             f"  data: {row(lens.distortion)}",
             "rectification_matrix:", "  rows: 3", "  cols: 3", f"  data: {row(np.eye(3))}",
             "projection_matrix:", "  rows: 3", "  cols: 4", f"  data: {row(projection)}"]
    if detector_camera is not None:
        lines += ["opms:", "  version: 1", f"  R_detector_camera: {row(detector_camera.R)}",
                  f"  t_detector_camera_m: {row(detector_camera.t)}"]
    path.write_text("\n".join(lines) + "\n")


def truth_to_json(truth: Truth, extra: dict | None = None) -> dict:
    """The form that find_scenes() reads."""
    lens = truth.lens
    data = {"kind": "bar", "image": [lens.width, lens.height],
            "camera": {n: getattr(lens, n)
                       for n in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")},
            "bar_tilt_deg": truth.tilt_deg, "R_ground_bar": truth.ground_bar.R.tolist(),
            "R_bar_camera": truth.bar_camera.R.tolist(),
            "t_bar_camera_m": truth.bar_camera.t.tolist()}
    for name in ("detector_camera", "ground_detector"):
        pose = getattr(truth, name)
        if pose is not None:
            data[f"R_{name}"], data[f"t_{name}_m"] = pose.R.tolist(), pose.t.tolist()
    return {**data, **(extra or {})}
