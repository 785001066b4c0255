# SPDX-License-Identifier: Apache-2.0
"""Where the hardware files are, for their tests; and copies of the schematic to break."""
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROJECT = ROOT / "hw/schematics"
DATA = Path(__file__).resolve().parent / "data"
SCHEMATIC = PROJECT / "opms-box.kicad_sch"

sys.path.insert(0, str(PROJECT / "tools"))


def copy_schematic(folder):
    """The sheets in another folder; the root's file."""
    for path in PROJECT.glob("*.kicad_sch"):
        shutil.copy(path, folder)
    return Path(folder) / SCHEMATIC.name
