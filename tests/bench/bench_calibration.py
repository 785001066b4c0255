# SPDX-License-Identifier: Apache-2.0
"""Is the stated covariance true? Many simulated pictures over the whole working volume."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench_limit import edge_information, scene_limit
from bench_locate_cli import Row, compare, run_locate
from bench_render import Light, digitise, render_clean, smooth_ground, write_scene
from bench_scenes import HOPE_DETECTOR_CAMERA, HOPE_LENS, TILT_DEG, hope_truth, random_head
from bench_stats import coverage_markdown, summarise, summary_markdown
from bench_truth import write_camera_yaml

BATCH = 100
INSIDE_RANGE = (0.93, 0.97)
MOST_RATIO = 1.3


def make_batch(folder: Path, numbers: range, light: Light, seed: int) -> list:
    truths = []
    for i in numbers:
        rng = np.random.default_rng((seed, i))
        truth = hope_truth(folder / f"volume_{i:05d}.png", random_head(rng),
                           TILT_DEG if i % 2 else 0.0)
        ground = smooth_ground(truth.lens, rng, light)
        clean = render_clean("hope33", truth.lens, truth.bar_camera, ground, light)
        write_scene(truth, digitise(clean, light.noise, rng), light)
        truths.append(replace(truth, photometry=light.photometry))
    return truths


def volume_rows(binary: Path, work: Path, count: int, light: Light, seed: int) -> list[Row]:
    """Half of the pictures with the bar flat, half tilted; made, located and deleted in batches."""
    folder = work / "volume"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write_camera_yaml(folder / "camera.yaml", HOPE_LENS, HOPE_DETECTOR_CAMERA)
    p = light.photometry
    per_px = edge_information(p.contrast, p.noise, p.blur_px)
    rows = []
    for start in range(0, count, BATCH):
        truths = make_batch(folder, range(start, min(start + BATCH, count)), light, seed)
        answers = run_locate(binary, truths, folder / "camera.yaml", [])
        for truth, answer in zip(truths, answers):
            rows.append(compare(truth, answer, scene_limit(truth, per_px), 0.0))
            truth.image.unlink()
            truth.image.with_suffix(".json").unlink()
        print(f"{len(rows)} of {count} pictures", file=sys.stderr)
    shutil.rmtree(folder)
    return rows


def covariance(binary: Path, work: Path, count: int, light: Light, seed: int) -> bool:
    rows = volume_rows(binary, work, count, light, seed)
    summary = summarise(rows)
    print(summary_markdown(summary))
    for tilt in (0.0, TILT_DEG):
        part = summarise([r for r in rows if r.tilt_deg == tilt])
        print(f"\nbar tilted {tilt:g} degrees: position RMS {part['position_rms_mm']:.4f} mm, "
              f"limit {part['limit_position_rms_mm']:.4f} mm, ratio "
              f"{part['ratio_position']:.2f}; angle ratio {part['ratio_angle']:.2f}")
    for which in ("camera", "detector"):
        print("\n" + coverage_markdown(f"Covariance of the {which}'s pose",
                                       summary[f"covariance_{which}"]))
    bad = outside(summary)
    (work / "covariance.json").write_text(json.dumps(summary, indent=1))
    print(f"\ncovariance: {'FAIL: ' + '; '.join(bad) if bad else 'pass'} "
          f"({count} pictures, seed {seed})")
    return not bad


def outside(summary: dict) -> list[str]:
    bad = []
    if summary["located"] < summary["pictures"]:
        bad.append(f"{summary['pictures'] - summary['located']} pictures not located")
    if summary["wrong_labels"]:
        bad.append(f"{summary['wrong_labels']} wrong labels")
    if not summary["ratio_position"] <= MOST_RATIO:
        bad.append(f"position {summary['ratio_position']:.2f} x the limit")
    for which in ("camera", "detector"):
        stated = summary[f"covariance_{which}"]
        if stated is None:
            bad.append(f"no covariance of the {which}'s pose")
            continue
        for i, quartile in enumerate(stated["quartiles"], 1):
            for figure in ("position_inside", "pose_inside"):
                if not INSIDE_RANGE[0] <= quartile[figure] <= INSIDE_RANGE[1]:
                    bad.append(f"{which} {figure} {100 * quartile[figure]:.1f} % in quartile {i}")
    return bad
