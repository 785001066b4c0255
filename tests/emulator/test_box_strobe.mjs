// SPDX-License-Identifier: Apache-2.0
/** The camera's exposure: measured, told with the pulse that it followed, missed when it fails. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, MS, US, pins } from './box_bench.mjs';
import { randomGenerator } from './small_blocks.mjs';
import { EVENT, FLAG } from './wire_reports.mjs';

const LOOK = 2; // STROBE is looked at every second cycle

/** A camera on the board: after each pulse an exposure, unless `fails` says no. */
function camera(bench, { delay, length, fails = () => false, active = 1 }) {
    const exposures = new Map();
    let number = 0;
    bench.board.listeners.push((pin, level, cycle) => {
        if (pin !== pins.TRIG || level !== 1) {
            return;
        }
        number++;
        if (!fails(number)) {
            const start = delay(number), lasts = length(number);
            bench.board.at(cycle + start, () => bench.board.drive(pins.STROBE, active));
            bench.board.at(cycle + start + lasts, () =>
                bench.board.drive(pins.STROBE, active ? 0 : 1));
            exposures.set(number, { start, lasts });
        }
    });
    return exposures;
}

function assertExposure({ strobeDelay, strobeLength }, { start, lasts }, number) {
    assert.ok(Math.abs(strobeDelay - start) <= LOOK, `${number}: ${strobeDelay} for ${start}`);
    assert.ok(Math.abs(strobeLength - lasts) <= LOOK, `${number}: ${strobeLength} for ${lasts}`);
}

for (const strobeActiveLow of [false, true]) {
    test(`each exposure is told with its pulse, ${strobeActiveLow ? 'active low' : 'high'}`, () => {
        const bench = new Bench(), random = randomGenerator(3), active = strobeActiveLow ? 0 : 1;
        bench.board.drive(pins.STROBE, 1 - active);
        bench.applySettings({ periodUs: 20000, strobeEnabled: true, strobeActiveLow,
            preambleMs: [20, 40] });
        const exposures = camera(bench, { active, delay: () => 30 + (random() % (2 * MS)),
            length: () => 10 * US + (random() % (10 * MS)) });
        bench.armAndWait();
        bench.run(15); // the preamble's last exposure ends before the run's first begins
        bench.start();
        bench.run(1990);
        bench.disarm();
        bench.run(200);
        const told = new Set();
        for (const trigger of bench.triggers()) {
            const { flags, strobeFor, number } = trigger;
            assert.ok(strobeFor <= number);
            if (flags & FLAG.STROBE) {
                assertExposure(trigger, exposures.get(strobeFor), strobeFor);
                assert.ok(number - strobeFor <= 2, 'not an old one while newer ones come');
                told.add(strobeFor);
            }
            assert.equal(flags & FLAG.STROBE_MISSING, 0);
        }
        const last = Math.max(...exposures.keys());
        assert.ok(told.size >= last - 2, `${told.size} of ${last}`);
        const history = bench.readHistory(1, last);
        for (let number = 1; number <= last; number++) {
            const entry = history.get(number);
            assert.ok(entry.flags & FLAG.STROBE, `pulse ${number} in HISTORY`);
            assertExposure(entry, exposures.get(number), number);
        }
        assert.equal(bench.status().strobesMissing, 0);
        assert.equal(bench.events(EVENT.STROBE_MISSING).length, 0);
        bench.assertClean();
    });
}

test('an exposure that fails is told missing, and no other pulse gets its neighbour\'s', () => {
    const bench = new Bench(), failing = new Set([4, 9, 10, 11, 20]);
    bench.applySettings({ periodUs: 20000, strobeEnabled: true, preambleMs: [] });
    const exposures = camera(bench, { delay: (number) => 5000 + number,
        length: (number) => 100000 + 10 * number, fails: (number) => failing.has(number) });
    bench.armAndWait();
    bench.start();
    bench.run(610);
    bench.disarm();
    bench.run(300);
    const last = bench.rises().length, history = bench.readHistory(1, last);
    for (let number = 1; number <= last; number++) {
        const { flags } = history.get(number);
        if (failing.has(number)) {
            assert.equal(flags & FLAG.STROBE, 0, `${number}`);
        } else {
            assertExposure(history.get(number), exposures.get(number), number);
        }
    }
    assert.deepEqual(bench.events(EVENT.STROBE_MISSING).map(({ argument }) => argument),
        [...failing]);
    assert.equal(bench.status().strobesMissing, failing.size);
    assert.ok(bench.triggers().some(({ flags }) => flags & FLAG.STROBE_MISSING));
    bench.assertClean();
});

test('an exposure that is still going on at the next pulse belongs to the one before', () => {
    const bench = new Bench();
    bench.applySettings({ periodUs: 10000, strobeEnabled: true, preambleMs: [] });
    const exposures = camera(bench, { delay: () => 3 * MS, length: () => 9 * MS,
        fails: (number) => number % 2 === 0 });
    bench.armAndWait();
    bench.start();
    bench.run(300);
    bench.disarm();
    bench.run(100);
    const history = bench.readHistory(1, bench.rises().length - 2);
    for (const [number, entry] of history) {
        if (number % 2) {
            assertExposure(entry, exposures.get(number), number);
        } else {
            assert.equal(entry.flags & FLAG.STROBE, 0);
        }
    }
    bench.assertClean();
});

test('without a strobe wired nothing is expected, and noise on its line does no harm', () => {
    const bench = new Bench(), random = randomGenerator(8);
    bench.applySettings({ periodUs: 10000, strobeEnabled: false, preambleMs: [] });
    bench.armAndWait();
    const edge = bench.start();
    for (let burst = 0; burst < 200; burst++) {
        bench.pulseIn(pins.STROBE, 2 + (random() % 500), { delay: 10 + (random() % 2000) });
        bench.run(1);
    }
    const rises = bench.rises();
    assert.equal(rises[0] - edge, 129);
    rises.slice(1).forEach((cycle, index) => assert.equal(cycle - rises[index], 10 * MS));
    assert.equal(bench.status().strobesMissing, 0);
    assert.ok(bench.triggers().every(({ flags }) => flags === FLAG.RUN));
    bench.assertClean();
});
