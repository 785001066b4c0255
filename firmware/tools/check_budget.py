#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Print what the firmware takes of flash, RAM and stack, and fail past the budget.

    check_budget.py FIRMWARE.elf FIRMWARE.map [--objdump OBJDUMP] [--nm NM]

Flash and RAM are counted by object file from the linker's map: the budget is for our own code,
beyond the SDK and TinyUSB. The stack is worked out by stack_depth.py. There must be no heap.
"""
import argparse
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import stack_depth

FLASH_LIMIT = 32 * 1024  # of our own code and constants
RAM_LIMIT = 200 * 1024   # of our own data; the log of pulses and the rings take 160 KiB
STACK_LIMIT = 2048       # PICO_STACK_SIZE
HEAP = {"malloc", "_malloc_r", "calloc", "_calloc_r", "realloc", "_realloc_r", "free", "_free_r",
        "_sbrk", "_sbrk_r", "__wrap_malloc", "__wrap_calloc"}
OWN = re.compile(r"opms-box\.dir/(?:.*/)?(core|hal|app|libopms/src/wire)/[^/]+\.o(?:bj)?$")
FLASH, RAM = range(0x10000000, 0x11000000), range(0x20000000, 0x20042000)
SECTION = re.compile(r"^ (?P<name>[.\w$*]+)?\s+0x(?P<at>[0-9a-f]+)\s+0x(?P<size>[0-9a-f]+)"
                     r"\s+(?P<file>\S.*)$")


def sizes_by_object(map_text):
    """{(memory, object file): bytes} of what the linker placed."""
    sizes = Counter()
    placed = map_text.split("Linker script and memory map", 1)[1]
    # A long name stands on a line of its own.
    for line in re.sub(r"^( [.\w$]+)\n", r"\1", placed, flags=re.M).splitlines():
        match = SECTION.match(line)
        if not match or match["file"].startswith("load address"):
            continue
        at, size = int(match["at"], 16), int(match["size"], 16)
        memory = "flash" if at in FLASH else "ram" if at in RAM else None
        if memory:
            sizes[memory, match["file"]] += size
            # Initialised data lies in flash, too.
            if memory == "ram" and not re.match(r"\.(bss|uninitialized|stack|heap)",
                                                match["name"] or ".bss"):
                sizes["flash", match["file"]] += size
    return sizes


def own_part(sizes, memory):
    parts = Counter()
    for (kind, file), size in sizes.items():
        match = OWN.search(file)
        if kind == memory and match:
            parts[match[1].rsplit("/", 1)[-1]] += size
    return parts


def symbols(nm, elf):
    lines = subprocess.run([nm, elf], check=True, capture_output=True, text=True).stdout
    return {line.split()[-1] for line in lines.splitlines() if line.strip()}


def report(name, used, limit, detail):
    print(f"{name:6} {used:7} of {limit:7} bytes   {detail}")
    return [] if used <= limit else [f"{name} is over its budget: {used} > {limit} bytes"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("elf")
    parser.add_argument("map")
    parser.add_argument("--objdump", default="arm-none-eabi-objdump")
    parser.add_argument("--nm", default="arm-none-eabi-nm")
    arguments = parser.parse_args()

    sizes = sizes_by_object(Path(arguments.map).read_text(encoding="utf-8"))
    problems = []
    for memory, limit in (("flash", FLASH_LIMIT), ("ram", RAM_LIMIT)):
        parts = own_part(sizes, memory)
        if set(parts) != {"core", "hal", "app", "wire"} and memory == "flash":
            problems.append(f"the map tells nothing of some of our folders: {sorted(parts)}")
        total = sum(size for (kind, _), size in sizes.items() if kind == memory)
        detail = ", ".join(f"{part} {size}" for part, size in sorted(parts.items()))
        problems += report(memory, sum(parts.values()), limit,
                           f"{detail}; with SDK and TinyUSB {total}")
    try:
        depth, path = stack_depth.worst(arguments.objdump, arguments.elf)
        problems += report("stack", depth, STACK_LIMIT, " > ".join(path))
    except stack_depth.Unknown as unknown:
        problems.append(f"stack: {unknown}")
    heap = symbols(arguments.nm, arguments.elf) & HEAP
    if heap:
        problems.append(f"a heap is linked: {', '.join(sorted(heap))}")
    for problem in problems:
        print(f"check_budget: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
