# SPDX-License-Identifier: Apache-2.0
"""Electrical rules over the netlist of the box's schematic.

    electrical_rules.py [FILE.kicad_sch]      print what is wrong; exit code 1 if anything is

What KiCad's own check knows (pins left open, outputs against each other, supplies that nothing
feeds, inputs that nothing drives), and what it does not: pull-ups and pull-downs, protection of
every pin of every connector, which way round diodes are, and capacitors at every chip.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from read_schematic import read  # noqa: E402

GROUND = "GND"
RAILS = ("+5V", "+3V3")
DRIVERS = {"output", "power_out"}
FEEDERS = {"power_out"}
# A pin of these kinds can set the level of an input.
SOURCES = {"output", "bidirectional", "tri_state", "open_collector", "open_emitter", "power_out",
           "passive"}
# Of the Pico's lines: low must hold while it boots, when its pins are inputs.
LOW_AT_RESET = ("TRIG", "SYNC")
SERIES_KINDS = ("F",)
# Diodes in series whose symbol does not name its pins: anode and cathode of the row.
PAIRS = {"BAT54S": {"A": "1", "K": "2"}}
# Pins with no connection to the box's ground but by what an isolation barrier may have.
ISOLATED = (("J6", "1"), ("J6", "2"), ("J7", "1"), ("J7", "2"))
BARRIER_VALUES = ("1M", "1n 2 kV")
# USB-C says by a resistor alone what is plugged in; these pins lead nowhere else.
RESISTOR_IS_ENOUGH = ("CC1", "CC2")


def names(pins):
    return ", ".join(f"{part.reference}.{pin.number}" for part, pin in pins)


def open_pins(netlist):
    for net in netlist.nets.values():
        pins = netlist.pins_of(net)
        for part, pin in pins:
            if pin.not_connected and len(pins) > 1:
                yield f"{part.reference}.{pin.number} is marked as not connected, but is"
        part, pin = pins[0]
        if len(pins) == 1 and not pin.not_connected and pin.kind != "no_connect":
            yield f"{part.reference}.{pin.number} ({pin.name}) is not connected"


def outputs_against_each_other(netlist):
    for net in netlist.nets.values():
        drivers = [(part, pin) for part, pin in netlist.pins_of(net) if pin.kind in DRIVERS]
        softer = [(part, pin) for part, pin in netlist.pins_of(net)
                  if pin.kind in ("tri_state", "open_collector", "open_emitter")]
        three_state = [pair for pair in softer if pair[1].kind == "tri_state"]
        if len(drivers) > 1 or (drivers and softer) or len(three_state) > 1:
            yield f"{net.name}: outputs against each other: {names(drivers + softer)}"


def missing_supplies(netlist):
    for net in netlist.nets.values():
        pins = netlist.pins_of(net)
        wanting = [pair for pair in pins if pair[1].kind == "power_in"]
        fed = net.name in netlist.flags or any(pin.kind in FEEDERS for _, pin in pins)
        if wanting and not fed:
            yield f"{net.name}: nothing supplies {names(wanting)}"


def undriven_inputs(netlist):
    for net in netlist.nets.values():
        pins = netlist.pins_of(net)
        inputs = [pair for pair in pins if pair[1].kind == "input"]
        if inputs and len(pins) > 1 and net.name not in (GROUND, *RAILS) \
                and not any(pin.kind in SOURCES for _, pin in pins):
            yield f"{net.name}: nothing drives {names(inputs)}"


def has_resistor_to(netlist, net, rails):
    return any(netlist.parts_between(net, netlist.nets[rail], "R")
               for rail in rails if rail in netlist.nets)


def missing_pulls(netlist):
    for net in netlist.nets.values():
        pins = netlist.pins_of(net)
        open_collectors = [pair for pair in pins if pair[1].kind == "open_collector"]
        if open_collectors and not has_resistor_to(netlist, net, RAILS):
            yield f"{net.name}: no pull-up for {names(open_collectors)}"
        if net.short_name in LOW_AT_RESET and net.named \
                and not has_resistor_to(netlist, net, [GROUND]):
            yield f"{net.name}: no pull-down; it floats while the Pico boots"


def is_clamp(part):
    return part.kind == "D" and any(word in part.description for word in
                                    ("TVS", "Schottky", "Zener"))


def is_esd_array(part):
    return part.kind == "U" and "ESD" in part.description


def two_way(part):
    return "two ways" in part.description


def clamp_rails(netlist):
    """Nets that a Zener diode or a TVS holds down: whoever leads into them is clamped."""
    ground = netlist.nets[GROUND]
    for part in ground_parts(netlist):
        if part.kind == "D" and ("Zener" in part.description or "one way" in part.description):
            for number in part.pins:
                if netlist.net_of(part.reference, number) is not ground:
                    yield netlist.net_of(part.reference, number).name


def ground_parts(netlist):
    return [netlist.parts[ref] for ref in sorted({ref for ref, _ in netlist.nets[GROUND].pins})]


def clamped(netlist, net, partners):
    """Both ways: by one part that works both ways or that conducts forward, or by a pair.

    partners: nets that count as ground; for isolated pins it is the other pin of the pair.
    """
    rails = set(clamp_rails(netlist))
    high = low = False
    for ref, number in net.pins:
        part = netlist.parts[ref]
        if is_esd_array(part):
            return True
        if not is_clamp(part):
            continue
        for other in netlist.others(ref, number):
            if other.name in partners:
                high |= "TVS" in part.description or "Zener" in part.description
                low = True
            elif other.name in rails:
                high = True
    return high and low


def series_neighbours(netlist, net):
    """The net itself and those behind a fuse."""
    yield net
    for ref, number in net.pins:
        if netlist.parts[ref].kind in SERIES_KINDS:
            yield from netlist.others(ref, number)


def unprotected_pins(netlist):
    for connector in netlist.by_kind("J"):
        behind = {}
        for number in connector.pins:
            net = netlist.net_of(connector.reference, number)
            behind[number] = list(series_neighbours(netlist, net))
        for number, pin in connector.pins.items():
            nets = behind[number]
            if pin.not_connected or nets[0].name == GROUND or harmless(netlist, pin, nets[0]):
                continue
            partners = {GROUND} | {net.name for other, others in behind.items()
                                   if other != number for net in others}
            if not any(clamped(netlist, net, partners) for net in nets):
                yield f"{connector.reference}.{number} ({nets[0].name}) has no protection"


def harmless(netlist, pin, net):
    kinds = {part.kind for part, _ in netlist.pins_of(net)}
    return pin.name in RESISTOR_IS_ENOUGH and kinds == {"J", "R"}


def ends_of_diode(netlist, part):
    """Nets of anode and cathode, as {"A": ..., "K": ...}."""
    nets = {number: netlist.net_of(part.reference, number).name for number in part.pins}
    numbers = PAIRS.get(part.value)
    if numbers:
        return {name: nets[number] for name, number in numbers.items()}
    return {pin.name: nets[number] for number, pin in part.pins.items()}


def diodes_the_wrong_way(netlist):
    """Where one end is ground it must be the anode; where it is a rail, the cathode."""
    for part in netlist.by_kind("D"):
        ends = ends_of_diode(netlist, part)
        if ends.get("K") == GROUND and ends.get("A") != GROUND:
            yield f"{part.reference}: its cathode is at ground"
        if ends.get("A") in (*RAILS, *clamp_rails(netlist)) and is_clamp(part):
            yield f"{part.reference}: its anode is at {ends['A']}"


def bridged_isolation(netlist):
    """From an isolated pin through fuses, diodes, resistors: nothing may lead to the box's side."""
    for start in ISOLATED:
        if start[0] not in netlist.parts:
            yield f"there is no {start[0]}"
            continue
        seen, waiting = set(), [netlist.net_of(*start)]
        while waiting:
            net = waiting.pop()
            if net.name in (GROUND, *RAILS):
                yield f"{start[0]}.{start[1]} is not isolated from {net.name}"
                break
            seen.add(net.name)
            for ref, number in net.pins:
                part = netlist.parts[ref]
                if part.kind in ("R", "C", "D", "F", "Q") and part.value not in BARRIER_VALUES:
                    waiting += [other for other in netlist.others(ref, number)
                                if other.name not in seen]


def transistors_the_wrong_way(netlist):
    """N: source to ground. P: in pairs, source to source, so that one of them always blocks."""
    sources = {}
    for part in netlist.by_kind("Q"):
        nets = {pin.name: netlist.net_of(part.reference, number).name
                for number, pin in part.pins.items()}
        if "N-MOSFET" in part.description and nets["S"] != GROUND:
            yield f"{part.reference}: its source is at {nets['S']}, not at ground"
        if "P-MOSFET" in part.description:
            sources.setdefault(nets["S"], []).append(part.reference)
    for net, references in sources.items():
        if len(references) != 2:
            yield f"{', '.join(references)}: the source at {net} has no partner, back to back"


def missing_decoupling(netlist):
    """As many capacitors of 100 nF at each rail as there are chips on it."""
    ground = netlist.nets[GROUND]
    for rail in RAILS:
        if rail not in netlist.nets:
            yield f"there is no rail {rail}"
            continue
        chips = {part.reference for part, pin in netlist.pins_of(netlist.nets[rail])
                 if part.kind == "U" and pin.kind == "power_in"}
        capacitors = [part for part in netlist.parts_between(netlist.nets[rail], ground, "C")
                      if part.value == "100n"]
        if len(capacitors) < len(chips):
            yield (f"{rail}: {len(capacitors)} capacitors of 100n for {len(chips)} chips "
                   f"({', '.join(sorted(chips))})")


def incomplete_parts(netlist):
    for part in netlist.parts.values():
        if not part.footprint:
            yield f"{part.reference} has no footprint"
        if part.in_bom and not part.fields.get("MPN"):
            yield f"{part.reference} has no manufacturer's number"


RULES = (open_pins, outputs_against_each_other, missing_supplies, undriven_inputs, missing_pulls,
         unprotected_pins, diodes_the_wrong_way, transistors_the_wrong_way, bridged_isolation,
         missing_decoupling, incomplete_parts)


def problems(netlist):
    return [problem for rule in RULES for problem in rule(netlist)]


def main(arguments):
    default = Path(__file__).resolve().parents[1] / "opms-box.kicad_sch"
    found = problems(read(arguments[0] if arguments else default))
    print("\n".join(found) if found else "electrical rules hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
