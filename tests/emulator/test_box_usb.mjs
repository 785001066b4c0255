// SPDX-License-Identifier: Apache-2.0
/** Enumeration by the book (USB 2.0 chapter 9, HID 1.11 chapter 7), descriptors, stalls. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, MS } from './box_bench.mjs';
import { parseReportDescriptor } from './hid_descriptor.mjs';
import { EnumerationError, getDescriptor, splitDescriptors } from './usb_enumerate.mjs';
import * as wire from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

const DEVICE = 1, CONFIGURATION = 2, STRING = 3, HID = 0x21, REPORT = 0x22;
const IN_ENDPOINT = 0x81, OUT_ENDPOINT = 0x01;
const get = (recipient, request, rest) => ({ type: 0x80 | recipient, request, ...rest });
const set = (recipient, request, rest) => ({ type: recipient, request, ...rest });
const u16 = (bytes, at) => bytes[at] | (bytes[at + 1] << 8);

test('the device descriptor is that of a full-speed device with the project\'s ids', () => {
    const { host } = new Bench(), { device } = host.device;
    assert.equal(device.length, 18);
    assert.deepEqual([device[0], device[1], u16(device, 2)], [18, DEVICE, 0x0200]);
    assert.deepEqual([...device.slice(4, 8)], [0, 0, 0, 64]);
    assert.deepEqual([u16(device, 8), u16(device, 10)], [0x1209, 0x0001]);
    assert.equal(device[17], 1);
    assert.equal(host.device.strings.serial, 'e6605838833a5f2c');
    assert.ok(host.device.strings.product.length > 0);
    assert.ok(host.device.strings.manufacturer.length > 0);
});

test('the configuration has one HID interface with an IN and an OUT endpoint of 64 bytes', () => {
    const { host } = new Bench(), { configuration, parts, report } = host.device;
    assert.equal(u16(configuration, 2), configuration.length);
    assert.deepEqual(parts.map((part) => part[1]), [CONFIGURATION, 4, HID, 5, 5]);
    const [head, face, hid, ...endpoints] = parts;
    assert.equal(head[4], 1);
    assert.equal(head[7] & 0x80, 0x80, 'bit 7 of bmAttributes is always 1');
    assert.ok(head[8] * 2 <= 500, 'no more than a port may give');
    assert.deepEqual([...face.slice(2, 8)], [0, 0, 2, 3, 0, 0]);
    assert.equal(u16(hid, 2), 0x0111);
    assert.deepEqual([hid[5], hid[6], u16(hid, 7)], [1, REPORT, report.length]);
    assert.deepEqual(endpoints.map((part) => part[2]).sort(), [OUT_ENDPOINT, IN_ENDPOINT]);
    for (const part of endpoints) {
        assert.deepEqual([part[3], u16(part, 4), part[6]], [3, 64, 1]);
    }
});

test('an independent parser finds every report of the protocol in the report descriptor', () => {
    const { host } = new Bench();
    const { collections, reports } = parseReportDescriptor(host.device.report);
    assert.deepEqual(collections.map(({ type, usage }) => [type, usage]), [[1, 0xff4f0001]]);
    const found = reports.map(({ kind, id, bytes }) => `${kind} ${id} ${bytes}`).sort();
    const expected = [...[1, 2, 3, 4].map((id) => `input ${id} 64`), 'output 16 64',
        ...[0x20, 0x21, 0x22, 0x23].map((id) => `feature ${id} 64`)].sort();
    assert.deepEqual(found, expected);
    for (const { fields } of reports) {
        assert.deepEqual(fields.map(({ reportSize, logicalMinimum, logicalMaximum }) =>
            [reportSize, logicalMinimum, logicalMaximum]), [[8, 0, 255]]);
    }
});

test('each standard request is answered as chapter 9 says', () => {
    const bench = new Bench(), ask = (request) => bench.control(request);
    assert.deepEqual([...ask(get(0, 0, { length: 2 }))].map((byte) => byte & 0xfe), [0, 0]);
    assert.deepEqual([...ask(get(1, 0, { length: 2 }))], [0, 0]);
    assert.deepEqual([...ask(get(2, 0, { index: IN_ENDPOINT, length: 2 }))], [0, 0]);
    assert.deepEqual([...ask(get(0, 8, { length: 1 }))], [1], 'GET_CONFIGURATION');
    assert.deepEqual([...ask(get(1, 10, { length: 1 }))], [0], 'GET_INTERFACE');
    assert.equal(ask(set(1, 11, { value: 0 })), 'OK', 'SET_INTERFACE to the only setting');
    assert.deepEqual(ask(getDescriptor(DEVICE, 0, 18)), bench.host.device.device);
    assert.equal(ask(getDescriptor(DEVICE, 0, 64)).length, 18, 'no more than there is');
    assert.equal(ask(getDescriptor(DEVICE, 0, 8)).length, 8, 'no more than asked');
    assert.equal(ask(getDescriptor(CONFIGURATION, 0, 4096)).length,
        bench.host.device.configuration.length);
    assert.deepEqual([...ask(get(1, 6, { value: HID << 8, length: 9 }))],
        [...splitDescriptors(bench.host.device.configuration)[2]]);
    assert.ok(ask(getDescriptor(STRING, 0, 255)).length >= 4, 'languages');
    bench.assertClean();
});

test('what the device does not know it stalls, and goes on', () => {
    const bench = new Bench();
    const unknown = {
        'a configuration that does not exist': getDescriptor(CONFIGURATION, 5, 9),
        'a string that does not exist': getDescriptor(STRING, 77, 255),
        'a device qualifier': getDescriptor(6, 0, 10),
        'a descriptor of unknown kind': getDescriptor(0x55, 0, 8),
        'a vendor request': { type: 0xc0, request: 1, length: 4 },
        'SET_DESCRIPTOR': set(0, 7, { value: 0x100 }),
        'SYNCH_FRAME': get(2, 12, { index: IN_ENDPOINT, length: 2 }),
        'a standard request of unknown number': get(0, 0x33, { length: 2 }),
        'configuration 2': set(0, 9, { value: 2 }),
        'an interface that does not exist': get(1, 10, { index: 7, length: 1 }),
        'an alternate setting that does not exist': set(1, 11, { value: 1 }),
        'a class request of unknown number': { type: 0xa1, request: 0x44, length: 4 },
    };
    const answers = {};
    for (const [what, request] of Object.entries(unknown)) {
        answers[what] = bench.control(request);
        assert.equal(typeof bench.control(getDescriptor(DEVICE, 0, 18)), 'object', what);
    }
    const odd = Object.keys(unknown).filter((what) => answers[what] !== 'STALL');
    assert.deepEqual(odd, [], JSON.stringify(answers));
    bench.assertClean();
});

test('a halted endpoint stalls until it is cleared, and begins with DATA0 then', () => {
    const bench = new Bench(), halt = { value: 0, index: IN_ENDPOINT };
    bench.run(20);
    assert.equal(bench.control(set(2, 3, halt)), 'OK', 'SET_FEATURE');
    assert.deepEqual([...bench.control(get(2, 0, { index: IN_ENDPOINT, length: 2 }))], [1, 0]);
    bench.run(5);
    assert.ok(bench.host.errors.length > 0 &&
        bench.host.errors.every((error) => error === 'IN 1: STALL'));
    bench.host.errors.length = 0;
    bench.host.polls = false; // so that nothing is taken with the old toggle
    assert.equal(bench.control(set(2, 1, halt)), 'OK', 'CLEAR_FEATURE');
    bench.host.errors.length = 0;
    bench.host.toggles.set('in1', 0);
    bench.host.polls = true;
    assert.deepEqual([...bench.control(get(2, 0, { index: IN_ENDPOINT, length: 2 }))], [0, 0]);
    bench.status();
    bench.assertClean();
});

test('configuration 0 and back, and another bus reset, leave a box that works', () => {
    const bench = new Bench();
    bench.host.polls = false;
    assert.equal(bench.control(set(0, 9, { value: 0 })), 'OK');
    assert.deepEqual([...bench.control(get(0, 8, { length: 1 }))], [0]);
    assert.equal(bench.control(set(0, 9, { value: 1 })), 'OK');
    bench.host.toggles.clear();
    bench.host.polls = true;
    bench.status();
    for (let round = 0; round < 3; round++) {
        bench.host.plug(false);
        bench.run(50);
        bench.host.plug(true);
        bench.until(() => bench.host.device !== null, 2000, 'enumeration');
        bench.status();
    }
    bench.assertClean();
});

test('suspend and resume cost nothing', () => {
    const bench = new Bench();
    bench.host.suspend();
    bench.run(1000);
    bench.host.resume();
    bench.run(100);
    assert.equal(bench.readIdentity().magic, 'OPMS');
    bench.status();
    bench.assertClean();
});

test('each feature report that can be read is read whole, in part, and asked for too long', () => {
    const bench = new Bench();
    for (const id of [wire.ID.IDENTITY, wire.ID.SETTINGS, wire.ID.HISTORY]) {
        const whole = bench.getFeature(id);
        assert.equal(whole.length, 64);
        assert.deepEqual(bench.getFeature(id, 20), whole.slice(0, 20));
        assert.deepEqual(bench.getFeature(id, 255), whole);
    }
    for (const id of [wire.ID.TRIGGER, wire.ID.STATUS, wire.ID.COMMAND, wire.ID.BOOTLOADER, 0,
        0x7f]) {
        assert.equal(bench.getFeature(id), 'STALL', `GET of ${id}`);
    }
    assert.equal(bench.setFeature(new Uint8Array(65).fill(0x21)), 'STALL', 'a SET of 65 bytes');
    assert.equal(bench.setFeature(new Uint8Array(200).fill(0x21)), 'STALL', 'a SET of 200 bytes');
    assert.equal(bench.readIdentity().magic, 'OPMS');
    bench.assertClean();
});

test('identity and serial number are the flash chip\'s unique id', () => {
    const bench = new Bench(), { uniqueId } = bench.board.flash;
    const identity = bench.readIdentity();
    assert.deepEqual(identity.uniqueId, uniqueId);
    assert.equal(bench.host.device.strings.serial, Buffer.from(uniqueId).toString('hex'));
    assert.deepEqual([identity.startCycles, identity.ringEntries, identity.historyEntries,
        identity.clockHz], [4, 1024, 8192, 125000000]);
    assert.notEqual(identity.boot, 0);
    assert.equal(bench.status().boot, identity.boot);
});

test('a command is the same by OUT endpoint and by SET_REPORT', () => {
    const bench = new Bench();
    for (const send of [(bytes) => bench.send(bytes), (bytes) => bench.setOutput(bytes)]) {
        const from = bench.reports.length, sentAt = bench.now;
        send(requests.command(wire.OPCODE.PING, 4711 + from));
        const find = () => bench.reports.slice(from).find(({ id }) => id === wire.ID.PONG);
        bench.until(() => find(), 100, 'a PONG');
        const pong = find();
        assert.equal(pong.pingId, 4711 + from);
        assert.ok(pong.received <= pong.sent && pong.sent <= pong.cycle - bench.timeZero);
        assert.ok(pong.received >= sentAt - bench.timeZero - MS);
    }
    bench.assertClean();
});

test('the parser of the tests refuses what is no descriptor', () => {
    assert.throws(() => splitDescriptors(Uint8Array.of(9, 2, 3)), EnumerationError);
    for (const bytes of [[0x06, 0x4f], [0xc0], [0xa1, 1], [0x81, 2], [0xa1, 1, 0x81, 2, 0xc0],
        [0x85, 0], [0xfe, 0, 0], [0xa1, 1, 0x15, 0, 0x25, 1, 0x75, 8, 0x95, 1, 0x81, 2, 0xc0],
        [0xa1, 1, 0x09, 1, 0x15, 0, 0x25, 1, 0x75, 3, 0x95, 1, 0x81, 2, 0xc0]]) {
        assert.throws(() => parseReportDescriptor(bytes), undefined, bytes.toString());
    }
});
