// SPDX-License-Identifier: Apache-2.0
/** From START's edge to the first pulse: the debounce to the cycle, glitches, START in each state,
 * the preamble, polarities, SYNC. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, LONG, MS, SECOND, START_CYCLES, US, pins } from './box_bench.mjs';
import { randomGenerator } from './small_blocks.mjs';
import { EVENT, FLAG, OPCODE, STATE } from './wire_reports.mjs';
import { command } from './wire_requests.mjs';

const LOOK = 2, SHORTEST = 4; // the level tagger looks every second cycle, for 4 at least

function assertLength(told, length) {
    assert.ok(Math.abs(told - Math.max(length, SHORTEST)) <= LOOK, `${told} for ${length} cycles`);
}

/** Start a run and check its first pulse. @returns the cycle of START's edge. */
function startAndCheck(bench, options = {}) {
    const from = bench.reports.length, before = bench.rises().length;
    const edge = bench.start(options);
    const event = bench.awaitEvent(EVENT.START, 1000, from);
    const debounce = bench.settings.debounceCycles;
    const [first] = bench.rises(0, options.trigActive ?? 1).slice(-bench.rises().length + before);
    assert.equal(first - edge, debounce + START_CYCLES, `debounce of ${debounce} cycles`);
    bench.until(() => bench.triggers(from).length > 0, 100, 'the first TRIGGER');
    const [trigger] = bench.triggers(from).filter(({ flags }) => flags & FLAG.RUN);
    const offset = bench.timeOffset(trigger.time, first);
    assert.equal(trigger.startEdge - edge, offset, 'the time of START\'s edge');
    assert.equal(event.time, trigger.startEdge);
    assert.equal(event.argument, trigger.firstRunNumber);
    assert.equal(trigger.number, trigger.firstRunNumber);
    return edge;
}

const debounces = [0, 1, 2, 3, 4, 5, 6, 7, 124, 125, 126, 12500, 12501, 1249999, 1250000];
const random = randomGenerator(20261122);
const extra = Array.from({ length: LONG ? 300 : 10 }, () => random() % 1250001);

test('the first pulse leaves the debounce and 4 cycles after START, from 0 to 10 ms', () => {
    const bench = new Bench();
    for (const debounceCycles of [...debounces, ...extra]) {
        bench.applySettings({ debounceCycles, preambleMs: [] });
        bench.armAndWait();
        startAndCheck(bench, { delay: 1000 + (random() % MS), length: debounceCycles + 2000 });
        bench.disarm();
    }
    bench.assertClean();
});

test('a high of exactly the debounce starts, one cycle less does not', () => {
    const bench = new Bench();
    for (const debounceCycles of [3, 4, 5, 8, 9, 125, 126, 12500, 12501, 1250000]) {
        bench.applySettings({ debounceCycles, preambleMs: [] });
        bench.armAndWait();
        for (const phase of [0, 1]) {
            const pulses = bench.trig.length, from = bench.reports.length;
            const edge = bench.pulseIn(pins.START, debounceCycles - 1, { delay: 5000 + phase });
            const glitch = bench.awaitEvent(EVENT.GLITCH, 1000, from);
            assert.equal(bench.trig.length, pulses, `debounce ${debounceCycles}: no pulse`);
            assertLength(glitch.argument, debounceCycles - 1);
            assert.ok(Math.abs(glitch.time + bench.timeZero - edge) <= US + LOOK);
        }
        startAndCheck(bench, { length: debounceCycles });
        bench.disarm();
    }
    bench.assertClean();
});

test('glitches of all lengths are rejected and told, and a bouncing START starts once', () => {
    const bench = new Bench(), from = bench.reports.length;
    bench.applySettings({ debounceCycles: 1250, preambleMs: [] });
    bench.armAndWait();
    const lengths = Array.from({ length: 60 }, () => 2 + (random() % 1248));
    for (const length of lengths) {
        bench.pulseIn(pins.START, length, { delay: 100 + (random() % 1000) });
        bench.run(1 + (random() % 30) / 10);
    }
    bench.run(100);
    const glitches = bench.events(EVENT.GLITCH);
    assert.deepEqual(bench.rises(), []);
    assert.equal(glitches.length, lengths.length);
    glitches.forEach(({ argument }, index) => assertLength(argument, lengths[index]));
    assert.equal(bench.status().glitches, lengths.length);
    const begin = bench.board.cycle + 1000;
    for (const at of [0, 300, 700, 1900]) { // each high ends before the debounce has passed
        bench.board.at(begin + at, () => bench.board.drive(pins.START, 1));
        bench.board.at(begin + at + 250, () => bench.board.drive(pins.START, 0));
    }
    bench.run(1);
    const edge = bench.start();
    bench.run(250);
    assert.equal(bench.rises()[0] - edge, 1250 + START_CYCLES);
    assert.equal(bench.events(EVENT.START).length, 1);
    assert.equal(bench.events(EVENT.GLITCH).length, lengths.length + 4);
    assert.ok(bench.reports.length > from);
    bench.assertClean();
});

test('a high of one cycle never starts a run', () => {
    const bench = new Bench();
    bench.applySettings({ debounceCycles: 2, preambleMs: [] });
    bench.armAndWait();
    for (let phase = 0; phase < 8; phase++) {
        bench.pulseIn(pins.START, 1, { delay: 1000 + phase });
        bench.run(2);
    }
    assert.deepEqual(bench.rises(), []);
    startAndCheck(bench);
    bench.assertClean();
});

test('START while IDLE and while RUNNING is told and has no other effect', () => {
    const bench = new Bench();
    bench.applySettings({ periodUs: 10000, preambleMs: [] });
    bench.start();
    assert.equal(bench.awaitEvent(EVENT.START_REFUSED, 1000, 0).argument, STATE.IDLE);
    assert.deepEqual(bench.trig, []);
    bench.armAndWait();
    startAndCheck(bench);
    for (let count = 0; count < 20; count++) {
        const from = bench.reports.length, edge = bench.start({ delay: 100 + (random() % MS) });
        const refused = bench.awaitEvent(EVENT.START_REFUSED, 1000, from);
        assert.equal(refused.argument, STATE.RUNNING);
        assert.ok(Math.abs(refused.time + bench.timeZero - edge) <= US + LOOK);
    }
    bench.pulseIn(pins.START, 100); // shorter than the debounce: told, here as in IDLE
    bench.run(50);
    const rises = bench.rises();
    rises.slice(1).forEach((cycle, index) => assert.equal(cycle - rises[index], 10 * MS));
    bench.disarm();
    bench.pulseIn(pins.START, 100);
    bench.run(50);
    const status = bench.status();
    assert.deepEqual([status.startsRefused, status.glitches], [21, 2]);
    assert.deepEqual(bench.events(EVENT.GLITCH).map(({ state }) => state),
        [STATE.RUNNING, STATE.IDLE]);
    bench.assertClean();
});

test('START around the moment of arming is either refused or taken whole', () => {
    const bench = new Bench(), seen = { refused: 0, taken: 0 };
    bench.applySettings({ preambleMs: [100, 200], periodUs: 20000 });
    for (let step = 0; step < (LONG ? 400 : 60); step++) {
        const from = bench.reports.length, before = bench.rises().length;
        bench.session++;
        let edge = 0;
        bench.host.send(1, command(OPCODE.ARM, bench.session), () => {
            edge = bench.start({ delay: 100 + step * (LONG ? 1000 : 6000), length: 300 * US });
        });
        bench.awaitEvent(EVENT.ARMED, 100, from);
        bench.run(5);
        const started = bench.reports.slice(from).some(({ kind, id }) =>
            id === 4 && kind === EVENT.START);
        const refused = bench.reports.slice(from).filter(({ kind, id }) =>
            id === 4 && kind === EVENT.START_REFUSED);
        assert.notEqual(started, refused.length === 1, `step ${step}: one of the two`);
        if (started) {
            assert.ok(bench.rises().slice(before).includes(edge + 125 + START_CYCLES));
        } else {
            assert.ok([STATE.IDLE, STATE.ARMED].includes(refused[0].argument));
        }
        seen[started ? 'taken' : 'refused']++;
        bench.disarm();
    }
    assert.ok(seen.refused > 0 && seen.taken > 0, JSON.stringify(seen));
    bench.assertClean();
});

test('START within the preamble cuts it and starts the run at once, at any phase', () => {
    const bench = new Bench(), preambleMs = [20, 30, 20], widthUs = 1000;
    bench.applySettings({ preambleMs, periodUs: 10000, widthUs });
    const width = widthUs * US, delta = 125 + START_CYCLES;
    // Where the first pulse falls, counted from the preamble's second one.
    const phases = [-3, -2, -1, 0, 1, 2, 3, width - 2, width - 1, width, width + 1, width + 2,
        width / 2, ...Array.from({ length: 12 }, () => random() % (25 * MS))];
    for (const phase of phases) {
        const from = bench.reports.length;
        bench.trig.length = 0;
        bench.arm();
        bench.until(() => bench.rises().length === 1, 1000, 'the preamble');
        const second = bench.rises()[0] + preambleMs[0] * MS;
        const edge = second + phase - delta;
        bench.start({ delay: edge - bench.board.cycle });
        bench.run(100);
        const rises = bench.rises(), first = rises.indexOf(edge + delta);
        assert.ok(first >= 1, `phase ${phase}: no edge at the debounce and 4 cycles`);
        rises.slice(first + 1).forEach((cycle, index) =>
            assert.equal(cycle - rises[first + index], 10 * MS, `phase ${phase}`));
        const triggers = bench.triggers(from);
        assert.deepEqual(triggers.map(({ number }) => number),
            rises.slice(0, triggers.length).map((_, index) => index + 1), `phase ${phase}`);
        assert.ok(triggers.length >= rises.length - 1);
        triggers.forEach(({ number, time, flags, firstRunNumber }) => {
            const isRun = number > first;
            assert.equal(flags, isRun ? FLAG.RUN | FLAG.PREAMBLE_CUT : FLAG.PREAMBLE,
                `phase ${phase}, pulse ${number}, first ${first + 1}`);
            assert.equal(firstRunNumber, isRun ? first + 1 : 0, `phase ${phase} ${number}`);
            bench.timeOffset(time, rises[number - 1]);
        });
        const [cut] = bench.events(EVENT.PREAMBLE_CUT).slice(-1);
        assert.equal(cut.argument, first, 'pulses before the cut');
        bench.disarm();
    }
    bench.assertClean();
});

test('the preamble has the gaps and width that were set, and then READY is said', () => {
    const bench = new Bench();
    const preambles = [[100, 200, 100, 300, 100], [10], [10, 20, 30, 40, 50, 60, 70, 80],
        [10000], []];
    for (const preambleMs of preambles) {
        for (const widthUs of [10, 1000, 9000]) {
            bench.applySettings({ preambleMs, widthUs });
            bench.trig.length = 0;
            const waiting = bench.armAndWait();
            bench.run(20);
            const rises = bench.rises(), falls = bench.rises(0, 0);
            assert.deepEqual(rises.slice(1).map((cycle, index) => cycle - rises[index]),
                preambleMs.map((gap) => gap * MS));
            falls.forEach((cycle, index) => assert.equal(cycle - rises[index], widthUs * US));
            assert.equal(rises.length, preambleMs.length ? preambleMs.length + 1 : 0);
            assert.equal(falls.length, rises.length);
            assert.equal(waiting.argument, rises.length);
            assert.equal(waiting.state, STATE.WAITING);
            bench.disarm();
        }
    }
    bench.assertClean();
});

test('TRIG and STROBE active low, START by its falling edge', () => {
    const bench = new Bench();
    bench.board.drive(pins.START, 1);
    bench.applySettings({ trigActiveLow: true, startFallingEdge: true, preambleMs: [] });
    assert.equal(bench.board.level(pins.TRIG), 1, 'at rest');
    bench.armAndWait();
    bench.trig.length = 0;
    const edge = bench.start({ active: 0 });
    bench.run(350);
    const falls = bench.rises(0, 0), rises = bench.rises(0, 1);
    assert.equal(falls[0] - edge, 125 + START_CYCLES);
    falls.slice(1).forEach((cycle, index) => assert.equal(cycle - falls[index], 100 * MS));
    rises.forEach((cycle, index) => assert.equal(cycle - falls[index], MS));
    bench.triggers().slice(-3).forEach(({ number, time }) =>
        bench.timeOffset(time, falls[number - 1]));
    bench.disarm();
    assert.equal(bench.board.level(pins.TRIG), 1, 'at rest again');
    bench.assertClean();
});

test('without a START the box waits, or gives up after the time that was set', () => {
    const bench = new Bench();
    bench.applySettings({ preambleMs: [], waitTimeoutS: 2 });
    const waiting = bench.armAndWait();
    const gaveUp = bench.awaitEvent(EVENT.WAIT_TIMEOUT, 3000, 0);
    const waited = gaveUp.time - waiting.time;
    assert.ok(waited >= 2 * SECOND && waited < 2 * SECOND + 100 * MS, `${waited / MS} ms`);
    assert.equal(gaveUp.state, STATE.IDLE);
    bench.start();
    bench.awaitEvent(EVENT.START_REFUSED);
    assert.deepEqual(bench.trig, []);
    bench.applySettings({ preambleMs: [], waitTimeoutS: 0 });
    bench.armAndWait();
    bench.run(30000);
    assert.equal(bench.status().state, STATE.WAITING);
    startAndCheck(bench);
    bench.assertClean();
});

/** A jumper joins TRIG and START, as for `opms box selftest --loopback`. */
test('where START takes the edge that ends a pulse of TRIG, a jumper starts a run', () => {
    for (const trigActiveLow of [false, true]) {
        const bench = new Bench(), { board } = bench;
        board.listeners.push((pin, level) => pin === pins.TRIG && board.drive(pins.START, level));
        for (const debounceCycles of [125, 1250, 1250000]) {
            bench.applySettings({ debounceCycles, preambleMs: [20, 20, 20, 20], trigActiveLow,
                startFallingEdge: !trigActiveLow });
            board.drive(pins.START, board.level(pins.TRIG));
            const from = bench.reports.length;
            bench.arm();
            assert.equal(bench.awaitEvent(EVENT.START, 1000, from).argument, 2);
            bench.until(() => bench.triggers(from).length > 5, 1000, 'six pulses');
            bench.disarm();
            const [preamble, ...run] = bench.triggers(from).slice(0, 6);
            assert.ok(!(preamble.flags & FLAG.RUN) && run.every(({ flags }) => flags & FLAG.RUN));
            assert.equal(run[0].time - run[0].startEdge, debounceCycles + START_CYCLES);
            run.slice(1).forEach(({ time }, index) => assert.equal(time - run[index].time,
                100 * MS));
        }
        bench.assertClean();
    }
});

test('SYNC sends 1 Hz from the start on, or a level for as long as the run lasts', () => {
    const bench = new Bench(), changes = () => bench.lines.filter(({ pin }) => pin === pins.SYNC);
    for (const sync of [1, 2]) {
        bench.applySettings({ sync, preambleMs: [50] });
        bench.armAndWait();
        bench.lines.length = 0;
        bench.trig.length = 0;
        bench.start();
        bench.run(5250);
        const [first] = bench.rises(), ups = changes().filter(({ level }) => level === 1);
        assert.ok(ups[0].cycle >= first && ups[0].cycle - first <= 10, 'with the first pulse');
        assert.equal(ups.length, sync === 1 ? 6 : 1);
        ups.slice(1).forEach(({ cycle }, index) => assert.equal(cycle - ups[index].cycle, SECOND));
        changes().filter(({ level }) => level === 0).forEach(({ cycle }, index) =>
            assert.equal(cycle - ups[index].cycle, 100 * MS));
        assert.equal(bench.board.level(pins.SYNC), sync === 1 ? 0 : 1);
        bench.disarm();
        assert.equal(bench.board.level(pins.SYNC), 0);
    }
    bench.assertClean();
});
