# SPDX-License-Identifier: Apache-2.0
"""The taggers in a second, independent PIO emulator: numbers and times of edges."""
import random
import unittest

from pio_programs import START, TRIG, load, run

ALL_ONES = 0xFFFFFFFF
LAST = 8000  # cycles


def words(name, begin, edges, pin, first_x=ALL_ONES):
    states = run(load(name), begin=begin, cycles=edges[-1] + 100, edges=edges, pin=pin, set_pin=31,
                 registers={"x": first_x, "y": ALL_ONES})
    return [word for state in states for word in state.receive_fifo]


def edge_of(word, first_x=ALL_ONES):
    """What hal/edge_tagger.c makes of a word: the cycle at which the pad changed, at the latest."""
    return 2 * ((first_x - word) & ALL_ONES) - 5


class PulseTagger(unittest.TestCase):
    def test_two_machines_tell_the_cycle_of_every_edge_and_its_number(self):
        random.seed(7)
        edges = []
        at = 40
        while at < LAST:
            edges += [at, at + random.randrange(20, 90)]
            at = edges[-1] + random.randrange(20, 90)
        first = words("pulse_tagger", "begin", edges, TRIG)
        second = words("pulse_tagger", "skew", edges, TRIG)
        rises = edges[::2]
        self.assertEqual([~word & ALL_ONES for word in first[1::2]],
                         list(range(1, len(rises) + 1)))
        self.assertEqual(first[1::2], second[1::2])
        told = [min(edge_of(a), edge_of(b) + 1) for a, b in zip(first[::2], second[::2])]
        self.assertEqual(told, rises)

    def test_the_count_goes_on_over_its_wrap(self):
        for first_x in range(40):
            with self.subTest(first_x=first_x):
                edges = [41, 90, 141, 190]
                first = words("pulse_tagger", "begin", edges, TRIG, first_x)
                second = words("pulse_tagger", "skew", edges, TRIG, first_x)
                told = [min(edge_of(a, first_x), edge_of(b, first_x) + 1)
                        for a, b in zip(first[::2], second[::2])]
                self.assertEqual(told, [41, 141])


class LevelTagger(unittest.TestCase):
    def test_every_edge_is_told_to_two_cycles(self):
        random.seed(8)
        edges = [40]
        while edges[-1] < LAST:
            edges.append(edges[-1] + random.randrange(8, 300))
        told = [edge_of(word) for word in words("level_tagger", "begin", edges, START)]
        self.assertEqual(len(told), len(edges))
        self.assertLessEqual({late - true for late, true in zip(told, edges)}, {0, 1})

    def test_the_shortest_high_is_told_as_no_longer_than_4_cycles(self):
        for length in (2, 3, 4):
            told = [edge_of(word) for word in
                    words("level_tagger", "begin", [101, 101 + length], START)]
            self.assertEqual(len(told), 2)
            self.assertLessEqual(told[1] - told[0], 4)


if __name__ == "__main__":
    unittest.main()
