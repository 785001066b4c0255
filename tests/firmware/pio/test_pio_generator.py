# SPDX-License-Identifier: Apache-2.0
"""Pulse generator, preamble and sync output in a second, independent PIO emulator."""
import unittest

from pio_programs import START, SYNCHRONISER, TRIG, debounced, edges_of, load, run

WIDTH, PERIOD = 1250, 4001
START_CYCLES = 4
EDGE = 301  # of START, in cycles since the machine began


def pulses(debounce, edges, cycles=None):
    program, looks = debounced(load("generator"), debounce)
    states = run(program, begin="begin", edges=edges, pin=START, side_pin=TRIG,
                 cycles=cycles or edges[-1] + debounce + 40,
                 registers={"x": looks, "y": looks, "isr": WIDTH - 4,
                            "osr": PERIOD - WIDTH - 4})
    return edges_of(states, TRIG)


class Generator(unittest.TestCase):
    def test_first_pulse_leaves_the_debounce_and_4_cycles_after_the_edge(self):
        for debounce in (*range(13), 99, 100, 125, 126, 1000, 4321):
            for edge in (EDGE, EDGE + 1):
                with self.subTest(debounce=debounce, edge=edge):
                    # START falls as soon as it may.
                    found = pulses(debounce, [edge, edge + max(debounce, 1)])
                    self.assertEqual(found[0], (edge + debounce + START_CYCLES, 1))

    def test_every_period_and_every_width_is_exact(self):
        found = pulses(125, [EDGE, EDGE + 10 * PERIOD], cycles=EDGE + 10 * PERIOD)
        first = EDGE + 125 + START_CYCLES
        expected = []
        for number in range(10):
            expected += [(first + number * PERIOD, 1), (first + number * PERIOD + WIDTH, 0)]
        self.assertEqual(found, [edge for edge in expected if edge[0] < EDGE + 10 * PERIOD])

    def test_a_high_that_is_one_cycle_too_short_makes_no_pulse(self):
        for debounce in (*range(3, 13), 99, 100, 125, 126, 1000):
            for edge in (EDGE, EDGE + 1):
                with self.subTest(debounce=debounce, edge=edge):
                    self.assertEqual(pulses(debounce, [edge, edge + debounce - 1]), [])

    def test_a_start_after_a_glitch_is_on_time(self):
        for low in (3, 4, 5, 50):
            with self.subTest(low=low):
                again = EDGE + 60 + low
                found = pulses(125, [EDGE, EDGE + 60, again, again + 200])
                self.assertEqual(found[0], (again + 125 + START_CYCLES, 1))

    def test_a_start_that_is_high_already_is_no_edge(self):
        again = EDGE + 1000
        found = pulses(125, [-SYNCHRONISER, EDGE, again, again + 200])
        self.assertEqual(found[0], (again + 125 + START_CYCLES, 1))


class Preamble(unittest.TestCase):
    def test_gaps_are_exact_and_the_last_pulse_is_followed_by_none(self):
        gaps = [3000, 6001, 3000, 9000]
        states = run(load("preamble"), begin="begin", cycles=60000, edges=[], pin=START,
                     registers={"isr": WIDTH - 4, "fifo": [gap - WIDTH - 7 for gap in gaps]})
        found = edges_of(states, TRIG)
        rises = [cycle for cycle, level in found if level]
        falls = [cycle for cycle, level in found if not level]
        self.assertEqual([b - a for a, b in zip(rises, rises[1:])], gaps)
        self.assertEqual([b - a for a, b in zip(rises, falls)], [WIDTH] * 5)


    def test_no_pulse_begins_while_start_is_high(self):
        states = run(load("preamble"), begin="begin", cycles=20000, edges=[2900, 3300, 6000],
                     pin=START, registers={"isr": WIDTH - 4, "fifo": [3000 - WIDTH - 7] * 3})
        rises = [cycle for cycle, level in edges_of(states, TRIG) if level]
        # The second pulse waits for the glitch's end, the third for ever: the run has begun.
        self.assertEqual(len(rises), 2)
        self.assertEqual(rises[1], 3300 + SYNCHRONISER + 3)


class Sync(unittest.TestCase):
    def test_width_and_period_are_exact(self):
        states = run(load("sync"), begin="begin", cycles=3 * PERIOD, edges=[], pin=START,
                     registers={"isr": WIDTH - 3, "osr": PERIOD - WIDTH - 3})
        found = edges_of(states, TRIG)
        first = found[0][0]
        self.assertEqual(found[:4], [(first, 1), (first + WIDTH, 0), (first + PERIOD, 1),
                                     (first + PERIOD + WIDTH, 0)])


if __name__ == "__main__":
    unittest.main()
