# SPDX-License-Identifier: Apache-2.0
"""The firmware's pins are the schematic's, and a difference would be seen."""
import unittest

from hw_kit import SCHEMATIC, BrokenCopy

from board_pins import HEADER, header_pins, problems
from read_schematic import read


class Pins(unittest.TestCase):
    def setUp(self):
        self.header = HEADER.read_text(encoding="utf-8")

    def test_firmware_and_schematic_agree(self):
        self.assertEqual(list(problems(self.header, read(SCHEMATIC))), [])

    def test_all_five_lines_are_found_in_the_header(self):
        self.assertEqual(sorted(header_pins(self.header)),
                         ["LED", "START", "STROBE", "SYNC", "TRIG"])

    def test_swapped_pins_of_the_pico_are_caught(self):
        for first, second in (("START", "STROBE"), ("TRIG", "SYNC")):
            with BrokenCopy() as box:
                box.swap_labels(first, second)
                found = "\n".join(problems(self.header, box.netlist()))
                self.assertIn(f"{first}: GPIO", found)
                self.assertIn(f"{second}: GPIO", found)

    def test_a_line_that_is_not_wired_is_caught(self):
        with BrokenCopy() as box:
            box.cut_wires_at("U3", "5")
            self.assertIn("TRIG: GPIO 3 is not connected in the schematic",
                          list(problems(self.header, box.netlist())))

    def test_another_number_in_the_header_is_caught(self):
        changed = self.header.replace("PIN_TRIG 3U", "PIN_TRIG 6U")
        self.assertNotEqual(changed, self.header)
        found = list(problems(changed, read(SCHEMATIC)))
        self.assertIn("TRIG: GPIO 6 is not connected in the schematic", found)
        self.assertIn("GPIO 3 is on /TRIG in the schematic, unknown to the firmware", found)

    def test_a_header_without_pins_is_caught(self):
        self.assertIn("the header defines no pins", list(problems("", read(SCHEMATIC))))


if __name__ == "__main__":
    unittest.main()
