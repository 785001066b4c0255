# SPDX-License-Identifier: Apache-2.0
"""Let clang-format break the lines of C and C++ files that are too long, and leave all others.

    wrap_long_lines.py FILE...        (needs clang-format; Debian: clang-format)

Comments are reflowed too, which .clang-format leaves alone otherwise: look at the difference.
"""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from check_files import MAX_COLUMNS  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


def long_lines(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    return [number for number, line in enumerate(lines, 1) if len(line) > MAX_COLUMNS]


def style_file(folder):
    """The tree's style with comments reflowed."""
    text = (ROOT / ".clang-format").read_text(encoding="utf-8")
    path = Path(folder) / "style"
    path.write_text(text.replace("ReflowComments: false", "ReflowComments: true"),
                    encoding="utf-8")
    return path


def wrap(program, style, path):
    ranges = [f"--lines={number}:{number}" for number in long_lines(path)]
    if ranges:
        subprocess.run([program, f"--style=file:{style}", "-i", *ranges, str(path)], check=True)
        print(f"{path}: {len(ranges)} lines")


def main(arguments):
    program = shutil.which("clang-format") or shutil.which("clang-format-14")
    if not program:
        print("clang-format is missing", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        style = style_file(folder)
        for name in arguments:
            wrap(program, style, Path(name))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
