# SPDX-License-Identifier: Apache-2.0
"""Every direction: real pictures turned by 30 degrees at a time, simulated ones by 5."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from bench_geometry import Pose, inside, project, rotate_lens, rotation_2d, square_corners
from bench_limit import scene_limit
from bench_locate_cli import Row, compare, run_locate
from bench_photometry import measure
from bench_render import Light, digitise, render_clean, smooth_ground, write_scene
from bench_scenes import HOPE_LENS, axis_rotation
from bench_truth import Truth, find_scenes, truth_to_json, write_camera_yaml

ROTATIONS_DEG = range(0, 360, 30)
MOST_MOVED_MM = 0.3
# distance of the camera from the bar, angle off the bar's normal: squares of 58 px to 20 x 8 px
VIEWS = ((0.20, 10.0), (0.30, 25.0), (0.40, 40.0), (0.50, 55.0), (0.55, 67.0), (0.80, 25.0))
SEEN_WHOLE_PX = 4.0


def rotated(truth: Truth, image: np.ndarray, angle_deg: float,
            target: Path) -> tuple[Truth, np.ndarray]:
    """The picture turned about its middle on a canvas that holds all of it, with its truth."""
    height, width = image.shape
    A = rotation_2d(np.radians(angle_deg))
    A[np.abs(A) < 1e-12] = 0.0
    extent = np.abs(A) @ (width, height)
    size = tuple(int(v) for v in np.ceil(extent - 1e-9))
    centre = np.array([width - 1, height - 1]) / 2
    new_centre = (np.array(size) - 1) / 2
    turned = resample(image, A, centre, new_centre, size)
    turn = np.eye(3)
    turn[:2, :2] = A
    lens = rotate_lens(truth.lens, np.radians(angle_deg), centre, new_centre, size)
    detector = truth.detector_camera
    return replace(truth, image=target, lens=lens,
                   bar_camera=Pose(truth.bar_camera.R @ turn.T, truth.bar_camera.t),
                   detector_camera=detector and Pose(detector.R @ turn.T, detector.t)), turned


def resample(image: np.ndarray, A: np.ndarray, centre: np.ndarray, new_centre: np.ndarray,
             size: tuple[int, int]) -> np.ndarray:
    """Cubic (Catmull-Rom) with exact weights: OpenCV rounds places to 1/32 px, which would show."""
    u, v = np.meshgrid(np.arange(size[0]) - new_centre[0], np.arange(size[1]) - new_centre[1])
    x = np.round(A[0, 0] * u + A[1, 0] * v + centre[0], 9)
    y = np.round(A[0, 1] * u + A[1, 1] * v + centre[1], 9)
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    fill = float(np.median(image))
    padded = np.pad(image.astype(np.float32), 3, mode="edge")
    result = np.zeros(x.shape, np.float32)
    weights_x, weights_y = cubic_weights(x - i), cubic_weights(y - j)
    inside_ = (x > -0.5) & (x < image.shape[1] - 0.5) & (y > -0.5) & (y < image.shape[0] - 0.5)
    i = np.clip(i, -1, image.shape[1] - 1) + 3
    j = np.clip(j, -1, image.shape[0] - 1) + 3
    for b in range(4):
        row = sum(weights_x[a] * padded[j + b - 1, i + a - 1] for a in range(4))
        result += (weights_y[b] * row).astype(np.float32)
    return np.clip(np.rint(np.where(inside_, result, fill)), 0, 255).astype(np.uint8)


def cubic_weights(f: np.ndarray) -> list[np.ndarray]:
    return [((-0.5 * f + 1) * f - 0.5) * f, (1.5 * f - 2.5) * f * f + 1,
            ((-1.5 * f + 2) * f + 0.5) * f, (0.5 * f - 0.5) * f * f]


def whole_squares(truth: Truth) -> set[int]:
    px, seen = project(truth.lens, truth.bar_camera, square_corners())
    return set(np.nonzero((inside(truth.lens, px, SEEN_WHOLE_PX) & seen).all(1))[0].tolist())


def locate_one(binary: Path, truth: Truth, camera: Path) -> tuple[Row, set[int]]:
    answer = run_locate(binary, [truth], camera, [])[0]
    return (compare(truth, answer, None, float("nan")),
            {int(s["index"]) for s in answer.get("squares", [])})


def rotations(binary: Path, folders: list[Path], work: Path) -> bool:
    """Same squares, same labels, same position within MOST_MOVED_MM; prints a table."""
    print("| picture | located | wrong labels | squares lost, gained | moved most, mm | "
          "by 90, 180, 270 degrees |")
    print("|---|---|---|---|---|---|")
    failures, worst, pictures = [], 0.0, 0
    for truth in (t for folder in folders for t in find_scenes(folder)):
        line = rotate_picture(binary, truth, work)
        pictures += len(ROTATIONS_DEG)
        worst = max(worst, line["moved"])
        good = (line["located"] == len(ROTATIONS_DEG) and not line["wrong"] and not line["lost"]
                and not line["gained"] and line["moved"] <= MOST_MOVED_MM)
        if not good:
            failures.append(truth.image.name)
        print(f"| {truth.image.name} | {line['located']}/{len(ROTATIONS_DEG)} | {line['wrong']} | "
              f"{line['lost']}, {line['gained']} | {line['moved']:.3f} | {line['exact']:.3f} |",
              flush=True)
    print(f"\nrotations: {'FAIL' if failures else 'pass'}: {pictures} pictures, moved at most "
          f"{worst:.3f} mm (allowed {MOST_MOVED_MM}); failing: {', '.join(failures) or 'none'}")
    return not failures


def rotate_picture(binary: Path, truth: Truth, work: Path) -> dict:
    """What became of a picture's rotations. Those by quarter turns are exact, pixel for pixel; the
    others are resampled, which is a new picture. Pictures that were not located or have wrong
    labels stay in the folder, with their truth."""
    image = cv2.imread(str(truth.image), cv2.IMREAD_GRAYSCALE)
    whole = whole_squares(truth)
    line = {"located": 0, "wrong": 0, "lost": 0, "gained": 0, "moved": 0.0, "exact": 0.0}
    reference = None
    for angle in ROTATIONS_DEG:
        row, squares = locate_rotated(binary, truth, image, angle, work)
        line["wrong"] += row.wrong_labels
        if not row.located:
            print(f"{row.image}: {row.state} {row.reason}", file=sys.stderr)
            continue
        line["located"] += 1
        if reference is None:
            reference = (row, squares & whole)
            continue
        line["lost"] += len(reference[1] - squares)
        line["gained"] += len((squares & whole) - reference[1])
        moved = row.detector_error[3:] - reference[0].detector_error[3:]
        for name in ("moved", "exact") if angle % 90 == 0 else ("moved",):
            line[name] = max(line[name], float(np.linalg.norm(moved)) * 1e3)
    return line


def locate_rotated(binary: Path, truth: Truth, image: np.ndarray, angle: int,
                   work: Path) -> tuple[Row, set[int]]:
    folder = work / "rotations" / f"{truth.image.stem}_{angle:03d}"
    folder.mkdir(parents=True, exist_ok=True)
    turned, picture = rotated(truth, image, angle, folder / f"{folder.name}.png")
    cv2.imwrite(str(turned.image), picture)
    turned.image.with_suffix(".json").write_text(json.dumps(truth_to_json(turned), indent=1))
    write_camera_yaml(folder / "camera.yaml", turned.lens, turned.detector_camera)
    row, squares = locate_one(binary, turned, folder / "camera.yaml")
    if row.located and not row.wrong_labels:
        shutil.rmtree(folder)
    return row, squares


def view_truth(image: Path, distance: float, oblique_deg: float, roll_deg: float,
               y_m: float) -> Truth:
    """The camera looks at (0, y, 0) from the side, turned about its own axis."""
    angle = np.radians(oblique_deg)
    z = -np.array([np.sin(angle), 0, np.cos(angle)])
    x = np.array([-np.cos(angle), 0, np.sin(angle)])
    R = np.stack([x, np.cross(z, x), z], 1) @ axis_rotation(2, np.radians(roll_deg))
    position = np.array([0, y_m, 0]) - distance * z
    return Truth(image, HOPE_LENS, Pose(R, position), Pose(np.eye(3), np.zeros(3)), None, None,
                 0.0, None)


def directions(binary: Path, work: Path, step_deg: int, light: Light, seed: int) -> bool:
    """Bars in every direction and of every size: none missed, none wrong."""
    folder = work / "directions"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_camera_yaml(folder / "camera.yaml", HOPE_LENS, None)
    print("| view | pictures | located | wrong labels | squares read | position RMS mm | ratio |")
    print("|---|---|---|---|---|---|---|")
    good = True
    for number, (distance, oblique) in enumerate(VIEWS):
        rows = directions_of_view(binary, folder, (number, distance, oblique), step_deg, light,
                                  seed)
        good &= print_view(distance, oblique, rows)
    shutil.rmtree(folder)
    print(f"\ndirections: {'pass' if good else 'FAIL'}: every {step_deg} degrees, "
          f"{len(VIEWS)} views")
    return good


def directions_of_view(binary: Path, folder: Path, view: tuple[int, float, float],
                       step_deg: int, light: Light, seed: int) -> list[Row]:
    number, distance, oblique = view
    truths = []
    for roll in range(0, 360, step_deg):
        rng = np.random.default_rng((seed, number, roll))
        truth = view_truth(folder / f"view{number}_{roll:03d}.png", distance, oblique, roll,
                           rng.uniform(-0.3, 0.3))
        ground = smooth_ground(truth.lens, rng, light)
        clean = render_clean("hope33", truth.lens, truth.bar_camera, ground, light)
        write_scene(truth, digitise(clean, light.noise, rng), light)
        truths.append(replace(truth, photometry=light.photometry))
    answers = run_locate(binary, truths, folder / "camera.yaml", [])
    rows = []
    for truth, answer in zip(truths, answers):
        measured = measure(truth, np.empty((0, 0)))
        rows.append(compare(truth, answer, scene_limit(truth, measured.per_px), 0.0))
        if not rows[-1].located or rows[-1].wrong_labels:
            print(f"{truth.image.name}: {rows[-1].state} {rows[-1].reason}, "
                  f"{rows[-1].wrong_labels} wrong labels", file=sys.stderr)
        truth.image.unlink()
        truth.image.with_suffix(".json").unlink()
    return rows


def print_view(distance: float, oblique: float, rows: list[Row]) -> bool:
    located = [r for r in rows if r.located]
    wrong = sum(r.wrong_labels for r in rows)
    read = sum(r.squares for r in rows) / max(sum(r.visible_squares for r in rows), 1)
    error = np.sqrt(np.mean([r.position_mm**2 for r in located])) if located else float("nan")
    bounded = [r.limit.position_mm for r in located if r.limit]
    limit = np.sqrt(np.mean(np.square(bounded))) if bounded else float("nan")
    side = HOPE_LENS.fx * 0.02 / distance
    print(f"| {side:.0f} x {side * np.cos(np.radians(oblique)):.0f} px, {oblique:g} deg off "
          f"| {len(rows)} | {len(located)} | {wrong} | {read:.3f} | {error:.3f} | "
          f"{error / limit:.2f} |", flush=True)
    return len(located) == len(rows) and not wrong
