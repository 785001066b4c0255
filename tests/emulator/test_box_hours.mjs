// SPDX-License-Identifier: Apache-2.0
/** START more than an hour after arming: every counter of the box has wrapped by then. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, SECOND } from './box_bench.mjs';
import { EVENT, STATE } from './wire_reports.mjs';

const WRAP_S = 2 ** 32 / 1e6; // of the timer's low word; the tags' own counters wrap each 69 s

test('a run across the wrap of the 32-bit microseconds, 71 minutes after arming', () => {
    const bench = new Bench();
    bench.applySettings({ periodUs: 50000 });
    bench.armAndWait();
    const [first] = bench.triggers(), offset = bench.timeOffset(first.time, bench.rises()[0]);
    bench.host.plug(false); // frames would cost the emulator the most
    const wrap = bench.timeZero + WRAP_S * SECOND;
    bench.board.runTo(Math.round(wrap - 5 * SECOND));
    bench.host.plug(true);
    bench.until(() => bench.host.device, 2000, 'the box to be back');
    const from = bench.reports.length, preamble = bench.rises().length;
    const edge = bench.start();
    assert.equal(bench.awaitEvent(EVENT.START, 1000, from).time - edge, offset);
    bench.run(8000);
    bench.disarm();
    const rises = bench.rises(), triggers = bench.triggers(from);
    assert.equal(rises[preamble] - edge, 129);
    assert.ok(rises[preamble] < wrap && rises[rises.length - 1] > wrap, 'on both sides');
    assert.deepEqual(triggers.map(({ number }) => number),
        rises.slice(preamble).map((_, index) => preamble + 1 + index));
    triggers.forEach(({ number, time }) => assert.equal(time - rises[number - 1], offset));
    assert.deepEqual(triggers[1].gapsUs[0], 50000);
    const status = bench.status();
    assert.equal(status.state, STATE.IDLE);
    assert.ok(status.uptimeUs > 2 ** 32);
    bench.assertClean();
});
