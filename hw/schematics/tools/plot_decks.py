# SPDX-License-Identifier: Apache-2.0
"""Draw curves of the ngspice decks as SVG.

    plot_decks.py DIR

Each plot is a deck, some of its corners and the nodes to show.
"""
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import run_decks  # noqa: E402
from read_schematic import read  # noqa: E402

WIDTH, HEIGHT = 720, 300
LEFT, RIGHT, TOP, BOTTOM = 60, 170, 34, 44
COLOURS = ("#1b6ca8", "#c2410c", "#15803d", "#7e22ce", "#a16207", "#0f766e")
MAX_POINTS = 700


@dataclass
class Plot:
    name: str
    deck: str
    title: str
    curves: list  # (corner, node, label)
    span: tuple  # of time, in units of `unit`
    unit: str
    unit_s: float
    y_label: str = "V"


PLOTS = [
    Plot("start-delay", "start_delay", "START: from the connector to the Pico's pin",
         [("v5_typical", "in", "5 V at the connector"), ("v5_typical", "lim", "at the gate"),
          ("v5_typical", "start", "Pico's pin"), ("v3p3_slow", "start", "pin, 3.3 V, slowest"),
          ("v24_fast", "start", "pin, 24 V, fastest")], (0, 700), "ns", 1e-9),
    Plot("start-threshold", "start_threshold", "START: a slow ramp up and down (TTL)",
         [("ttl_typical", "in", "connector"), ("ttl_typical", "lim", "at the gate"),
          ("ttl_typical", "out", "first gate's output")], (0, 20), "ms", 1e-3),
    Plot("esd-start", "esd_start", "8 kV contact discharge into START",
         [("plus", "in", "connector"), ("plus", "lim", "gate"), ("plus", "start", "Pico's pin"),
          ("minus", "lim", "gate, -8 kV")], (0, 150), "ns", 1e-9),
    Plot("trig-open", "trig_line", "TRIG: end of 20 m of cable, open",
         [("open_typical", "end", "RG-174, typical"), ("open_slow", "end", "RG-174, slowest"),
          ("open_fast", "end", "RG-174, fastest"), ("open_lossless", "end", "cable without loss")],
         (0, 1800), "ns", 1e-9),
    Plot("trig-terminated", "trig_line", "TRIG: end of 20 m of cable, 50 ohm",
         [("term_typical", "end", "RG-174, typical"), ("term_slow", "end", "RG-174, slowest"),
          ("term_fast", "end", "without loss, fastest")], (0, 1800), "ns", 1e-9),
    Plot("trig-opto", "trig_opto", "TRIG 3: camera's input at 24 V",
         [("v24", "pin", "Pico's pin"), ("v24", "cam", "camera, typical"),
          ("v24_weak", "cam", "camera, old optocoupler"),
          ("v24_strong", "cam", "camera, best optocoupler")], (0, 1100), "us", 1e-6),
    Plot("supply-fault", "supply_fault", "USB: 20 V within 1 ms, and a good supply",
         [("over20slow", "src", "20 V supply"), ("over20slow", "out", "+5V then"),
          ("good", "out", "+5V, good supply")], (0, 2), "ms", 1e-3),
    Plot("output-fault", "output_fault", "+24 V on TRIG 1: the fuse opens",
         [("plus_low", "src", "24 V supply"), ("plus_low", "drv", "behind the fuse"),
          ("plus_low", "vcl5", "clamp rail")], (0, 60), "ms", 1e-3),
]


def curves_of(deck, corner, nodes, parts):
    """(time, values of each node) of one run."""
    text = (run_decks.DECKS / f"{deck}.cir").read_text(encoding="utf-8")
    parameters = run_decks.corners(text)[corner]
    wanted = " ".join(f"v({node})" for node in nodes)
    control = f".control\nrun\nset wr_singlescale\nwrdata curves.txt {wanted}\nquit\n.endc\n.end"
    with tempfile.TemporaryDirectory() as folder:
        run_decks.write_deck(Path(folder), re.sub(r"^\.end$", control, text, flags=re.M),
                             parameters, parts)
        subprocess.run(["ngspice", "-b", "deck.cir"], cwd=folder, capture_output=True,
                       timeout=run_decks.TIMEOUT_S)
        table = [[float(word) for word in line.split()]
                 for line in (Path(folder) / "curves.txt").read_text().splitlines()]
    return [row[0] for row in table], [[row[1 + i] for row in table] for i in range(len(nodes))]


def nice_step(span, count):
    for step in (s * 10 ** e for e in range(-6, 7) for s in (1, 2, 5)):
        if span / step <= count:
            return step
    return span


def thinned(points):
    step = max(1, len(points) // MAX_POINTS)
    return points[::step] + points[-1:]


def draw(plot, lines):
    """lines: label -> points (x in the plot's unit, y)."""
    low = min(y for points in lines.values() for _, y in points)
    high = max(y for points in lines.values() for _, y in points)
    step_y = nice_step(high - low, 6)
    low, high = step_y * (low // step_y), step_y * (-(-high // step_y))
    x0, x1 = plot.span

    def place(x, y):
        return (LEFT + (x - x0) / (x1 - x0) * (WIDTH - LEFT - RIGHT),
                HEIGHT - BOTTOM - (y - low) / (high - low) * (HEIGHT - TOP - BOTTOM))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
           f'width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>',
           f'<text x="{LEFT}" y="20" font-size="14" font-weight="bold">{plot.title}</text>']
    out += grid(place, (x0, x1), (low, high), step_y)
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2:.0f}" y="{HEIGHT - 8}" '
               f'text-anchor="middle">{plot.unit}</text>')
    out.append(f'<text x="14" y="{HEIGHT / 2:.0f}">{plot.y_label}</text>')
    for number, (label, points) in enumerate(lines.items()):
        colour = COLOURS[number % len(COLOURS)]
        path = " ".join("{:.1f},{:.1f}".format(*place(x, y)) for x, y in thinned(points))
        out.append(f'<polyline fill="none" stroke="{colour}" stroke-width="1.5" points="{path}"/>')
        out.append(f'<text x="{WIDTH - RIGHT + 10}" y="{TOP + 14 + 17 * number}" '
                   f'fill="{colour}">{label}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"


def grid(place, x_range, y_range, step_y):
    step_x = nice_step(x_range[1] - x_range[0], 8)
    for number in range(int((x_range[1] - x_range[0]) / step_x + 1e-9) + 1):
        x = x_range[0] + number * step_x
        (at, bottom), (_, top) = place(x, y_range[0]), place(x, y_range[1])
        yield f'<path d="M{at:.1f} {bottom:.1f}V{top:.1f}" stroke="#ddd"/>'
        yield f'<text x="{at:.1f}" y="{bottom + 16:.1f}" text-anchor="middle">{x:g}</text>'
    for number in range(int((y_range[1] - y_range[0]) / step_y + 1e-9) + 1):
        y = y_range[0] + number * step_y
        (left, at), (right, _) = place(x_range[0], y), place(x_range[1], y)
        yield f'<path d="M{left:.1f} {at:.1f}H{right:.1f}" stroke="#ddd"/>'
        yield f'<text x="{left - 6:.1f}" y="{at + 4:.1f}" text-anchor="end">{y:.4g}</text>'


def make(plot, parts):
    lines = {}
    for corner in dict.fromkeys(corner for corner, _, _ in plot.curves):
        wanted = [(node, label) for at, node, label in plot.curves if at == corner]
        times, values = curves_of(plot.deck, corner, [node for node, _ in wanted], parts)
        for (_, label), column in zip(wanted, values):
            points = [(time / plot.unit_s, y) for time, y in zip(times, column)]
            lines[label] = [(x, y) for x, y in points if plot.span[0] <= x <= plot.span[1]]
    return draw(plot, lines)


def main(arguments):
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    parts = run_decks.part_parameters(read(run_decks.PROJECT / "opms-box.kicad_sch"))
    for plot in PLOTS:
        (folder / f"{plot.name}.svg").write_text(make(plot, parts), encoding="utf-8")
        print(folder / f"{plot.name}.svg")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
