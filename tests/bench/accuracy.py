#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Accuracy of `opms locate` on a folder of pictures with truth.

    accuracy.py --opms build/release/bin/opms --data DIR [--json OUT.json] [--plot OUT.png]
                [--targets exact|path-traced|motion]

DIR holds NAME.png, NAME.json (the truth) and camera.yaml. Prints markdown; exit 1 where a figure
misses the chosen targets.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import cv2
import numpy as np

from bench_limit import scene_limit
from bench_locate_cli import Row, compare, run_locate
from bench_photometry import measure
from bench_stats import (chi2_cdf_6, coverage_markdown, row_to_json, rows_markdown,
                         summarise, summary_markdown)
from bench_truth import Truth, find_scenes

# figure -> most that is allowed; located and wrong labels always count.
TARGETS = {
    "exact": {"ratio_position": 1.3},
    "path-traced": {"position_rms_mm": 0.4, "position_max_mm": 2.0, "angle_rms_deg": 0.05},
    "motion": {"position_rms_mm": 0.8, "position_max_mm": 3.0, "angle_rms_deg": 0.1},
}
CHI2_RANGE = (0.6, 1.6)


def evaluate(binary: Path, data: Path, extra: list[str] | None = None,
             prefix: list[str] | None = None) -> list[Row]:
    """All pictures of a folder, located and compared."""
    scenes = find_scenes(data)
    if not scenes:
        raise SystemExit(f"accuracy: no picture with a bar's truth in {data}")
    answers = run_locate(binary, scenes, data / "camera.yaml", extra or [], prefix)
    return [compare(scene, answer, *limit_of(scene)) for scene, answer in zip(scenes, answers)]


def limit_of(scene: Truth):
    image = cv2.imread(str(scene.image), cv2.IMREAD_GRAYSCALE)
    if image is None:
        return None, float("nan")
    measured = measure(scene, image)
    return scene_limit(scene, measured.per_px, measured.visible), measured.saturated


def missed_targets(summary: dict, targets: str | None) -> list[str]:
    missed = []
    if summary["located"] < summary["pictures"]:
        missed.append(f"{summary['pictures'] - summary['located']} pictures not located")
    if summary["wrong_labels"]:
        missed.append(f"{summary['wrong_labels']} wrong labels")
    for figure, most in TARGETS.get(targets or "", {}).items():
        if not summary[figure] <= most:
            missed.append(f"{figure} {summary[figure]:.3f} above {most}")
    if targets == "path-traced" and summary["covariance_camera"]:
        mean = summary["covariance_camera"]["mean_chi2_6_over_6"]
        if not CHI2_RANGE[0] <= mean <= CHI2_RANGE[1]:
            missed.append(f"mean chi2_6/6 {mean:.2f} outside {CHI2_RANGE}")
    return missed


def plot(rows: list[Row], path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    located = [r for r in rows if r.located and r.limit is not None]
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
    limits = [r.limit.position_mm for r in located]
    left.loglog(limits, [r.position_mm for r in located], "o", ms=4, alpha=0.6)
    if limits:
        ends = np.array([min(limits), max(limits)])
        left.loglog(ends, ends, "k-", lw=1, label="limit")
        left.legend()
    left.set(xlabel="limit of the scene, mm", ylabel="error of the detector's position, mm")
    for which in ("camera", "detector"):
        stated = summarise(rows)[f"covariance_{which}"]
        if stated:
            values = np.sort(stated["chi2_6"])
            middle.step(values, (np.arange(len(values)) + 0.5) / len(values), label=which)
    x = np.linspace(0, 25, 200)
    middle.plot(x, chi2_cdf_6(x), "k--", lw=1, label="chi2, 6 degrees of freedom")
    middle.set(xlabel="chi2 of the pose", ylabel="part of the pictures", xlim=(0, 25))
    middle.legend()
    right.hist([r.time_us / 1e3 for r in rows if np.isfinite(r.time_us)], bins=30)
    right.set(xlabel="time of the call, ms", ylabel="pictures")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def report(rows: list[Row], summary: dict, every_row: bool) -> str:
    parts = [summary_markdown(summary),
             coverage_markdown("Covariance of the camera's pose", summary["covariance_camera"]),
             coverage_markdown("Covariance of the detector's pose",
                               summary["covariance_detector"])]
    return "\n\n".join(([rows_markdown(rows)] if every_row else []) + parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--opms", type=Path, default=Path("build/release/bin/opms"))
    parser.add_argument("--data", type=Path, required=True, action="append")
    parser.add_argument("--bar", default="hope33", choices=("hope33", "apriltag33"))
    parser.add_argument("--json", type=Path, help="write the figures and all rows here")
    parser.add_argument("--plot", type=Path, help="write a PNG here")
    parser.add_argument("--no-rows", action="store_true", help="print the summary alone")
    parser.add_argument("--targets", choices=TARGETS, help="exit 1 where these are missed")
    options = parser.parse_args()
    extra = ["--bar", options.bar] if options.bar != "hope33" else []
    rows = [row for data in options.data for row in evaluate(options.opms, data, extra)]
    summary = summarise(rows)
    print(report(rows, summary, not options.no_rows))
    if options.json:
        options.json.write_text(json.dumps({"summary": summary,
                                            "rows": [row_to_json(r) for r in rows]}, indent=1))
    if options.plot:
        plot(rows, options.plot)
    missed = missed_targets(summary, options.targets)
    print(f"\naccuracy: {'FAIL: ' + '; '.join(missed) if missed else 'pass'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
