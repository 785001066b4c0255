# SPDX-License-Identifier: Apache-2.0
"""What the guides say of connectors, test points and parts is what the schematic says."""
import re
import unittest

from hw_kit import ROOT, SCHEMATIC, BrokenCopy

from electrical_rules import series_neighbours
from read_schematic import read

ASSEMBLY = (ROOT / "docs/box-assembly.md").read_text(encoding="utf-8")
WIRING = (ROOT / "docs/box-wiring.md").read_text(encoding="utf-8")
CONNECTOR_ROW = re.compile(r"^\| (J\d)\.(\w+) \| (\w+) \|", re.MULTILINE)
NAMED_PIN = re.compile(r"\b(J\d)\.(\d) \((\w+)\)")
NAMED_TEST_POINT = re.compile(r"\b(TP\d\d) \(([+\w]+)\)")
REFERENCE = re.compile(r"(?<![-\w])(?:JP|TP(?=\d\d)|[RCDFJQU])\d{1,2}\b(?!-)")


def names_at(netlist, connector, number):
    """Of the pin's net, and of the one behind its fuse."""
    net = netlist.net_of(connector, number)
    return {found.short_name for found in series_neighbours(netlist, net)}


def wrong_rows(netlist):
    """Pins of the assembly guide's table that are something else in a netlist."""
    return [f"{connector}.{number}" for connector, number, name in CONNECTOR_ROW.findall(ASSEMBLY)
            if name not in names_at(netlist, connector, number)]


class Guides(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.netlist = read(SCHEMATIC)

    def names_at(self, connector, number):
        return names_at(self.netlist, connector, number)

    def test_the_table_of_connectors_is_the_schematics(self):
        self.assertEqual(len(CONNECTOR_ROW.findall(ASSEMBLY)), 11)
        self.assertEqual(wrong_rows(self.netlist), [])

    def test_swapped_pins_of_a_connector_are_caught(self):
        with BrokenCopy() as box:
            box.cut_wires_at("J6", "3")
            box.cut_wires_at("J6", "2")
            box.join(("J6", "3"), ("D8", "1"))
            self.assertEqual(wrong_rows(box.netlist()), ["J6.2", "J6.3"])

    def test_the_table_has_every_pin_of_the_screw_terminals(self):
        rows = {(connector, number) for connector, number, _ in CONNECTOR_ROW.findall(ASSEMBLY)}
        for connector in ("J6", "J7"):
            for number in self.netlist.parts[connector].pins:
                self.assertIn((connector, number), rows)

    def test_pins_named_in_the_wiring_guide_are_those_lines(self):
        found = NAMED_PIN.findall(WIRING)
        self.assertGreater(len(found), 4)
        for connector, number, name in found:
            self.assertTrue(any(net.startswith(name) for net in self.names_at(connector, number)),
                            f"{connector}.{number} ({name})")

    def test_named_test_points_are_on_those_nets(self):
        found = NAMED_TEST_POINT.findall(ASSEMBLY)
        self.assertGreaterEqual(len(found), 3)
        for reference, name in found:
            self.assertEqual(self.netlist.net_of(reference, "1").short_name, name)

    def test_every_part_that_a_guide_names_exists(self):
        for text in (ASSEMBLY, WIRING):
            named = set(REFERENCE.findall(text))
            self.assertGreater(len(named), 4)
            self.assertEqual(named - set(self.netlist.parts), set())

    def test_every_jumper_is_explained(self):
        for jumper in self.netlist.by_kind("JP"):
            self.assertIn(f"\n| {jumper.reference} |", ASSEMBLY)


if __name__ == "__main__":
    unittest.main()
