// SPDX-License-Identifier: Apache-2.0
/** The bench of the tests: the box with its firmware, a host that reads it, a signal generator on
 * its lines, and a record of every edge and every report. */
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { Board } from './board.mjs';
import { boardPins, defaultFirmware, loadFirmware } from './firmware_file.mjs';
import { MS, UsbHost } from './usb_host.mjs';
import * as wire from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

export { MS };
export const SECOND = 1000 * MS, US = 125, START_CYCLES = 4;
export const LONG = process.env.OPMS_EMULATOR_LONG === '1'; // every case instead of a sample
const SET_REPORT = { type: 0x21, request: 9 }, GET_REPORT = { type: 0xa1, request: 1 };
const OUTPUT = 2 << 8, FEATURE = 3 << 8, STEP = MS / 4;

export const firmwarePath = process.env.OPMS_FIRMWARE ?? defaultFirmware;
export const pins = boardPins();
let firmware = null;

/** The program under test; the tests fail at once if it is not there. */
export function shippedFirmware() {
    assert.ok(existsSync(firmwarePath), `no firmware at ${firmwarePath}; ./run firmware builds it`);
    firmware ??= loadFirmware(firmwarePath);
    return firmware;
}

export class Bench {
    /** @param options  {flash, seed, enumerates, image}; boots unless `boots` is false. */
    constructor({ flash = null, seed = 1, enumerates = true, boots = true, image = null } = {}) {
        const program = flash ? null : image ?? shippedFirmware().image;
        this.board = new Board({ image: program, flash, seed });
        this.host = new UsbHost(this.board, { enumerates });
        this.reports = [];   // decoded input reports, with `cycle` of their arrival
        this.trig = [];      // {level, cycle}
        this.lines = [];     // {pin, level, cycle} of all other pins
        this.bad = [];       // input reports that do not read
        this.session = 0;
        this.board.listeners.push((pin, level, cycle) => this.#onLevel(pin, level, cycle));
        this.host.onInput = (_, data, cycle) => this.#onInput(data, cycle);
        if (boots) {
            this.boot();
        }
    }

    #onLevel(pin, level, cycle) {
        if (pin === pins.TRIG) {
            this.trig.push({ level, cycle });
        } else if (pin !== pins.LED) {
            this.lines.push({ pin, level, cycle });
        }
    }

    #onInput(data, cycle) {
        try {
            this.reports.push({ ...wire.readInput(data), cycle });
        } catch (error) {
            this.bad.push(`${error.message}: ${Buffer.from(data).toString('hex')}`);
        }
    }

    // --- time -----------------------------------------------------------------------------------

    get now() {
        return this.board.now;
    }

    boot() {
        this.board.powerOn();
        this.bootedAt = this.now;
        this.until(() => this.host.device !== null, 3000, 'the box to enumerate');
    }

    run(ms) {
        this.board.runTo(this.now + Math.round(ms * MS));
    }

    /** Run until a condition holds. */
    until(condition, limitMs, what) {
        const limit = this.now + limitMs * MS;
        while (!condition()) {
            assert.ok(this.now < limit, `waited ${limitMs} ms for ${what}; ${this.describe()}`);
            this.board.runTo(this.now + STEP);
        }
    }

    describe() {
        const last = this.reports.slice(-3).map(({ id, kind, state }) => ({ id, kind, state }));
        return JSON.stringify({ last, usb: this.host.errors, faults: this.board.allFaults() });
    }

    /** Nothing may have happened that silicon or USB would not forgive. */
    assertClean() {
        assert.deepEqual(this.board.allFaults(), []);
        assert.deepEqual(this.host.errors, []);
        assert.deepEqual(this.bad, []);
    }

    /** Cycle of the board at which the box's own time was 0: its timer's, to the microsecond. */
    get timeZero() {
        return this.board.chip.timer.zeroCycle;
    }

    /** The box's time less the board's, in cycles. What reports say must lie at this one offset,
     * to the cycle, for as long as the box is up; it is less than 1 us from the timer's. */
    timeOffset(time, cycle) {
        const offset = time - cycle;
        assert.ok(Math.abs(offset + this.timeZero) <= US,
            `the box's time is ${offset + this.timeZero} cycles from its timer's`);
        return offset;
    }

    // --- USB ------------------------------------------------------------------------------------

    control(request, limitMs = 6000) {
        let result;
        this.host.submit(request, (answer) => {
            result = answer;
        });
        this.until(() => result !== undefined, limitMs, 'a control transfer');
        return result;
    }

    getFeature(id, length = wire.SIZE) {
        return this.control({ ...GET_REPORT, value: FEATURE | id, length });
    }

    setFeature(bytes, id = bytes[0]) {
        return this.control({ ...SET_REPORT, value: FEATURE | id, length: bytes.length,
            data: bytes });
    }

    setOutput(bytes, id = bytes[0]) {
        return this.control({ ...SET_REPORT, value: OUTPUT | id, length: bytes.length,
            data: bytes });
    }

    /** By the interrupt OUT endpoint. */
    send(bytes) {
        let result;
        this.host.send(this.host.device.outEndpoints[0], bytes, (answer) => {
            result = answer;
        });
        this.until(() => result !== undefined, 1000, 'an OUT transfer');
        return result;
    }

    readSettings() {
        return wire.readSettings(this.getFeature(wire.ID.SETTINGS));
    }

    readIdentity() {
        return wire.readIdentity(this.getFeature(wire.ID.IDENTITY));
    }

    /** SET and wait for what becomes of it. @returns what a GET then says. */
    trySettings(changes) {
        assert.equal(this.setFeature(requests.settingsSet(changes)), 'OK');
        let report = this.readSettings();
        for (let tries = 0; report.pending; tries++) {
            assert.ok(tries < 200, 'SETTINGS stay pending');
            this.run(10);
            report = this.readSettings();
        }
        return report;
    }

    applySettings(changes) {
        const report = this.trySettings(changes);
        assert.equal(report.lastSet, wire.REFUSAL.NONE);
        this.settings = report.settings;
        return report;
    }

    /** All pulses from `first` to `last` out of HISTORY, by number. */
    readHistory(first, last, session = this.session) {
        const entries = new Map(), count = last - first + 1;
        const token = 1 + (first % 65535);
        assert.equal(this.setFeature(requests.historyRequest({ token, session, first, count })),
            'OK');
        for (;;) {
            const report = wire.readHistory(this.getFeature(wire.ID.HISTORY));
            assert.equal(report.token, token);
            if (!report.count) {
                return entries;
            }
            report.entries.forEach((entry) => entries.set(entry.number, entry));
        }
    }

    // --- the box's states -----------------------------------------------------------------------

    events(kind = null) {
        return this.reports.filter((report) => report.id === wire.ID.EVENT &&
            (kind === null || report.kind === kind));
    }

    /** The next event of a kind that arrives from now on, or did since `from` reports. */
    awaitEvent(kind, limitMs = 2000, from = this.reports.length) {
        const find = () => this.reports.slice(from).find((report) =>
            report.id === wire.ID.EVENT && report.kind === kind);
        const name = Object.keys(wire.EVENT).find((key) => wire.EVENT[key] === kind);
        this.until(() => find() !== undefined, limitMs, `EVENT ${name}`);
        return find();
    }

    arm(session = this.session + 1) {
        const from = this.reports.length;
        this.session = session;
        assert.equal(this.send(requests.command(wire.OPCODE.ARM, session)), 'ACK');
        return this.awaitEvent(wire.EVENT.ARMED, 1000, from);
    }

    disarm() {
        const from = this.reports.length;
        assert.equal(this.send(requests.command(wire.OPCODE.DISARM)), 'ACK');
        return this.awaitEvent(wire.EVENT.STOP, 12000, from);
    }

    /** Arm and wait until the box waits for START. */
    armAndWait(session = this.session + 1) {
        const from = this.reports.length;
        this.arm(session);
        return this.awaitEvent(wire.EVENT.WAITING, 90000, from);
    }

    // --- lines ----------------------------------------------------------------------------------

    /** A pulse on an input, so many cycles from now. @returns the cycle of its edge. */
    pulseIn(pin, length, { delay = 200, active = 1 } = {}) {
        const edge = this.board.cycle + delay;
        this.board.at(edge, () => this.board.drive(pin, active));
        this.board.at(edge + length, () => this.board.drive(pin, active ? 0 : 1));
        return edge;
    }

    /** A START long enough for the settings in force. @returns the cycle of its edge. */
    start({ delay = 200, length = null, active = 1 } = {}) {
        const debounce = this.settings?.debounceCycles ?? requests.DEFAULTS.debounceCycles;
        return this.pulseIn(pins.START, length ?? debounce + 10 * US, { delay, active });
    }

    /** Cycles at which TRIG became active, from an index of `trig` on. */
    rises(from = 0, active = 1) {
        return this.trig.slice(from).filter(({ level }) => level === active)
            .map(({ cycle }) => cycle);
    }

    triggers(from = 0) {
        return this.reports.slice(from).filter(({ id }) => id === wire.ID.TRIGGER);
    }

    status() {
        const from = this.reports.length;
        const find = () => this.reports.slice(from).find(({ id }) => id === wire.ID.STATUS);
        this.until(() => find() !== undefined, 1500, 'a STATUS');
        return find();
    }
}
