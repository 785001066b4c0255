# SPDX-License-Identifier: Apache-2.0
"""The ngspice decks keep their limits, the document shows them, and worse parts are seen."""
import re
import unittest

from hw_kit import PROJECT, ROOT, SCHEMATIC

import run_decks
from read_schematic import read

DOCUMENT = ROOT / "docs/box-simulation.md"
FIRMWARE_DOCUMENT = ROOT / "docs/firmware.md"


def with_value(reference, value):
    netlist = read(SCHEMATIC)
    netlist.parts[reference].value = value
    return netlist


class Decks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.results = run_decks.run_all()

    def test_every_figure_keeps_its_limit(self):
        missed = [f"{result.limit.what}: {result.value:.4g} ({result.corner})"
                  for result in self.results if not result.holds]
        self.assertEqual(missed, [])

    def test_every_deck_has_a_limit(self):
        self.assertEqual({path.stem for path in run_decks.DECKS.glob("*.cir")},
                         {result.limit.deck for result in self.results})

    def test_every_corner_counts_for_a_limit(self):
        for path in run_decks.DECKS.glob("*.cir"):
            limits = [limit for limit in run_decks.read_limits() if limit.deck == path.stem]
            for corner in run_decks.corners(path.read_text(encoding="utf-8")):
                self.assertTrue(any(re.fullmatch(limit.corners, corner) for limit in limits),
                                f"{path.stem} {corner}")

    def test_the_document_shows_these_figures(self):
        text = DOCUMENT.read_text(encoding="utf-8")
        shown = text.split(run_decks.MARKS[0])[1].split(run_decks.MARKS[1])[0]
        rows = [row for row in shown.strip().splitlines()[2:]]
        self.assertEqual(len(rows), len(self.results))
        for row, result in zip(rows, self.results):
            cells = [cell.strip() for cell in row.strip("|").split("|")]
            self.assertEqual(cells[0], result.limit.what)
            self.assertIn(run_decks.shown(result.limit.limit, result.limit.unit), cells[1])
            # Another version of ngspice takes other steps: a hundredth, or what the unit shows.
            value = float(cells[2].split()[0]) / run_decks.SCALES[result.limit.unit]
            self.assertAlmostEqual(value, result.value,
                                   delta=0.03 * max(abs(result.limit.limit), abs(result.value)))

    def test_the_stated_delay_of_start_is_the_limits_of_the_deck(self):
        found = re.search(r"START's path through the box \| (\d+) to (\d+) ns",
                          FIRMWARE_DOCUMENT.read_text(encoding="utf-8"))
        self.assertIsNotNone(found)
        limits = {limit.worst: limit.limit for limit in run_decks.read_limits()
                  if limit.deck == "start_delay" and limit.corners == ".*"}
        self.assertEqual([float(digits) for digits in found.groups()],
                         [round(limits["min"] * 1e9, 6), round(limits["max"] * 1e9, 6)])


class WorseParts(unittest.TestCase):
    """With a wrong value in the schematic the decks must fail: they do follow it."""

    def assert_missed(self, deck, reference, value, words):
        results = run_decks.run_all(deck, with_value(reference, value))
        missed = [result.limit.what for result in results if not result.holds]
        self.assertTrue(any(words in what for what in missed), missed)

    def test_a_small_series_resistor_gets_too_hot(self):
        self.assert_missed("input_survival", "R11", "470", "heat in R11")

    def test_another_divider_shifts_the_threshold_of_12_and_24_v(self):
        self.assert_missed("start_threshold", "R12", "1k", "12/24 V: high is seen from")

    def test_a_large_capacitor_makes_start_late(self):
        self.assert_missed("start_delay", "C8", "1n", "the longest")

    def test_large_resistors_make_trig_too_low_for_a_terminated_cable(self):
        self.assert_missed("trig_line", "R24", "470", "50 ohm: high")

    def test_what_never_happens_is_missed(self):
        self.assert_missed("start_delay", "R12", "100", "the longest")

    def test_another_divider_lets_overvoltage_through(self):
        self.assert_missed("supply_fault", "R6", "33k", "highest at +5V")

    def test_a_value_that_cannot_be_read_is_an_error(self):
        with self.assertRaisesRegex(run_decks.DeckError, "R11: cannot read"):
            run_decks.run_all("start_delay", with_value("R11", "4k7"))

    def test_a_figure_that_is_missing_is_an_error(self):
        limit = run_decks.read_limits()[0]
        with self.assertRaisesRegex(run_decks.DeckError, "no on_v"):
            run_decks.judge(limit, {"ttl_typical": {"other": 1.0}})

    def test_a_deck_that_does_not_run_is_an_error(self):
        text = (PROJECT / "spice/start_delay.cir").read_text(encoding="utf-8")
        parts = run_decks.part_parameters(read(SCHEMATIC))
        with self.assertRaises(run_decks.DeckError):
            run_decks.run_corner(text.replace("{R11}", "{R99}"), {"level": "5"}, parts)


if __name__ == "__main__":
    unittest.main()
