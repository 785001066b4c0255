# SPDX-License-Identifier: Apache-2.0
"""Check a built libopms.so from outside.

    check_library.py --library LIB.so --headers DIR --symbols FILE [--max-kib N] [--update]

What it exports is the checked list, which is what the public headers declare; it needs no library
but the C and C++ run time; stripped it stays small. --update writes the list anew.
"""
import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

RUN_TIME = re.compile(r"(libc|libm|libstdc\+\+|libgcc_s|ld-linux[\w-]*)\.so\.\d+$")
DECLARATION = re.compile(r"^OPMS_API\b[^;]*?\b(opms_\w+)\(", re.MULTILINE | re.DOTALL)


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def exported(library):
    """Names of the functions and data that the library defines for others."""
    lines = output("nm", "--dynamic", "--defined-only", "--without-symbol-versions", library)
    return {name for _, kind, name in map(str.split, lines.splitlines()) if kind != "A"}


def declared(headers):
    """Names that the public headers mark with OPMS_API."""
    return {name for header in Path(headers).glob("*.h")
            for name in DECLARATION.findall(header.read_text(encoding="utf-8"))}


def needed(library):
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", library)))


def stripped_kib(library):
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "stripped.so"
        shutil.copyfile(library, copy)
        subprocess.run(["strip", str(copy)], check=True)
        return copy.stat().st_size / 1024


def difference(left, right, what):
    """Complaints about two sets that should be one."""
    for name in sorted(left - right):
        yield f"{name}: {what[0]}"
    for name in sorted(right - left):
        yield f"{name}: {what[1]}"


def violations(library, headers, listed, max_kib):
    names = exported(library)
    yield from difference(names, listed, ("exported, but not in the list",
                                          "in the list, but not exported"))
    yield from difference(names, declared(headers), ("exported, but in no public header",
                                                     "declared, but not exported"))
    for name in sorted(needed(library)):
        if not RUN_TIME.match(name):
            yield f"{name}: needed, but no part of the C and C++ run time"
    size = stripped_kib(library)
    if size >= max_kib:
        yield f"{size:.0f} KiB stripped, not under {max_kib} KiB"


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--library", required=True)
    parser.add_argument("--headers", required=True)
    parser.add_argument("--symbols", required=True, type=Path)
    parser.add_argument("--max-kib", type=float, default=400)
    parser.add_argument("--update", action="store_true")
    options = parser.parse_args(arguments)
    if options.update:
        names = sorted(exported(options.library))
        options.symbols.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
    listed = set(options.symbols.read_text(encoding="utf-8").split())
    found = list(violations(options.library, options.headers, listed, options.max_kib))
    for line in found:
        print(line)
    print(f"{len(listed)} symbols, needs {' '.join(sorted(needed(options.library)))}, "
          f"{stripped_kib(options.library):.0f} KiB stripped")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
