# SPDX-License-Identifier: Apache-2.0
"""What is made of the schematic is committed; it must be of this very schematic, and complete."""
import csv
import json
import re
import tempfile
import unittest

from hw_kit import PROJECT, SCHEMATIC, copy_schematic

from bill_of_materials import NEEDED_FIELDS
from kicad_text import children, parse, value
from make_outputs import own_files, schematic_hash
from read_schematic import read

OUTPUTS = PROJECT / "outputs"


class Current(unittest.TestCase):
    def test_netlist_and_parts_list_are_what_the_schematic_gives_now(self):
        for name, text in own_files().items():
            self.assertEqual((OUTPUTS / name).read_text(encoding="utf-8"), text,
                             f"{name}: run hw/schematics/tools/make_outputs.py")

    def test_every_file_is_stamped_with_the_hash_of_this_schematic(self):
        stamp = schematic_hash()
        names = sorted(path.name for path in OUTPUTS.iterdir())
        self.assertEqual(len(names), 9, names)
        for name in names:
            found = re.findall(rb"schematic.sha256\W+([0-9a-f]{64})", (OUTPUTS / name).read_bytes())
            self.assertEqual(found, [stamp.encode()],
                             f"{name}: run hw/schematics/tools/make_outputs.py")

    def test_the_hash_changes_with_any_sheet(self):
        for sheet in sorted(PROJECT.glob("*.kicad_sch")):
            with tempfile.TemporaryDirectory() as folder:
                path = copy_schematic(folder).parent / sheet.name
                text = path.read_text(encoding="utf-8")
                path.write_text(text.replace("(paper", "(paper ", 1), encoding="utf-8")
                self.assertNotEqual(schematic_hash(path.parent), schematic_hash(), sheet.name)


class PartsList(unittest.TestCase):
    def setUp(self):
        with open(OUTPUTS / "opms-box-bom.csv", encoding="utf-8", newline="") as file:
            self.table = list(csv.DictReader(file))[:-2]

    def test_every_part_has_a_maker_a_number_a_second_source_a_price_and_a_footprint(self):
        for row in self.table:
            for column in (*NEEDED_FIELDS, "Footprint"):
                self.assertTrue(row[column].strip(), f"{row['References']}: no {column}")
            self.assertNotEqual((row["Manufacturer"], row["MPN"]),
                                (row["Manufacturer 2"], row["MPN 2"]), row["References"])
            self.assertGreater(float(row["Cost EUR"]), 0, row["References"])

    def test_every_part_to_buy_is_listed_once(self):
        listed = [ref for row in self.table for ref in row["References"].split()]
        wanted = [part.reference for part in read(SCHEMATIC).parts.values() if part.in_bom]
        self.assertEqual(sorted(listed), sorted(wanted))
        for row in self.table:
            self.assertEqual(int(row["Quantity"]), len(row["References"].split()))

    def test_one_number_means_one_value(self):
        values = {}
        for row in self.table:
            known = values.setdefault(row["MPN"], row["Value"])
            self.assertTrue(known == row["Value"] or row["References"].startswith("J"),
                            f"{row['MPN']}: {known} and {row['Value']}")


class NetlistFile(unittest.TestCase):
    def test_the_netlist_says_what_kicad_says(self):
        kicad = json.loads((OUTPUTS / "opms-box-kicad.json").read_text())["nets"]
        export = parse((OUTPUTS / "opms-box.net").read_text(encoding="utf-8"))
        own = {frozenset(f"{value(node, 'ref')}.{value(node, 'pin')}"
                         for node in children(net, "node"))
               for net in children(children(export, "nets")[0], "net")}
        self.assertEqual(own, {frozenset(pins) for pins in kicad.values()})


if __name__ == "__main__":
    unittest.main()
