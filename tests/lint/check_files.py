# SPDX-License-Identifier: Apache-2.0
"""Check what can be seen of a file without understanding it.

    check_files.py [ROOT]

Names are unique in the tree (a stack trace and grep stay unambiguous), every source states its
licence, nothing is left to be done, lines fit, and files stay short enough to hold one idea.
"""
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path, PurePosixPath

MAY_REPEAT = {"README.md", "CMakeLists.txt", "__init__.py"}
CODE = {".c", ".h", ".cpp", ".hpp", ".py", ".mjs", ".sh", ".cmake", ".map", ".pio"}
NAMED_CODE = {"CMakeLists.txt", "run", ".clang-format"}
# Written so that this file does not find itself.
LEFTOVERS = ["TO" + "DO", "FIX" + "ME", "XX" + "X"]
MAX_LINES = 500
MAX_COLUMNS = 100


def tracked_files(root):
    """Files of the tree: what git knows, or all but the build folder where there is no git."""
    listing = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True)
    if listing.returncode == 0 and listing.stdout:
        names = listing.stdout.decode().split("\0")
        return [PurePosixPath(n) for n in names if n and (root / n).is_file()]
    return [PurePosixPath(p.relative_to(root).as_posix()) for p in sorted(root.rglob("*"))
            if p.is_file() and not {"build", ".git"} & set(p.relative_to(root).parts)]


def is_code(path):
    return path.suffix in CODE or path.name in NAMED_CODE


def repeated_names(files):
    places = defaultdict(list)
    for path in files:
        if path.name not in MAY_REPEAT and is_code(path):
            places[path.name].append(path)
    for name, paths in sorted(places.items()):
        # .ci/run is run's namesake on purpose: it calls nothing else.
        if len(paths) > 1 and name != "run":
            yield f"{paths[1]}: the name is taken by {paths[0]}"


def text_problems(path, text):
    lines = text.splitlines()
    if lines and "SPDX-License-Identifier: Apache-2.0" not in "\n".join(lines[:3]):
        yield f"{path}:1: no SPDX-License-Identifier: Apache-2.0 in the first three lines"
    if len(lines) >= MAX_LINES:
        yield f"{path}: {len(lines)} lines; a file holds one idea (fewer than {MAX_LINES})"
    if text and not text.endswith("\n"):
        yield f"{path}:{len(lines)}: no newline at the end"
    for number, line in enumerate(lines, 1):
        for word in LEFTOVERS:
            if re.search(rf"\b{word}\b", line):
                yield f"{path}:{number}: {word} is left over"
        if len(line) > MAX_COLUMNS:
            yield f"{path}:{number}: {len(line)} columns, more than {MAX_COLUMNS}"
        if line != line.rstrip():
            yield f"{path}:{number}: blanks at the end of the line"
        if "\t" in line:
            yield f"{path}:{number}: a tab; indent by four blanks"


def violations(root):
    files = tracked_files(root)
    yield from repeated_names(files)
    for path in files:
        if is_code(path):
            yield from text_problems(path, (root / path).read_text(encoding="utf-8"))


def main(arguments):
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parents[2]
    found = list(violations(root))
    print("\n".join(found) if found else "files are in order")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
