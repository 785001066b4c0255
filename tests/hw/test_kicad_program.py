# SPDX-License-Identifier: Apache-2.0
"""Where there is a kicad-cli, its own rules and netlist of the very files; else this is skipped."""
import json
import unittest

from hw_kit import PROJECT

from kicad_program import KicadMissing, KicadProgram
from make_outputs import NAME, kicad_nets

try:
    KICAD = KicadProgram()
except KicadMissing as error:
    KICAD, REASON = None, str(error)
else:
    REASON = ""


@unittest.skipIf(KICAD is None, REASON)
class Kicad(unittest.TestCase):
    def test_its_electrical_rules_find_nothing(self):
        with KICAD.work_folder(PROJECT) as folder:
            KICAD.run(folder, "sch", "erc", "--exit-code-violations", f"{NAME}.kicad_sch")

    def test_its_netlist_is_the_one_that_is_committed(self):
        committed = json.loads((PROJECT / f"outputs/{NAME}-kicad.json").read_text())
        with KICAD.work_folder(PROJECT) as folder:
            found = kicad_nets(KICAD, folder)
        self.assertEqual({frozenset(pins) for pins in found["nets"].values()},
                         {frozenset(pins) for pins in committed["nets"].values()})
        self.assertEqual(found["parts"], committed["parts"])


if __name__ == "__main__":
    unittest.main()
