# SPDX-License-Identifier: Apache-2.0
"""Run the ngspice decks of hw/schematics/spice and hold their figures against the limits.

    run_decks.py                    table of limit, simulated, margin; exit code 1 if one is missed
    run_decks.py --only DECK        one deck
    run_decks.py --document FILE    write the table into a document between its two marks

A deck is a netlist with lines `*@corner NAME key=value ...`; it runs once for each, and
`*@default key=value ...` for all of them. The values of
resistors and capacitors come out of the schematic (parts.inc: `.param R11=4.7k`), so that a deck
cannot go on with an old value. What must hold is in spice/limits.csv: the worst corner counts.
"""
import argparse
import csv
import math
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from read_schematic import read  # noqa: E402

PROJECT = Path(__file__).resolve().parents[1]
DECKS = PROJECT / "spice"
CORNER = re.compile(r"^\*@corner\s+(\w+)((?:\s+\w+=\S+)*)\s*$", re.MULTILINE)
DEFAULT = re.compile(r"^\*@default((?:\s+\w+=\S+)*)\s*$", re.MULTILINE)
MEASURE = re.compile(r"^\.meas\s+tran\s+(\w+)", re.MULTILINE)
MEASURED = re.compile(r"^(\w+)\s+=\s+([-+.\deE]+|failed)", re.MULTILINE)
VALUE = re.compile(r"^([\d.]+)(p|n|u|m|k|M)?(?:\s.*)?$")
MEGA = "meg"  # to SPICE, M is milli
TIMEOUT_S = 30
MARKS = ("<!-- figures: run_decks.py -->", "<!-- end of figures -->")


class DeckError(RuntimeError):
    """A deck did not run, or a figure is missing."""


@dataclass
class Limit:
    deck: str
    measure: str
    worst: str  # max: no corner may be above the limit; min: none below
    limit: float
    unit: str
    corners: str  # a regular expression
    what: str
    source: str


@dataclass
class Result:
    limit: Limit
    value: float
    corner: str

    @property
    def margin(self):
        difference = self.limit.limit - self.value
        return difference if self.limit.worst == "max" else -difference

    @property
    def holds(self):
        """Not where the value is NaN."""
        return self.margin >= 0


def part_parameters(netlist):
    """`.param` lines for all resistors and capacitors of the schematic."""
    lines = []
    for part in netlist.parts.values():
        if part.kind in ("R", "C"):
            match = VALUE.match(part.value)
            if not match:
                raise DeckError(f"{part.reference}: cannot read the value {part.value!r}")
            number, prefix = match.groups()
            unit = {"M": MEGA, None: ""}.get(prefix, prefix)
            lines.append(f".param {part.reference}={number}{unit}")
    return "\n".join(lines) + "\n"


def corners(deck_text):
    """Parameters of each corner: the defaults, and over them the corner's own."""
    def pairs(text):
        return dict(pair.split("=", 1) for pair in text.split())

    common = {}
    for text in DEFAULT.findall(deck_text):
        common.update(pairs(text))
    found = {name: {**common, **pairs(text)} for name, text in CORNER.findall(deck_text)}
    return found or {"nominal": common}


def write_deck(folder, deck_text, parameters, parts):
    """deck.cir and what it includes, in a folder."""
    lines = deck_text.split("\n")
    settings = "".join(f".param {key}={value}\n" for key, value in parameters.items())
    text = "\n".join([lines[0], settings + ".include box_models.lib", *lines[1:]])
    (folder / "parts.inc").write_text(parts)
    (folder / "box_models.lib").write_text((DECKS / "box_models.lib").read_text())
    (folder / "deck.cir").write_text(text)


def run_corner(deck_text, parameters, parts):
    """All measurements of one run, by name; NaN where what is measured did not happen."""
    with tempfile.TemporaryDirectory() as folder:
        write_deck(Path(folder), deck_text, parameters, parts)
        try:
            result = subprocess.run(["ngspice", "-b", "deck.cir"], cwd=folder, timeout=TIMEOUT_S,
                                    capture_output=True, text=True)
        except subprocess.TimeoutExpired as error:
            raise DeckError(f"no result within {TIMEOUT_S} s") from error
    measured = {name.lower(): float(value) for name, value in MEASURED.findall(result.stdout)
                if value != "failed" and name != "Stack"}
    if not measured or result.returncode or "aborted" in result.stdout + result.stderr:
        raise DeckError(f"ngspice:\n{result.stdout[-2000:]}{result.stderr[-2000:]}")
    return {name: measured.get(name, math.nan) for name in MEASURE.findall(deck_text)}


def run_deck(name, parts):
    """Measurements of each corner."""
    text = (DECKS / f"{name}.cir").read_text(encoding="utf-8")
    found = {}
    for corner, parameters in corners(text).items():
        try:
            found[corner] = run_corner(text, parameters, parts)
        except DeckError as error:
            raise DeckError(f"{name}, {corner}: {error}") from error
    return found


def read_limits():
    with open(DECKS / "limits.csv", encoding="utf-8", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [Limit(**{**row, "limit": float(row["limit"])}) for row in rows]


def judge(limit, measurements):
    """The worst corner of one figure."""
    pick = max if limit.worst == "max" else min
    values = {}
    for corner, measured in measurements.items():
        if re.fullmatch(limit.corners or ".*", corner):
            if limit.measure not in measured:
                raise DeckError(f"{limit.deck}, {corner}: no {limit.measure}")
            values[corner] = measured[limit.measure]
    if not values:
        raise DeckError(f"{limit.deck}: no corner matches {limit.corners!r}")
    never = [corner for corner, value in values.items() if math.isnan(value)]
    corner = never[0] if never else pick(values, key=values.get)
    return Result(limit, values[corner], corner)


def run_all(only=None, netlist=None):
    """Results of all limits, in their order."""
    limits = [limit for limit in read_limits() if only in (None, limit.deck)]
    parts = part_parameters(netlist or read(PROJECT / "opms-box.kicad_sch"))
    decks = list(dict.fromkeys(limit.deck for limit in limits))
    with ThreadPoolExecutor(2) as pool:
        measurements = dict(zip(decks, pool.map(lambda deck: run_deck(deck, parts), decks)))
    return [judge(limit, measurements[limit.deck]) for limit in limits]


SCALES = {"ns": 1e9, "us": 1e6, "ms": 1e3, "s": 1, "V": 1, "A": 1, "mA": 1e3, "W": 1, "mW": 1e3,
          "J": 1, "ohm": 1}


def shown(value, unit):
    """A figure of the table: values are kept in SI, the unit says how they are shown."""
    return f"{value * SCALES[unit]:.3g} {unit}"


def table(results):
    lines = ["| what | limit | simulated | margin | worst corner |", "|---|---|---|---|---|"]
    for result in results:
        limit = result.limit
        sign = "at most" if limit.worst == "max" else "at least"
        lines.append(f"| {limit.what} | {sign} {shown(limit.limit, limit.unit)} ({limit.source}) "
                     f"| {shown(result.value, limit.unit)} | {shown(result.margin, limit.unit)} "
                     f"| `{limit.deck}` {result.corner} |")
    return "\n".join(lines)


def write_document(path, text):
    """Put the table between the marks of a document."""
    document = path.read_text(encoding="utf-8")
    before, rest = document.split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    path.write_text(f"{before}{MARKS[0]}\n{text}\n{MARKS[1]}{after}", encoding="utf-8")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="DECK")
    parser.add_argument("--document", type=Path, metavar="FILE")
    options = parser.parse_args(arguments)
    try:
        results = run_all(options.only)
    except DeckError as error:
        print(f"run_decks: {error}", file=sys.stderr)
        return 1
    print(table(results))
    if options.document:
        write_document(options.document, table(results))
    missed = [result for result in results if not result.holds]
    for result in missed:
        print(f"MISSED: {result.limit.what}", file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
