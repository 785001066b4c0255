// SPDX-License-Identifier: Apache-2.0
/** What the host may ask, and when it is refused: malformed reports, wrong states, HISTORY. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, LONG } from './box_bench.mjs';
import { randomGenerator } from './small_blocks.mjs';
import * as wire from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

const { EVENT, FLAG, ID, OPCODE, REFUSAL, STATE } = wire;
const SETTINGS_ARGUMENT = ID.SETTINGS;

/** A good report with some bytes changed and the CRC put right again. */
function changed(bytes, changes, sealed = true) {
    const copy = Uint8Array.from(bytes);
    Object.entries(changes).forEach(([at, value]) => {
        copy[at] = value;
    });
    return sealed ? requests.seal(copy) : copy;
}

/** Send what must be refused and check what the box says of it. */
function assertRefused(bench, send, { argument, detail }) {
    const from = bench.reports.length, before = bench.refusedSoFar ?? 0;
    send();
    const event = bench.awaitEvent(EVENT.REFUSED, 500, from);
    assert.deepEqual([event.argument, event.detail], [argument, detail]);
    bench.refusedSoFar = before + 1;
}

const arm = () => requests.command(OPCODE.ARM, 5);
const badCommands = {
    'a bad CRC': [changed(arm(), { 63: arm()[63] ^ 1 }, false), REFUSAL.CRC],
    'another protocol version': [changed(arm(), { 1: 2 }), REFUSAL.VERSION],
    'an unknown id': [changed(arm(), { 0: 0x7e }), REFUSAL.ID],
    'the id of a report of the box': [changed(arm(), { 0: ID.STATUS }), REFUSAL.ID],
    'an unknown opcode': [changed(arm(), { 2: 9 }), REFUSAL.VALUE],
    'a reserved byte': [changed(arm(), { 30: 1 }), REFUSAL.VALUE],
    'session 0': [requests.command(OPCODE.ARM, 0), REFUSAL.VALUE],
    'DISARM with an argument': [requests.command(OPCODE.DISARM, 1), REFUSAL.VALUE],
    'a report of 10 bytes': [arm().slice(0, 10), REFUSAL.LENGTH],
    'a report of one byte': [arm().slice(0, 1), REFUSAL.LENGTH],
};

test('each malformed COMMAND is refused with its reason, on both ways, and changes nothing', () => {
    const bench = new Bench();
    for (const [name, [bytes, refusal]] of Object.entries(badCommands)) {
        for (const way of ['send', 'setOutput']) {
            const from = bench.reports.length;
            assert.ok(['ACK', 'OK'].includes(bench[way](bytes)), `${name}: acknowledged`);
            const event = bench.awaitEvent(EVENT.REFUSED, 500, from);
            assert.equal(event.detail, refusal, `${name} by ${way}`);
            const ids = [bytes[0], ID.COMMAND]; // an unknown id may be told by where it came
            assert.ok(ids.includes(event.argument & 0xff), `${name}: ${event.argument}`);
            assert.equal(event.argument >> 8, 0, `${name}: the opcode of what could not be read`);
        }
    }
    const status = bench.status();
    assert.equal(status.state, STATE.IDLE);
    assert.equal(status.commandsRefused, 2 * Object.keys(badCommands).length);
    bench.assertClean();
});

test('each malformed SETTINGS is refused, told in last_set too, and the old ones stay', () => {
    const bench = new Bench(), good = requests.settingsSet();
    bench.applySettings({ periodUs: 123456 });
    const bad = {
        'a bad CRC': [changed(good, { 62: good[62] ^ 0x80 }, false), REFUSAL.CRC],
        'another version': [changed(good, { 1: 0 }), REFUSAL.VERSION],
        'a byte of the box\'s own': [changed(good, { 2: 1 }), REFUSAL.VALUE],
        'a reserved byte': [changed(good, { 50: 255 }), REFUSAL.VALUE],
        'too short a period': [requests.settingsSet({ periodUs: 9999 }), REFUSAL.VALUE],
        'too long a period': [requests.settingsSet({ periodUs: 10000001 }), REFUSAL.VALUE],
        'too short a pulse': [requests.settingsSet({ widthUs: 9 }), REFUSAL.VALUE],
        'a pulse as long as the period': [requests.settingsSet({ widthUs: 99001 }), REFUSAL.VALUE],
        'too long a debounce': [requests.settingsSet({ debounceCycles: 1250001 }), REFUSAL.VALUE],
        'an unknown SYNC': [requests.settingsSet({ sync: 3 }), REFUSAL.VALUE],
        'an unknown bit': [changed(good, { 16: 0x10 }), REFUSAL.VALUE],
        'a gap too short': [requests.settingsSet({ preambleMs: [9] }), REFUSAL.VALUE],
        'a gap within the pulse': [requests.settingsSet({ widthUs: 50000, preambleMs: [50] }),
            REFUSAL.VALUE],
        'a gap behind the end': [requests.settingsSet({ preambleMs: [100, 0, 100] }),
            REFUSAL.VALUE],
        '63 bytes': [good.slice(0, 63), REFUSAL.LENGTH],
    };
    for (const [name, [bytes, detail]] of Object.entries(bad)) {
        assertRefused(bench, () => assert.equal(bench.setFeature(bytes), 'OK', name),
            { argument: SETTINGS_ARGUMENT, detail });
        const { lastSet, settings, pending } = bench.readSettings();
        assert.deepEqual([lastSet, pending, settings.periodUs], [detail, false, 123456], name);
    }
    assert.equal(bench.status().commandsRefused, Object.keys(bad).length);
    bench.assertClean();
});

test('what touches flash or restarts the box is refused outside of IDLE', () => {
    const bench = new Bench();
    bench.applySettings({ preambleMs: [200, 200] });
    const refuse = (send, argument) => assertRefused(bench, send,
        { argument, detail: REFUSAL.STATE });
    const tryAll = () => {
        refuse(() => bench.setFeature(requests.settingsSet()), ID.SETTINGS);
        refuse(() => bench.setFeature(requests.bootloader()), ID.BOOTLOADER);
        refuse(() => bench.send(requests.command(OPCODE.ARM, 77)), ID.COMMAND | (OPCODE.ARM << 8));
    };
    const from = bench.reports.length;
    bench.arm();
    tryAll(); // PREAMBLE
    bench.awaitEvent(EVENT.WAITING, 2000, from);
    tryAll();
    bench.start();
    bench.awaitEvent(EVENT.START);
    tryAll();
    const status = bench.status();
    assert.deepEqual([status.state, status.session], [STATE.RUNNING, bench.session]);
    bench.disarm();
    const noMagic = requests.bootloader(0x12345678);
    assertRefused(bench, () => bench.setFeature(noMagic),
        { argument: ID.BOOTLOADER, detail: REFUSAL.MAGIC });
    assert.equal(bench.readIdentity().magic, 'OPMS');
    bench.assertClean();
});

test('DISARM is obeyed in every state, and does nothing in IDLE', () => {
    const bench = new Bench();
    bench.applySettings({ preambleMs: [100, 100] });
    bench.send(requests.command(OPCODE.DISARM));
    bench.run(100);
    const idle = bench.events(EVENT.REFUSED).length;
    assert.equal(idle, 0);
    bench.arm(); // PREAMBLE
    bench.run(50);
    bench.disarm();
    assert.ok(bench.rises().length <= 1);
    bench.armAndWait();
    assert.equal(bench.disarm().argument, 3, 'the number of the last pulse');
    bench.armAndWait();
    bench.start();
    bench.run(250);
    assert.equal(bench.disarm().argument, 3 + 3);
    bench.run(500);
    assert.equal(bench.rises().length, bench.rises(0, 0).length);
    bench.assertClean();
});

test('HISTORY returns every pulse of the session, and says what it does not hold', () => {
    const bench = new Bench();
    bench.applySettings({ periodUs: 10000, preambleMs: [20, 30] });
    bench.armAndWait();
    bench.start();
    bench.run(505);
    const rises = bench.rises(), entries = bench.readHistory(1, rises.length + 3);
    const offset = bench.timeOffset(entries.get(1).time, rises[0]);
    const count = bench.rises().length;
    rises.forEach((cycle, index) => {
        const entry = entries.get(index + 1);
        assert.equal(entry.time - cycle, offset);
        assert.equal(entry.flags, index < 3 ? FLAG.PREAMBLE : FLAG.RUN);
    });
    assert.equal(entries.get(rises.length + 3)?.flags ?? FLAG.NOT_HELD, FLAG.NOT_HELD);
    assert.ok(count >= rises.length);
    const other = bench.readHistory(1, 4, bench.session + 9);
    assert.ok([...other.values()].every(({ flags }) => flags === FLAG.NOT_HELD));
    bench.disarm();
    assert.equal(bench.readHistory(1, 3).get(1).time, entries.get(1).time, 'kept after the stop');
    bench.armAndWait();
    const old = bench.readHistory(1, 3, bench.session - 1);
    assert.ok([...old.values()].every(({ flags }) => flags === FLAG.NOT_HELD), 'another session');
    bench.assertClean();
});

test('a selection by another hand shows in the token', () => {
    const bench = new Bench();
    bench.arm();
    const select = (token) => bench.setFeature(requests.historyRequest({ token, first: 1,
        session: bench.session, count: 100 }));
    const readToken = () => wire.readHistory(bench.getFeature(ID.HISTORY)).token;
    assert.equal(readToken(), 0, 'nothing was selected');
    select(17);
    assert.equal(readToken(), 17);
    select(18);
    assert.equal(readToken(), 18);
    for (const bad of [{ token: 0, session: 1, first: 1, count: 1 },
        { token: 1, session: 0, first: 1, count: 1 }, { token: 1, session: 1, first: 0, count: 1 },
        { token: 1, session: 1, first: 1, count: 0 },
        { token: 1, session: 1, first: 1, count: 8193 }]) {
        assertRefused(bench, () => bench.setFeature(requests.historyRequest(bad)),
            { argument: ID.HISTORY, detail: REFUSAL.VALUE });
        assert.equal(readToken(), 18);
    }
    bench.assertClean();
});

test('reports damaged at random are counted and never harm', () => {
    const bench = new Bench(), random = randomGenerator(7), from = bench.reports.length;
    const good = [arm(), requests.settingsSet(), requests.command(OPCODE.PING, 3),
        requests.historyRequest({ token: 1, session: 1, first: 1, count: 1 })];
    let sent = 0;
    for (let count = 0; count < (LONG ? 5000 : 300); count++) {
        const bytes = Uint8Array.from(good[random() % good.length]);
        const flips = 1 + (random() % 6);
        for (let flip = 0; flip < flips; flip++) { // not the id: SET tells it twice
            const at = 1 + (random() % 63);
            bytes[at] ^= 1 + (random() % 255);
        }
        const length = random() % 4 ? 64 : 1 + (random() % 63);
        const isWhole = length === 64 && good.some((report) =>
            Buffer.compare(report, bytes) === 0);
        const isCommand = bytes[0] === ID.COMMAND;
        if (!isWhole) {
            sent++;
            const part = bytes.subarray(0, length);
            const answer = isCommand ? bench.send(part) : bench.setFeature(part);
            assert.ok(['ACK', 'OK'].includes(answer), answer);
        }
        if (count % 10 === 9) {
            bench.run(20); // events wait for the host in a queue
        }
    }
    bench.run(500);
    const status = bench.status();
    assert.equal(status.commandsRefused, sent);
    assert.equal(bench.reports.slice(from).filter(({ kind, id }) =>
        id === ID.EVENT && kind === EVENT.REFUSED).length, sent);
    assert.deepEqual([status.state, bench.readSettings().stored], [STATE.IDLE, false]);
    bench.assertClean();
});
