# SPDX-License-Identifier: Apache-2.0
"""How long one more picture takes in a calibration that grows."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from bench_build import build_program

MOST_US = 20_000


def progress(build: Path, work: Path) -> bool:
    """Prints the times; false where one is over 20 ms or the program cannot be built."""
    program = build_program("bench_calib_progress", build, work)
    if program is None:
        return False
    row = json.loads(subprocess.run([program], check=True, capture_output=True, text=True).stdout)
    print(f"| one more picture of {row['nodes']} nodes, add and solve | median |\n|---|---|")
    for title, figure in (("the 12th", "picture_12_us"),
                          ("the 60th, the best dozen in use", "dozen_of_60_us"),
                          ("the 60th, all in use", "picture_60_us"),
                          ("foreseeing what it would do", "foresee_us")):
        print(f"| {title} | {row[figure] / 1e3:.2f} ms |")
    good = all(row[figure] < MOST_US
               for figure in ("picture_12_us", "dozen_of_60_us", "picture_60_us"))
    print(f"\nprogress: {'pass' if good else 'FAIL'}: each under {MOST_US // 1000} ms")
    return good
