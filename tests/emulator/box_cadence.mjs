// SPDX-License-Identifier: Apache-2.0
/** A long run under some disturbance, and the judgement of it: every pulse to the cycle, every
 * number and time told, by report or from HISTORY. */
import assert from 'node:assert/strict';
import { Bench, MS, START_CYCLES, US } from './box_bench.mjs';
import { EVENT, FLAG } from './wire_reports.mjs';

const ON_TIME = 2 * MS + MS; // 2 ms, and the frame in which the host asks

/** @param disturb  generator of {run: ms} steps; ends when the run may. It gets the bench. */
export function runCadence({ periodUs, periods, disturb, seed = 1, settings = {} }) {
    const bench = new Bench({ seed });
    bench.applySettings({ periodUs, ...settings });
    bench.armAndWait();
    bench.trig.length = 0;
    const preamble = bench.triggers().length, edge = bench.start();
    const enough = () => bench.trig.length >= 2 * (periods + 1);
    const steps = disturb(bench), told = new Map();
    while (!enough()) {
        const { value, done } = steps.next();
        bench.run(done ? 1000 : value.run);
        fillGaps(bench, told);
    }
    bench.host.polls = true;
    bench.host.hammer = null;
    bench.until(() => bench.host.device !== null, 5000, 'the host to be there at the end');
    bench.disarm();
    bench.run(2000);
    assertPulses(bench, { edge, periodUs, periods });
    const filled = fillGaps(bench, told);
    return { bench, edge, preamble, filled, ...assertNumbers(bench, { preamble, edge, told }) };
}

/** What a host does about numbers that no report told: it asks HISTORY, soon enough.
 * @param told  time by number; grows. @returns how many HISTORY has told so far. */
function fillGaps(bench, told) {
    const triggers = bench.triggers();
    triggers.slice(told.taken ?? 0).forEach(({ number, time }) => told.set(number, time));
    told.taken = triggers.length;
    const missing = [];
    const last = triggers.length ? triggers[triggers.length - 1].number : 0;
    for (let number = (told.until ?? 0) + 1; number <= last; number++) {
        if (!told.has(number)) {
            missing.push(number);
        }
    }
    if (missing.length && bench.host.device && bench.host.polls) {
        const entries = bench.readHistory(missing[0], missing[missing.length - 1]);
        missing.filter((number) => !(entries.get(number).flags & FLAG.NOT_HELD))
            .forEach((number) => {
                told.set(number, entries.get(number).time);
                told.filled = (told.filled ?? 0) + 1;
            });
        told.until = last;
    } else if (!missing.length) {
        told.until = last;
    }
    return told.filled ?? 0;
}

function assertPulses(bench, { edge, periodUs, periods }) {
    const rises = bench.rises(), falls = bench.rises(0, 0);
    const { widthUs, debounceCycles } = bench.settings;
    assert.equal(rises[0] - edge, debounceCycles + START_CYCLES);
    assert.ok(rises.length > periods, `${rises.length} pulses`);
    assert.equal(falls.length, rises.length);
    for (let index = 0; index < rises.length; index++) {
        assert.equal(rises[index] - rises[0], index * periodUs * US, `pulse ${index}`);
        assert.equal(falls[index] - rises[index], widthUs * US, `width of pulse ${index}`);
    }
}

/** Each pulse of the run was told, by a report or by HISTORY, with its time at the one offset. */
function assertNumbers(bench, { preamble, edge, told }) {
    const rises = bench.rises(), triggers = bench.triggers();
    const offset = bench.timeOffset(told.get(preamble + 1), rises[0]);
    const last = preamble + rises.length;
    const [stop] = bench.events(EVENT.STOP).slice(-1);
    assert.equal(stop.argument, last, 'the number of the last pulse');
    rises.forEach((cycle, index) =>
        assert.equal(told.get(preamble + 1 + index) - cycle, offset, `pulse ${index}`));
    triggers.filter(({ flags }) => flags & FLAG.RUN).forEach(({ startEdge }) =>
        assert.equal(startEdge - edge, offset));
    const numbers = new Set(triggers.map(({ number }) => number));
    assert.equal(numbers.size, triggers.length, 'no report comes twice');
    const status = bench.status();
    assert.equal(status.dropped, 0);
    assert.equal(triggers[triggers.length - 1].dropped, 0);
    bench.assertClean();
    return { triggers, status, missing: last - numbers.size };
}

/** Reports that came later than 2 ms after their pulse, by the host's own clock. */
export function lateReports(bench, preamble, rises) {
    return bench.triggers().filter(({ number, cycle }) =>
        number > preamble && cycle - rises[number - preamble - 1] > ON_TIME);
}
