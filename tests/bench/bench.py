#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speed and accuracy of libopms, against other markers and against the limit.

Without a choice: time and accuracy of libopms, AprilTag 3, Napa and OpenCV ArUco on the same
simulated scenes, on one core. Exit 1 where a figure that is asked for is missed.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

import numpy as np

import accuracy
from bench_build import ROOT, build_program, install_napa
from bench_calib_peers import calibration
from bench_calib_progress import progress
from bench_calibration import covariance, volume_rows
from bench_live import live
from bench_peers import all_peers
from bench_render import KINDS, Light
from bench_report import CALIBRATION_MARKERS, plot, table_markdown, verdicts, write_docs
from bench_rotations import directions, rotations
from bench_scenes import make_scenes, sweep
from bench_stats import summarise
from bench_table import draw, entry_to_json, limits_of, measure_scene
from bench_traced import prepare_mitsuba, traced_folders

EXAMPLES = [ROOT / "tests" / "data" / "bar", ROOT / "tests" / "data" / "bar-motion"]
SWEEP_STEP_M = 0.010  # 0.6 m/s at 60 pictures a second


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="./run bench", description=__doc__.splitlines()[0])
    choice = parser.add_argument_group("what to do (default: the table of the peers)")
    choice.add_argument("--accuracy", action="store_true",
                        help="pictures with truth: --data, else the examples and a volume")
    choice.add_argument("--data", type=Path, action="append", metavar="DIR",
                        help="folder of PNG + truth JSON + camera.yaml; implies --accuracy")
    choice.add_argument("--covariance", action="store_true",
                        help="stated covariance on 2,000 simulated pictures")
    choice.add_argument("--rotations", action="store_true",
                        help="pictures of --data turned by 30 degrees at a time")
    choice.add_argument("--directions", action="store_true",
                        help="simulated bars every 5 degrees, all sizes")
    choice.add_argument("--traced", action="store_true",
                        help="accuracy on path-traced pictures, made anew from --seed: grass, "
                             "shade, saturated white, another camera, motion")
    choice.add_argument("--calibration", action="store_true",
                        help="calibration beside OpenCV's, node extraction, pictures to camera "
                             "file; --data: pictures of the grid")
    choice.add_argument("--progress", action="store_true",
                        help="time of one more picture in a calibration of 12 and of 60")
    choice.add_argument("--live", action="store_true",
                        help="latency, processor time and memory of the live system")
    parser.add_argument("--firmware", type=Path, metavar="FILE",
                        help="firmware for the emulated box of --live (default: that of ./run)")
    parser.add_argument("--quick", action="store_true", help="few pictures, to see that it works")
    parser.add_argument("--count", type=int, help="number of simulated pictures")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--no-napa", action="store_true",
                        help="leave Napa out (PolyForm Noncommercial licence)")
    parser.add_argument("--write-docs", action="store_true",
                        help="put table and plot into docs/bench.md and docs/bench.png")
    parser.add_argument("--build", type=Path, default=ROOT / "build/release", metavar="DIR",
                        help="release build to measure")
    parser.add_argument("--opms", type=Path, help="another opms program than the build's")
    parser.add_argument("--work", type=Path, default=ROOT / "build/bench")
    options = parser.parse_args()
    options.opms = options.opms or options.build / "bin" / "opms"
    return options


def peers_table(options: argparse.Namespace, light: Light) -> bool:
    """The default: all detectors, both scenes, and the sweep for following."""
    count = options.count or (8 if options.quick else 60)
    rounds = 1 if options.quick else 3
    program = (build_program("bench_locate", options.build, options.work)
               or Path("bench_locate"))
    if not options.no_napa:
        install_napa()
    peers = all_peers(not options.no_napa)
    scenes = make_scenes(options.work, count, options.seed)
    swing = sweep(options.work, count, SWEEP_STEP_M)
    entries, limits = [], {}
    for scene in [*scenes, swing]:
        print(f"bench: {scene.title}", file=sys.stderr)
        rivals = [] if scene is swing else peers
        pictures = draw(scene, light, options.seed, KINDS if rivals else ("hope33",))
        scene_limits = limits_of(scene, light)
        limits[scene.name] = float(np.sqrt(np.mean(np.square(scene_limits))))
        entries += measure_scene(scene, rivals, program, pictures, scene_limits, options.work,
                                 rounds)
    return report_table(options, [*scenes, swing], entries, limits)


def report_table(options: argparse.Namespace, scenes, entries, limits) -> bool:
    table = table_markdown(scenes, entries, limits)
    results = verdicts(entries)
    lines = "\n".join(f"- {'reached' if good else 'MISSED'}: {text}" for text, good in results)
    print(f"{table}\n\n{lines}")
    (options.work / "bench.json").write_text(json.dumps(
        {"limits_mm": limits, "entries": [entry_to_json(e) for e in entries]}, indent=1))
    plot(scenes, entries, limits, options.work / "bench.png")
    if options.write_docs:
        write_docs(ROOT / "docs", f"{table}\n\n{lines}\n\n![time and accuracy](bench.png)")
        plot(scenes, entries, limits, ROOT / "docs" / "bench.png")
    missed = sum(not good for _, good in results)
    print(f"\nbench: {'pass' if not missed else 'FAIL'}: {len(results) - missed} of "
          f"{len(results)} figures reached")
    return not missed


def calibration_rows(options: argparse.Namespace) -> bool:
    folder = options.data[0] if options.data else ROOT / "tests" / "data" / "grid"
    table, good = calibration(options.opms, folder, options.work, options.seed, options.quick)
    print(table)
    if options.write_docs:
        write_docs(ROOT / "docs", table, CALIBRATION_MARKERS)
    print(f"\ncalibration: {'pass' if good else 'FAIL'}")
    return good


def accuracy_rows(options: argparse.Namespace, light: Light) -> bool:
    good = True
    for folder in options.data or [d for d in EXAMPLES if d.is_dir()]:
        rows = accuracy.evaluate(options.opms, folder)
        print(f"## {folder.name}\n")
        good &= conclude(rows, targets_of(folder), True, options.work / f"{folder.name}.png")
    if not options.data:
        count = options.count or (20 if options.quick else 200)
        print(f"## {count} simulated pictures over the whole volume, noise {light.noise:g}\n")
        rows = volume_rows(options.opms, options.work, count, light, options.seed)
        good &= conclude(rows, "exact", False, options.work / "volume.png")
    return good


def traced_rows(options: argparse.Namespace, light: Light) -> bool:
    missing = prepare_mitsuba()
    if missing:
        print(f"bench: {missing}", file=sys.stderr)
        return False
    count = options.count or (2 if options.quick else 24)
    options.data = list(traced_folders(options.work, count, options.seed))
    return accuracy_rows(options, light)


def targets_of(folder: Path) -> str:
    return "motion" if "motion" in folder.name else "path-traced"


def conclude(rows, targets: str, every_row: bool, picture: Path) -> bool:
    summary = summarise(rows)
    print(accuracy.report(rows, summary, every_row))
    accuracy.plot(rows, picture)
    missed = accuracy.missed_targets(summary, targets)
    print(f"\naccuracy ({targets}): {'FAIL: ' + '; '.join(missed) if missed else 'pass'}\n")
    return not missed


def main() -> int:
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    light = Light()
    if options.live:  # with all cores
        return 0 if live(options.quick, options.work, options.firmware) else 1
    if options.traced:
        return 0 if traced_rows(options, light) else 1
    # One core for this process and all that it starts, peers and libopms alike.
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    good, chosen = True, False
    if options.rotations:
        chosen = True
        good &= rotations(options.opms, options.data or [d for d in EXAMPLES if d.is_dir()],
                          options.work)
    if options.directions:
        chosen = True
        good &= directions(options.opms, options.work, 30 if options.quick else 5, light,
                           options.seed)
    if options.calibration:
        chosen = True
        good &= calibration_rows(options)
    if options.progress:
        chosen = True
        good &= progress(options.build, options.work)
    if options.covariance:
        chosen = True
        count = options.count or (100 if options.quick else 2000)
        good &= covariance(options.opms, options.work, count, light, options.seed)
    if options.accuracy or options.data and not (options.rotations or options.calibration):
        chosen = True
        good &= accuracy_rows(options, light)
    if not chosen:
        good = peers_table(options, light)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
