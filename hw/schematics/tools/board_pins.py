# SPDX-License-Identifier: Apache-2.0
"""The firmware's board_pins.h against the schematic: is each line on the pin that it names?

    board_pins.py [board_pins.h [FILE.kicad_sch]]      exit code 1 if they disagree
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from read_schematic import read  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
HEADER = ROOT / "firmware/app/board_pins.h"
SCHEMATIC = ROOT / "hw/schematics/opms-box.kicad_sch"
DEFINE = re.compile(r"^#define\s+PIN_(\w+)\s+(\d+)U?\b", re.MULTILINE)
GPIO = re.compile(r"^GP(\d+)(?:_\w+)?$")


def header_pins(text):
    """GPIO number of each line."""
    return {name: int(number) for name, number in DEFINE.findall(text)}


def schematic_pins(netlist):
    """The net of each GPIO of the Pico; None where it is left open."""
    pico = next(part for part in netlist.by_kind("U") if "Pico" in part.value)
    found = {}
    for number, pin in pico.pins.items():
        match = GPIO.match(pin.name)
        if match:
            net = netlist.net_of(pico.reference, number)
            found[int(match.group(1))] = net if len(net.pins) > 1 else None
    return found


def problems(header_text, netlist):
    lines, pins = header_pins(header_text), schematic_pins(netlist)
    if not lines:
        yield "the header defines no pins"
    for name, gpio in lines.items():
        net = pins.get(gpio)
        if net is None:
            yield f"{name}: GPIO {gpio} is not connected in the schematic"
        elif net.short_name != name:
            yield f"{name}: GPIO {gpio} is on {net.name} in the schematic"
    for gpio, net in sorted(pins.items()):
        if net is not None and gpio not in lines.values():
            yield f"GPIO {gpio} is on {net.name} in the schematic, unknown to the firmware"


def main(arguments):
    header = Path(arguments[0]) if arguments else HEADER
    schematic = arguments[1] if len(arguments) > 1 else SCHEMATIC
    found = list(problems(header.read_text(encoding="utf-8"), read(schematic)))
    print("\n".join(found) if found else "firmware and schematic agree on the pins")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
