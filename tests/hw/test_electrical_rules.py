# SPDX-License-Identifier: Apache-2.0
"""The schematic keeps the electrical rules, and copies of it with one fault each do not."""
import unittest

from hw_kit import SCHEMATIC, BrokenCopy

from electrical_rules import problems
from read_schematic import read


class Box(unittest.TestCase):
    def test_the_schematic_keeps_every_rule(self):
        self.assertEqual(problems(read(SCHEMATIC)), [])


class Faults(unittest.TestCase):
    def assert_caught(self, box, words):
        found = problems(box.netlist())
        self.assertTrue(any(words in problem for problem in found), f"{words!r} not in {found}")

    def after_removing(self, reference, words):
        with BrokenCopy() as box:
            box.remove(reference)
            self.assert_caught(box, words)

    def test_a_copy_without_a_fault_passes(self):
        with BrokenCopy() as box:
            box.set_value("C12", "100n")
            self.assertEqual(problems(box.netlist()), [])

    def test_a_pin_left_open_is_caught(self):
        for reference, number in (("U4", "2"), ("R11", "1"), ("Q3", "1"), ("J2", "1")):
            with BrokenCopy() as box:
                box.cut_wires_at(reference, number)
                self.assert_caught(box, f"{reference}.{number} ")

    def test_a_missing_protection_of_any_connector_is_caught(self):
        for reference, words in (("D1", "J1.A4 "), ("U2", "J1.A6 "), ("D5", "J2.1 "),
                                 ("D8", "J6.1 "), ("D11", "J6.3 "), ("D15", "J3.1 "),
                                 ("D16", "J3.1 "), ("D17", "J4.1 "), ("D20", "J5.1 "),
                                 ("D22", "J7.1 "), ("D23", "J3.1 ")):
            self.after_removing(reference, f"{words}")
            self.after_removing(reference, "has no protection")

    def test_outputs_against_each_other_are_caught(self):
        with BrokenCopy() as box:
            box.join(("U5", "4"), ("U8", "4"))
            self.assert_caught(box, "outputs against each other: U5.4, U8.4")

    def test_paralleled_gates_without_their_resistors_are_caught(self):
        with BrokenCopy() as box:
            box.join(("U9", "18"), ("U9", "16"))
            self.assert_caught(box, "outputs against each other")

    def test_a_supply_that_nothing_feeds_is_caught(self):
        self.after_removing("#FLG", "+5V: nothing supplies")
        with BrokenCopy() as box:
            box.cut_wires_at("U3", "36")
            self.assert_caught(box, "+3V3: nothing supplies")

    def test_an_input_that_nothing_drives_is_caught(self):
        with BrokenCopy() as box:
            box.remove("JP3")
            box.join(("U5", "2"), ("U8", "2"))
            box.remove("U6")
            self.assert_caught(box, "nothing drives")

    def test_a_missing_pull_up_is_caught(self):
        self.after_removing("R15", "no pull-up for U7.6")

    def test_an_output_that_floats_at_reset_is_caught(self):
        self.after_removing("R22", "/TRIG: no pull-down")
        self.after_removing("R23", "/SYNC: no pull-down")

    def test_a_diode_the_wrong_way_round_is_caught(self):
        for reference in ("D7", "D14", "D16", "D20", "D23", "D3"):
            with BrokenCopy() as box:
                box.turn_round(reference)
                self.assert_caught(box, f"{reference}: its ")

    def test_swapped_pins_of_a_transistor_are_caught(self):
        for reference, axis, words in (("Q4", "x", "Q4: its source is at"),
                                       ("Q5", "x", "Q5: its source is at"),
                                       ("Q1", "y", "no partner, back to back")):
            with BrokenCopy() as box:
                box.mirror(reference, axis)
                self.assert_caught(box, words)
                self.assertFalse(any("not connected" in problem
                                     for problem in problems(box.netlist())), reference)

    def test_a_bridge_across_the_isolation_is_caught(self):
        with BrokenCopy() as box:
            box.set_value("R34", "10k")
            self.assert_caught(box, "J7.2 is not isolated from GND")
        with BrokenCopy() as box:
            box.join(("J6", "2"), ("J6", "4"))
            self.assert_caught(box, "J6.2 is not isolated from")

    def test_missing_decoupling_is_caught(self):
        for capacitors, words in ((("C12", "C13"), "+5V: "), (("C15", "C16"), "+3V3: ")):
            with BrokenCopy() as box:
                for reference in capacitors:
                    box.remove(reference)
                self.assert_caught(box, words)

    def test_a_mark_on_a_pin_that_is_connected_is_caught(self):
        with BrokenCopy() as box:
            box.join(("U3", "1"), ("U3", "2"))
            self.assert_caught(box, "U3.1 is marked as not connected, but is")


if __name__ == "__main__":
    unittest.main()
