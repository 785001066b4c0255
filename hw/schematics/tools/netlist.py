# SPDX-License-Identifier: Apache-2.0
"""What a schematic says when the drawing is gone: parts with their pins, and nets."""
from dataclasses import dataclass, field


@dataclass
class Pin:
    number: str
    name: str
    kind: str  # KiCad's electrical type: input, output, passive, power_in ...
    not_connected: bool = False  # the drawing marks it so


@dataclass
class Part:
    reference: str
    value: str
    footprint: str
    fields: dict
    in_bom: bool
    library: str
    pins: dict = field(default_factory=dict)

    @property
    def kind(self):
        """The letters of the reference: R, C, TP ..."""
        return self.reference.rstrip("0123456789")

    @property
    def description(self):
        return self.fields.get("Description", "")


@dataclass
class Net:
    name: str
    pins: list  # (reference, pin number), sorted
    named: bool  # by a label or a power symbol; else the name is made of a pin's

    @property
    def short_name(self):
        return self.name.rsplit("/", 1)[-1]


class Netlist:
    def __init__(self, parts, nets, flags):
        """flags: names of the nets that a PWR_FLAG says are supplied."""
        self.parts = {part.reference: part for part in parts}
        self.nets = {net.name: net for net in nets}
        self.flags = set(flags)
        self._net_of = {pin: net for net in nets for pin in net.pins}

    def net_of(self, reference, number):
        return self._net_of[(reference, number)]

    def pin(self, reference, number):
        return self.parts[reference].pins[number]

    def pins_of(self, net):
        """The pins of a net, each with its part."""
        return [(self.parts[ref], self.pin(ref, number)) for ref, number in net.pins]

    def others(self, reference, number):
        """Where the current of a two-terminal part comes out: its other pins' nets."""
        return [self.net_of(reference, other) for other in self.parts[reference].pins
                if other != number]

    def parts_between(self, net, other, kind=None):
        """Parts with a pin on each of two nets."""
        here = {ref for ref, _ in net.pins}
        there = {ref for ref, _ in other.pins}
        found = [self.parts[ref] for ref in sorted(here & there)]
        return [part for part in found if kind is None or part.kind == kind]

    def by_kind(self, kind):
        return [part for part in self.parts.values() if part.kind == kind]
