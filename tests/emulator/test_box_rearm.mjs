// SPDX-License-Identifier: Apache-2.0
/** Stop and re-arm 1,000 times: each session whole, none touched by the one before. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, MS, START_CYCLES } from './box_bench.mjs';
import { randomGenerator } from './small_blocks.mjs';
import { EVENT, FLAG, STATE } from './wire_reports.mjs';

const SESSIONS = 1000;

/** One session: arm, perhaps START, some time, disarm. Judged by the pulses that left. */
function session(bench, random, offsets) {
    const { widthUs, periodUs, preambleMs } = bench.settings;
    const from = bench.reports.length, preamble = preambleMs.length ? preambleMs.length + 1 : 0;
    bench.trig.length = 0;
    const hasStart = random() % 8 !== 0;
    if (hasStart) {
        bench.armAndWait();
    } else {
        bench.arm();
    }
    const edge = hasStart ? bench.start({ delay: 100 + (random() % MS) }) : 0;
    bench.run(1 + (random() % 400) / 10);
    bench.disarm();
    const rises = bench.rises(), falls = bench.rises(0, 0);
    bench.run(12);
    assert.deepEqual(bench.rises(), rises, 'no pulse after the STOP');
    assert.equal(falls.length, rises.length);
    falls.forEach((cycle, index) => {
        const whole = rises[index] + widthUs * 125;
        // START ends the preamble's last pulse, so that the run's first one has an edge.
        const isCut = hasStart && index === preamble - 1 && whole >= edge;
        assert.ok(isCut ? cycle >= edge && cycle < rises[preamble] : cycle === whole, 'whole');
    });
    if (hasStart) {
        assert.equal(rises[preamble] - edge, bench.settings.debounceCycles + START_CYCLES);
        rises.slice(preamble).forEach((cycle, index) =>
            assert.equal(cycle - rises[preamble], index * periodUs * 125));
    }
    const triggers = bench.triggers(from);
    assert.deepEqual(triggers.map(({ number }) => number), rises.map((_, index) => index + 1));
    triggers.forEach(({ time, number, session: id, flags }) => {
        assert.equal(id, bench.session);
        assert.equal(flags, number > preamble ? FLAG.RUN : FLAG.PREAMBLE);
        offsets.add(time - rises[number - 1]);
    });
    const [stop] = bench.events(EVENT.STOP).slice(-1);
    assert.deepEqual([stop.argument, stop.state, stop.session],
        [rises.length, STATE.IDLE, bench.session]);
    return { hasStart, pulses: rises.length };
}

test(`${SESSIONS} sessions, stopped at any moment, keep numbers, times and widths`, () => {
    const bench = new Bench(), random = randomGenerator(1000), offsets = new Set();
    let starts = 0, pulses = 0;
    for (let count = 0; count < SESSIONS; count++) {
        if (count % 100 === 0) {
            bench.applySettings({ periodUs: 10000, widthUs: [10, 1000, 8500][count / 100 % 3],
                preambleMs: count % 200 ? [] : [10, 15] });
        }
        const result = session(bench, random, offsets);
        starts += result.hasStart ? 1 : 0;
        pulses += result.pulses;
    }
    assert.equal(offsets.size, 1, 'one offset of time over all sessions');
    assert.ok(starts > 800 && pulses > 2000, `${starts} starts, ${pulses} pulses`);
    const status = bench.status();
    assert.deepEqual([status.dropped, status.startsRefused, status.glitches, status.state],
        [0, 0, 0, STATE.IDLE]);
    bench.assertClean();
});
