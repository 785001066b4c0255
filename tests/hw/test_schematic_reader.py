# SPDX-License-Identifier: Apache-2.0
"""The reader of schematics against the netlists that KiCad itself wrote of the same files."""
import json
import tempfile
import unittest
from pathlib import Path

from hw_kit import DATA, PROJECT, SCHEMATIC, BrokenCopy, copy_schematic, dump

from kicad_text import FormatError, child, children, parse, properties, value
from read_schematic import read


def pin_sets(nets):
    return {frozenset(pins) for pins in nets}


def own_pin_sets(netlist):
    return pin_sets([f"{ref}.{number}" for ref, number in net.pins]
                    for net in netlist.nets.values())


class AgainstKicad(unittest.TestCase):
    def test_the_box_has_the_nets_that_kicad_finds(self):
        kicad = json.loads((PROJECT / "outputs/opms-box-kicad.json").read_text())
        own = read(SCHEMATIC)
        self.assertGreater(len(own.nets), 50)
        self.assertEqual(own_pin_sets(own), pin_sets(kicad["nets"].values()))

    def test_labelled_nets_have_the_names_that_kicad_gives(self):
        kicad = json.loads((PROJECT / "outputs/opms-box-kicad.json").read_text())
        own = read(SCHEMATIC)
        for net in own.nets.values():
            if net.named:
                self.assertEqual([f"{ref}.{number}" for ref, number in net.pins],
                                 sorted(kicad["nets"][net.name]), net.name)

    def test_parts_have_the_values_and_footprints_that_kicad_finds(self):
        kicad = json.loads((PROJECT / "outputs/opms-box-kicad.json").read_text())
        own = {part.reference: {"value": part.value, "footprint": part.footprint}
               for part in read(SCHEMATIC).parts.values()}
        self.assertEqual(own, kicad["parts"])

    def test_symbols_turned_and_mirrored_every_way_have_their_pins_where_kicad_has_them(self):
        kicad = json.loads((DATA / "turned_symbols-kicad.json").read_text())
        own = read(DATA / "turned_symbols.kicad_sch")
        self.assertEqual(own_pin_sets(own), pin_sets(kicad["nets"].values()))
        # All 12 orientations: gate, source and drain each under a label of its own.
        self.assertEqual(len([net for net in own.nets.values() if net.named]), 12 * 3 + 2)


class Drawing(unittest.TestCase):
    """By hand: what the drawing data/turned_symbols.kicad_sch shows in its lower half."""

    def setUp(self):
        self.netlist = read(DATA / "turned_symbols.kicad_sch")

    def test_wires_that_cross_without_a_dot_are_not_connected(self):
        self.assertIsNot(self.netlist.net_of("R1", "2"), self.netlist.net_of("R3", "2"))
        self.assertIs(self.netlist.net_of("R3", "2"), self.netlist.net_of("R4", "1"))

    def test_a_label_in_the_middle_of_a_wire_joins_it_with_its_namesake(self):
        self.assertIs(self.netlist.net_of("R1", "2"), self.netlist.net_of("R5", "1"))

    def test_three_ends_that_meet_are_connected(self):
        self.assertIs(self.netlist.net_of("R6", "1"), self.netlist.net_of("R7", "2"))
        self.assertIs(self.netlist.net_of("R6", "1"), self.netlist.net_of("R2", "2"))

    def test_a_power_symbol_names_its_net(self):
        self.assertEqual(self.netlist.net_of("R1", "1").name, "GND")


class ForKicad6(unittest.TestCase):
    """What KiCad 6 wants; it was opened with 6.0.11, which no test can do without a screen."""

    def sheets(self):
        for path in sorted(PROJECT.glob("*.kicad_sch")):
            yield path.name, parse(path.read_text(encoding="utf-8"))

    def test_the_files_are_of_its_version(self):
        for name, sheet in self.sheets():
            self.assertLessEqual(int(value(sheet, "version")), 20211123, name)

    def test_drawn_lines_have_two_points(self):
        for name, sheet in self.sheets():
            for line in children(sheet, "polyline"):
                self.assertEqual(len(child(line, "pts")) - 1, 2, name)

    def test_every_uuid_is_there_once(self):
        for name, sheet in self.sheets():
            uuids = [value(item, "uuid") for item in sheet if isinstance(item, list)
                     and child(item, "uuid")]
            self.assertEqual(len(uuids), len(set(uuids)), name)
            self.assertGreater(len(uuids), 5)

    def test_every_symbol_is_embedded(self):
        for name, sheet in self.sheets():
            library = {symbol[1] for symbol in children(child(sheet, "lib_symbols"), "symbol")}
            used = {value(symbol, "lib_id") for symbol in children(sheet, "symbol")}
            self.assertEqual(used, library, name)


class SavedByKicad7(unittest.TestCase):
    """KiCad 7 and later keep references in each symbol, and call a sheet's name otherwise."""

    def test_references_and_sheets_are_read_the_newer_way(self):
        with BrokenCopy() as box:
            root = parse(box.root.read_text(encoding="utf-8"))
            paths = {properties(sheet)["Sheet file"]: "/" + value(sheet, "uuid")
                     for sheet in children(root, "sheet")}
            units = {entry[1].rsplit("/", 1)[1]: entry
                     for entry in children(child(root, "symbol_instances"), "path")}
            for path in box.root.parent.glob("*.kicad_sch"):
                node = parse(path.read_text(encoding="utf-8"))
                self.rewrite(node, "/" + value(root, "uuid") + paths.get(path.name, ""), units)
                path.write_text(dump(node), encoding="utf-8")
            self.assertEqual(own_pin_sets(box.netlist()), own_pin_sets(read(SCHEMATIC)))

    @staticmethod
    def rewrite(node, path, units):
        for symbol in children(node, "symbol"):
            entry = units[value(symbol, "uuid")]
            symbol.append(["instances", ["project", "opms-box",
                                         ["path", path, ["reference", value(entry, "reference")],
                                          ["unit", value(entry, "unit")]]]])
            for field in children(symbol, "property"):
                if field[1] == "Reference":
                    field[2] = field[2].rstrip("0123456789") + "?"
        for sheet in children(node, "sheet"):
            for field in children(sheet, "property"):
                field[1] = {"Sheet name": "Sheetname", "Sheet file": "Sheetfile"}[field[1]]
        for old in children(node, "symbol_instances"):
            node.remove(old)


class BadFiles(unittest.TestCase):
    def refuse(self, text, words):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "x.kicad_sch"
            path.write_text(text, encoding="utf-8")
            with self.assertRaisesRegex(FormatError, words):
                read(path)

    def test_a_cut_file_is_refused(self):
        text = SCHEMATIC.read_text(encoding="utf-8")
        self.refuse(text[:len(text) // 2], "do not close")

    def test_a_file_of_another_kind_is_refused(self):
        self.refuse("(kicad_pcb (version 1))", "not a schematic")

    def test_buses_are_refused_rather_than_overlooked(self):
        self.refuse("(kicad_sch (uuid a) (bus (pts (xy 0 0) (xy 1 1))))", "buses")

    def test_a_missing_sheet_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder:
            root = copy_schematic(folder)
            (root.parent / "opms-box-inputs.kicad_sch").unlink()
            with self.assertRaises(FileNotFoundError):
                read(root)

    def test_quotes_and_newlines_within_strings_are_kept(self):
        self.assertEqual(parse('(a "b \\"c\\" (d)\\ne" f)'), ["a", 'b "c" (d)\ne', "f"])


if __name__ == "__main__":
    unittest.main()
