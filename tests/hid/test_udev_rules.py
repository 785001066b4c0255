# SPDX-License-Identifier: Apache-2.0
"""The udev rule file: the ids of the code, in the form that udev compares, at the right place."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RULES = next((ROOT / "libopms/hid/udev").glob("*.rules"))
WIRE_H = (ROOT / "libopms/include/opms/wire.h").read_text(encoding="utf-8")


def code_id(name):
    return re.search(rf"#define {name} 0x([0-9A-Fa-f]{{4}})", WIRE_H).group(1).lower()


class UdevRules(unittest.TestCase):
    def setUp(self):
        self.rules = [line for line in RULES.read_text(encoding="utf-8").splitlines()
                      if line and not line.startswith("#")]

    def test_the_file_sorts_before_the_one_that_acts_on_uaccess(self):
        self.assertLess(RULES.name, "73-seat-late.rules")

    def test_ids_are_those_of_the_code_in_lower_case(self):
        box = (code_id("OPMS_USB_VENDOR_ID"), code_id("OPMS_USB_PRODUCT_ID"))
        found = [re.findall(r'\{id(?:Vendor|Product)\}=="([^"]+)"', rule) for rule in self.rules]
        self.assertEqual([tuple(ids) for ids in found], [box, box, ("2e8a", "0003")])

    def test_every_rule_is_made_of_well_formed_pairs_and_gives_access(self):
        pair = r'[A-Z]+(?:\{\w+\})?(?:==|\+=)"[^"]*"'
        for rule in self.rules:
            self.assertRegex(rule, rf"^{pair}(?:, {pair})*$")
            self.assertTrue(rule.endswith('TAG+="uaccess"'), rule)

    def test_hidraw_and_usb_are_both_there(self):
        for subsystem in ("hidraw", "usb"):
            self.assertTrue(any(f'SUBSYSTEM=="{subsystem}"' in rule for rule in self.rules))


if __name__ == "__main__":
    unittest.main()
