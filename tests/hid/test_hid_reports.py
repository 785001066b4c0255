# SPDX-License-Identifier: Apache-2.0
"""What becomes of reports: delivered in order, numbered off, gaps filled, bad ones counted."""
import unittest

import box_wire as wire
from hid_kit import ITEMS, REPORTS, TRIGGERS, UNFILLED, HidTest

NOT_HELD = wire.NOT_HELD_FLAG


class Reports(HidTest):
    def test_reports_come_out_in_order_with_times_that_never_go_back(self):
        probe = self.armed()
        for number in range(1, 201):
            self.box.trigger(number)
        probe.wait_item("trigger", number=200)
        triggers = probe.items("trigger")
        self.assertEqual([t["number"] for t in triggers], list(range(1, 201)))
        self.assertEqual([t["time_ns"] for t in triggers], [n * 10**8 for n in range(1, 201)])
        times = [t["t"] for t in triggers]
        self.assertEqual(times, sorted(times))
        self.assertEqual(probe.items("lost"), [])

    def test_lost_pulses_are_fetched_from_history(self):
        probe = self.armed()
        for number in range(1, 30):
            self.box.trigger(number, told=number not in (2, 5, 6, 7, 20))
        filled = [probe.wait_item("history") for _ in range(5)]
        self.assertEqual([f["number"] for f in filled], [2, 5, 6, 7, 20])
        self.assertEqual([f["time_ns"] for f in filled],
                         [n * 10**8 for n in (2, 5, 6, 7, 20)])
        self.assertEqual({f["session"] for f in filled}, {7})
        told = [(i["what"], i["first"], i["count"]) for i in probe.items("lost")]
        self.assertEqual([t for t in told if t[0] == TRIGGERS],
                         [(TRIGGERS, 2, 1), (TRIGGERS, 5, 3), (TRIGGERS, 20, 1)])
        counters = probe.ask("counters")
        self.assertEqual((counters["missed"], counters["filled"], counters["unfilled"]), (5, 5, 0))
        self.assertEqual(counters["reports_lost"], 5)

    def test_the_first_pulse_of_a_session_that_was_armed_here_counts(self):
        probe = self.armed()
        self.box.trigger(1, told=False)
        self.box.trigger(2)
        self.assertEqual(probe.wait_item("history")["number"], 1)

    def test_pulses_before_we_came_are_not_asked_for(self):
        self.box.session, self.box.state, self.box.number = 9, wire.RUNNING, 500
        probe = self.open()
        self.box.trigger(501)
        self.box.trigger(502)
        probe.wait_item("trigger", number=502)
        self.assertEqual(probe.ask("counters")["missed"], 0)

    def test_the_last_pulses_of_a_run_are_missed_by_the_status_after_the_next(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.trigger(2, told=False)
        self.box.trigger(3, told=False)
        self.box.status()
        probe.wait_item("status")
        self.assertEqual([i for i in probe.items("lost") if i["what"] == TRIGGERS], [],
                         "their reports may be on the way still")
        self.box.status()
        self.assertEqual([probe.wait_item("history")["number"] for _ in range(2)], [2, 3])

    def test_a_stop_announces_the_last_pulse(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.trigger(2, told=False)
        self.assertEqual(probe.ask("disarm")["status"], "OPMS_OK")
        self.box.number = 0
        self.box.status()
        self.assertEqual(probe.wait_item("history")["number"], 2)

    def test_a_pulse_that_comes_twice_is_delivered_twice_and_counted(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.report_number -= 1
        self.box.trigger(1)
        self.box.trigger(2)
        probe.wait_item("trigger", number=2)
        self.assertEqual([t["number"] for t in probe.items("trigger")], [1, 1, 2])
        self.assertEqual(probe.ask("counters")["repeated"], 1)

    def test_numbers_wrap_without_a_gap_and_gaps_over_the_wrap_are_filled(self):
        self.box.session, self.box.state = 9, wire.RUNNING
        self.box.report_number = 0xFFFFFFFD
        probe = self.open()
        self.box.pulses[0xFFFFFFFF] = (77_000, wire.RUN_FLAG)
        self.box.trigger(0xFFFFFFFE)
        self.box.next_report()
        self.box.trigger(0)
        self.box.trigger(1)
        self.assertEqual(probe.wait_item("history")["number"], 0xFFFFFFFF)
        counters = probe.ask("counters")
        self.assertEqual((counters["missed"], counters["filled"]), (1, 1))
        self.assertEqual((counters["reports_lost"], counters["repeated"]), (1, 0))

    def test_what_the_box_holds_no_more_is_told_as_such(self):
        probe = self.armed()
        self.box.trigger(1)
        self.box.trigger(2, told=False)
        self.box.trigger(3, told=False)
        del self.box.pulses[2]
        self.box.trigger(4)
        entries = [probe.wait_item("history") for _ in range(2)]
        self.assertEqual([(e["number"], e["flags"]) for e in entries],
                         [(2, NOT_HELD), (3, wire.RUN_FLAG)])
        counters = probe.ask("counters")
        self.assertEqual((counters["filled"], counters["unfilled"]), (1, 1))

    def test_a_gap_larger_than_the_box_s_memory_is_filled_from_its_newest_part(self):
        probe = self.armed()
        self.box.trigger(1)
        for number in range(9000, 9012):
            self.box.pulses[number] = (number * 10**8, wire.RUN_FLAG)
        self.box.number = 9011
        self.box.trigger(9012)
        lost = probe.wait_item("lost", what=UNFILLED)
        self.assertEqual((lost["first"], lost["count"]), (2, 9010 - 8192))
        self.assertEqual(probe.wait_item("history")["number"], 2 + 9010 - 8192)

    def test_answers_of_history_that_get_lost_are_asked_for_again(self):
        probe = self.armed()
        self.box.lose_history = 2
        self.box.trigger(1)
        for number in range(2, 7):
            self.box.trigger(number, told=False)
        self.box.trigger(7)
        self.assertEqual([probe.wait_item("history")["number"] for _ in range(5)],
                         [2, 3, 4, 5, 6])

    def test_another_hand_at_history_is_noticed_by_its_token(self):
        probe = self.armed()
        gets = []

        def steal(answer):
            gets.append(answer)
            if len(gets) == 2:  # somebody else selects, and gets in between
                return wire.history(self.box.boot, 0x7777, 7, 0, [(99, 99_000, wire.RUN_FLAG)])
            return answer
        self.box.garble[wire.HISTORY] = steal
        self.box.trigger(1)
        for number in range(2, 8):
            self.box.trigger(number, told=False)
        self.box.trigger(8)
        numbers = [probe.wait_item("history")["number"] for _ in range(6)]
        self.assertEqual(numbers, [2, 3, 4, 5, 6, 7])

    def test_a_history_that_never_answers_is_given_up_and_told(self):
        probe = self.armed()
        self.box.stalls.add(wire.HISTORY)
        self.box.trigger(1)
        self.box.trigger(2, told=False)
        self.box.trigger(3)
        lost = probe.wait_item("lost", what=UNFILLED)
        self.assertEqual((lost["first"], lost["count"]), (2, 1))
        self.box.trigger(4)
        probe.wait_item("trigger", number=4)

    def test_gaps_are_left_alone_where_that_is_wanted(self):
        probe = self.armed("fill=0")
        self.box.trigger(1)
        self.box.trigger(2, told=False)
        self.box.trigger(3)
        probe.wait_item("trigger", number=3)
        self.assertEqual(probe.ask("ping")["status"], "OPMS_OK")
        self.assertEqual((probe.ask("counters")["missed"], self.box.history_gets), (1, 0))


class Malformed(HidTest):
    def test_every_fault_is_counted_by_its_kind_and_told(self):
        probe = self.armed()
        good = wire.status(self.box.boot, 7, 100)
        faults = [(good[:63], 1), (good + b"\0", 1), (b"", 1), (good[:1], 1), (good * 4, 1),
                  (wire.seal(0x7F, {}), 2), (b"\0" * 64, 2),
                  (wire.identity(self.box.boot, self.box.unique_id), 2),
                  (wire.seal(wire.STATUS, {4: b"\1"}, version=2), 3),
                  (good[:10] + bytes([good[10] ^ 1]) + good[11:], 4),
                  (wire.seal(wire.STATUS, {2: b"\x09", 4: b"\1"}), 5)]
        for data, _ in faults:
            self.box.report(data)
        told = [probe.wait_item("malformed") for _ in faults]
        self.assertEqual([t["result"] for t in told], [kind for _, kind in faults])
        self.assertEqual([t["size"] for t in told], [len(data) for data, _ in faults])
        self.assertEqual(probe.ask("counters")["malformed"], [0, 5, 3, 1, 1, 1])
        self.box.trigger(1)
        probe.wait_item("trigger", number=1)

    def test_every_single_flipped_bit_of_a_report_is_found(self):
        probe = self.armed()
        good = wire.trigger(self.box.boot, 7, 100, 1, 10**9)
        for bit in range(512):
            data = bytearray(good)
            data[bit // 8] ^= 1 << bit % 8
            self.box.report(bytes(data))
        self.box.trigger(1)
        probe.wait_item("trigger", number=1)
        self.assertEqual(sum(probe.ask("counters")["malformed"]), 512)


class Queue(HidTest):
    def test_a_full_queue_loses_the_newest_and_says_how_many_where(self):
        probe = self.armed("queue=16", "poll=0")
        while not any(e["kind"] == wire.EVENT_ARMED for e in probe.items("event")):
            probe.ask("poll")  # else it takes a place
        for number in range(1, 41):
            self.box.trigger(number)
        while probe.ask("counters")["items_lost"] < 24:
            pass
        probe.ask("poll")
        self.assertEqual([t["number"] for t in probe.items("trigger")], list(range(1, 17)))
        lost = probe.items("lost")[-1]
        self.assertEqual((lost["what"], lost["count"]), (ITEMS, 24))
        self.box.trigger(41)
        while probe.items("trigger")[-1]["number"] < 41:
            probe.ask("poll")
        self.assertEqual(probe.ask("counters")["items_lost"], 24)

    def test_a_callback_gets_the_same_items(self):
        probe = self.armed("callback=1", "poll=0")
        for number in range(1, 11):
            self.box.trigger(number, told=number != 4)
        self.assertEqual(probe.wait_item("history")["number"], 4)
        self.assertEqual([t["number"] for t in probe.items("trigger")][:3], [1, 2, 3])
        self.assertEqual([i["count"] for i in probe.items("lost") if i["what"] == REPORTS], [1])


if __name__ == "__main__":
    unittest.main()
