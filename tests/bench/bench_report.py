# SPDX-License-Identifier: Apache-2.0
"""docs/bench.md and docs/bench.png from the peers' table."""

from __future__ import annotations

import os
import platform
import re
from pathlib import Path

import numpy as np

from bench_scenes import Scene
from bench_table import LIBOPMS_MODES, Entry, entries_markdown

MARKERS = ("<!-- bench: generated from here -->", "<!-- bench: generated up to here -->")
CALIBRATION_MARKERS = ("<!-- bench --calibration: generated from here -->",
                       "<!-- bench --calibration: generated up to here -->")
# what is asked: name in the table's rows, how many times faster libopms shall be
FASTER = {"Napa": 4.0, "ArUco": 40.0, "AprilTag": 100.0}
MEDIAN_MS, WORST_MS, FOLLOW_MS, MOST_RATIO = 0.4, 2.0, 0.15, 1.3


def machine() -> str:
    model = platform.processor() or platform.machine()
    try:
        found = re.search(r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text())
        model = found.group(1) if found else model
    except OSError:
        pass
    return (f"{model}, one of {os.cpu_count()} cores, {platform.system()}, load of the machine "
            f"{os.getloadavg()[0]:.1f}")


def table_markdown(scenes: list[Scene], entries: list[Entry], limits: dict[str, float]) -> str:
    parts = [f"Measured on {machine()}."]
    for scene in scenes:
        own = [e for e in entries if e.scene == scene.name]
        if own:
            parts += [f"**{scene.title}** ({len(scene.truths)} pictures; limit "
                      f"{limits[scene.name]:.3f} mm RMS)", entries_markdown(own)]
    return "\n\n".join(parts)


def verdicts(entries: list[Entry]) -> list[tuple[str, bool]]:
    """Every figure that is asked, and whether it was reached."""
    own = {(e.detector, e.scene): e for e in entries if not e.missing}
    result = []
    for (name, scene), entry in own.items():
        if name == LIBOPMS_MODES["cold"] and scene != "sweep":
            result += own_verdicts(entry) + speed_verdicts(entry, entries)
        if name == LIBOPMS_MODES["follow"]:
            result.append((f"{scene}: following {entry.median_ms:.3f} ms "
                           f"(asked {FOLLOW_MS})", entry.median_ms <= FOLLOW_MS))
    if not any(name.startswith("libopms") for name, _ in own):
        result.append(("libopms not available", False))
    return result


def own_verdicts(entry: Entry) -> list[tuple[str, bool]]:
    worst = entry.worst_picture_ms
    return [
        (f"{entry.scene}: {len(entry.errors)} of {entry.pictures} located",
         len(entry.errors) == entry.pictures),
        (f"{entry.scene}: median {entry.median_ms:.3f} ms (asked {MEDIAN_MS})",
         entry.median_ms <= MEDIAN_MS),
        (f"{entry.scene}: slowest picture {worst:.3f} ms (asked {WORST_MS})", worst <= WORST_MS),
        (f"{entry.scene}: position {entry.ratio:.2f} x the limit (asked {MOST_RATIO})",
         entry.ratio <= MOST_RATIO)]


def speed_verdicts(entry: Entry, entries: list[Entry]) -> list[tuple[str, bool]]:
    """Against the fastest form of each peer that reads at least half of the pictures."""
    result = []
    for word, times in FASTER.items():
        peers = [e for e in entries if word in e.detector and e.scene == entry.scene
                 and not e.missing and 2 * len(e.errors) >= e.pictures]
        full = [e for e in peers if "half size" not in e.detector] or peers
        if full:
            best = min(full, key=lambda e: e.median_ms)
            factor = best.median_ms / entry.median_ms
            result.append((f"{entry.scene}: {factor:.1f} x faster than {best.detector} "
                           f"(asked {times:g})", factor >= times))
    return result


def write_docs(folder: Path, generated: str, markers: tuple[str, str] = MARKERS) -> None:
    """Replaces what stands between the markers of bench.md."""
    path = folder / "bench.md"
    begin, end = markers
    head, rest = path.read_text().split(begin, 1)
    tail = rest.split(end, 1)[1]
    path.write_text(f"{head}{begin}\n\n{generated}\n\n{end}{tail}")


def plot(scenes: list[Scene], entries: list[Entry], limits: dict[str, float], path: Path) -> None:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    shown = [s for s in scenes if s.name != "sweep"]
    figure, axes = plt.subplots(2, len(shown), figsize=(6.4 * len(shown), 6.4), squeeze=False,
                                layout="constrained", sharey="col")
    for column, scene in enumerate(shown):
        own = [e for e in entries if e.scene == scene.name and not e.missing][::-1]
        bars(axes[0, column], own, [e.median_ms for e in own], [f"{e.median_ms:.2f}" for e in own])
        bars(axes[1, column], own, [e.position_mm for e in own],
             [f"{e.position_mm:.2f} ({len(e.errors)}/{e.pictures})" for e in own])
        axes[0, column].set_title(scene.title.replace(", ", ",\n", 1), fontsize=9)
        axes[0, column].set_xlabel("median time of a picture, ms")
        axes[1, column].axvline(limits[scene.name], color="k", lw=1, ls="--", label="limit")
        axes[1, column].legend(fontsize=8, loc="upper right")
        axes[1, column].set_xlabel("position RMS, mm (located pictures)")
    figure.savefig(path, dpi=100)
    plt.close(figure)


def bars(axis, entries: list[Entry], values: list[float], labels: list[str]) -> None:
    """One bar a detector from a common left end, so that lengths compare on the log axis."""
    names = [e.detector for e in entries]
    colours = ["tab:orange" if n.startswith("libopms") else "tab:blue" for n in names]
    drawn = axis.barh(names, np.nan_to_num(values, nan=0.0), color=colours)
    axis.set_xscale("log")
    axis.set_xlim(0.03, 20 * max(np.nanmax(values), 1.0) if values else 1.0)
    axis.bar_label(drawn, labels, padding=2, fontsize=8)
    axis.tick_params(axis="y", labelsize=8)
