// SPDX-License-Identifier: Apache-2.0
/** The reports of docs/wire.md in JavaScript, written from that document: it shares nothing with
 * libopms/src/wire, so that one finds the other's mistakes. Reading checks everything. */

export const SIZE = 64, PROTOCOL = 1, CRC_AT = 62, BOOTLOADER_MAGIC = 0xb0075e1f;
export const ID = { TRIGGER: 1, PONG: 2, STATUS: 3, EVENT: 4, COMMAND: 0x10, IDENTITY: 0x20,
    SETTINGS: 0x21, HISTORY: 0x22, BOOTLOADER: 0x23 };
export const STATE = { IDLE: 0, ARMED: 1, PREAMBLE: 2, WAITING: 3, RUNNING: 4 };
export const CAUSE = { UNKNOWN: 0, POWER: 1, PIN: 2, WATCHDOG: 3, SOFTWARE: 4 };
export const FLAG = { PREAMBLE: 1, RUN: 2, PREAMBLE_CUT: 4, STROBE: 8, STROBE_MISSING: 16,
    DELAYED: 32, NOT_HELD: 64 };
export const EVENT = { ARMED: 1, WAITING: 2, START: 3, STOP: 4, GLITCH: 5, START_REFUSED: 6,
    PREAMBLE_CUT: 7, STROBE_MISSING: 8, WAIT_TIMEOUT: 9, REFUSED: 10, SETTINGS_STORED: 11,
    ENDPOINT_HEALED: 12 };
export const REFUSAL = { NONE: 0, STATE: 1, LENGTH: 2, ID: 3, VERSION: 4, CRC: 5, VALUE: 6,
    MAGIC: 7, FLASH: 8, BUSY: 9 };
export const OPCODE = { PING: 1, ARM: 2, DISARM: 3 };

export class WireError extends Error {}

const fail = (text) => {
    throw new WireError(text);
};

const exact = (value) => (value <= BigInt(Number.MAX_SAFE_INTEGER) ? Number(value) : value);

/** CRC-16/IBM-3740. */
export function crc16(bytes) {
    let crc = 0xffff;
    for (const byte of bytes) {
        crc ^= byte << 8;
        for (let bit = 0; bit < 8; bit++) {
            crc = crc & 0x8000 ? ((crc << 1) ^ 0x1021) & 0xffff : (crc << 1) & 0xffff;
        }
    }
    return crc;
}

/** Reads fields and keeps account of which bytes were named: the others must be 0. */
class Reader {
    constructor(bytes, id) {
        this.bytes = Uint8Array.from(bytes);
        if (this.bytes.length !== SIZE) {
            fail(`${this.bytes.length} bytes`);
        }
        this.view = new DataView(this.bytes.buffer);
        this.named = new Uint8Array(SIZE);
        if (this.u8(0) !== id) {
            fail(`id ${this.bytes[0]}, not ${id}`);
        }
        if (this.u8(1) !== PROTOCOL) {
            fail(`protocol ${this.bytes[1]}`);
        }
        if (this.u16(CRC_AT) !== crc16(this.bytes.subarray(0, CRC_AT))) {
            fail('CRC');
        }
    }

    #name(at, size) {
        this.named.fill(1, at, at + size);
    }
    u8(at) {
        this.#name(at, 1);
        return this.view.getUint8(at);
    }
    u16(at) {
        this.#name(at, 2);
        return this.view.getUint16(at, true);
    }
    u24(at) {
        this.#name(at, 3);
        return this.view.getUint16(at, true) | (this.view.getUint8(at + 2) << 16);
    }
    u32(at) {
        this.#name(at, 4);
        return this.view.getUint32(at, true);
    }
    /** A number where it is exact, else a BigInt; no box runs that long. */
    u64(at) {
        this.#name(at, 8);
        return exact(this.view.getBigUint64(at, true));
    }
    array(at, size) {
        this.#name(at, size);
        return this.bytes.slice(at, at + size);
    }
    /** A box time in cycles. */
    time(usAt, cyclesAt) {
        const cycles = this.range(this.u8(cyclesAt), 0, 124, 'cycles');
        return exact(BigInt(this.u64(usAt)) * 125n + BigInt(cycles));
    }
    range(value, low, high, name) {
        return value >= low && value <= high ? value : fail(`${name} is ${value}`);
    }
    bits(value, mask, name) {
        return value & ~mask ? fail(`${name} is 0x${value.toString(16)}`) : value;
    }
    notZero(value, name) {
        return value === 0 ? fail(`${name} is 0`) : value;
    }
    /** Every byte that was not read must be 0. */
    end(report) {
        this.named.forEach((named, at) => {
            if (!named && this.bytes[at]) {
                fail(`reserved byte ${at} is ${this.bytes[at]}`);
            }
        });
        return report;
    }
}

function checkFlags(flags) {
    const isRun = (flags & FLAG.RUN) !== 0;
    if (isRun === ((flags & FLAG.PREAMBLE) !== 0)) {
        fail('exactly one of PREAMBLE and RUN must be set');
    }
    if (flags & FLAG.PREAMBLE_CUT && !isRun) {
        fail('PREAMBLE_CUT in the preamble');
    }
}

export function readTrigger(bytes) {
    const r = new Reader(bytes, ID.TRIGGER);
    const report = {
        flags: r.bits(r.u16(2), 0x3f, 'flags'), boot: r.notZero(r.u32(4), 'boot'),
        session: r.notZero(r.u32(8), 'session'), reportNumber: r.u32(12), number: r.u32(16),
        time: r.time(20, 36), startEdge: r.time(28, 37), dropped: r.u16(38),
        firstRunNumber: r.u32(40), strobeFor: r.u32(44), strobeDelay: r.u32(48),
        strobeLength: r.u32(52), gapsUs: [r.u24(56), r.u24(59)],
    };
    checkFlags(report.flags);
    if (!(report.flags & FLAG.STROBE) &&
        (report.strobeFor || report.strobeDelay || report.strobeLength)) {
        fail('an exposure without STROBE');
    }
    return r.end(report);
}

export function readPong(bytes) {
    const r = new Reader(bytes, ID.PONG);
    return r.end({ boot: r.notZero(r.u32(4), 'boot'), reportNumber: r.u32(8), pingId: r.u32(12),
        received: r.time(16, 32), sent: r.time(24, 33) });
}

export function readStatus(bytes) {
    const r = new Reader(bytes, ID.STATUS);
    return r.end({
        state: r.range(r.u8(2), 0, 4, 'state'), resetCause: r.range(r.u8(3), 0, 4, 'cause'),
        boot: r.notZero(r.u32(4), 'boot'), session: r.u32(8), reportNumber: r.u32(12),
        uptimeUs: r.u64(16), number: r.u32(24), firstRunNumber: r.u32(28), glitches: r.u32(32),
        startsRefused: r.u32(36), strobesMissing: r.u32(40), dropped: r.u32(44),
        commandsRefused: r.u32(48), reenumerations: r.u16(52), settingsCrc: r.u16(54),
    });
}

export function readEvent(bytes) {
    const r = new Reader(bytes, ID.EVENT);
    return r.end({
        kind: r.range(r.u8(2), 1, 12, 'kind'), state: r.range(r.u8(3), 0, 4, 'state'),
        boot: r.notZero(r.u32(4), 'boot'), session: r.u32(8), reportNumber: r.u32(12),
        eventNumber: r.u32(16), time: r.time(20, 28), argument: r.u32(32), detail: r.u32(36),
    });
}

export function readCommand(bytes) {
    const r = new Reader(bytes, ID.COMMAND);
    const report = { opcode: r.range(r.u8(2), 1, 3, 'opcode'), argument: r.u32(4) };
    if (report.opcode === OPCODE.ARM) {
        r.notZero(report.argument, 'session');
    } else if (report.opcode === OPCODE.DISARM) {
        r.range(report.argument, 0, 0, 'argument');
    }
    return r.end(report);
}

export function readIdentity(bytes) {
    const r = new Reader(bytes, ID.IDENTITY);
    const ascii = (at, size) => Buffer.from(r.array(at, size)).toString('latin1');
    const report = {
        capabilities: r.bits(r.u16(2), 0xf, 'capabilities'), magic: ascii(4, 4),
        hardware: r.u16(8), firmware: [r.u8(10), r.u8(11), r.u8(12)],
        modified: r.bits(r.u8(13), 1, 'modified') === 1, startCycles: r.u16(14),
        uniqueId: r.array(16, 8), gitHash: ascii(24, 20), clockHz: r.notZero(r.u32(44), 'clock'),
        ringEntries: r.u16(48), historyEntries: r.u16(50), boot: r.notZero(r.u32(52), 'boot'),
    };
    if (report.magic !== 'OPMS' || !/^[0-9a-f]{20}$/.test(report.gitHash)) {
        fail(`magic ${report.magic}, git hash ${report.gitHash}`);
    }
    return r.end(report);
}

function readSettingsFields(r) {
    const bits = r.bits(r.u8(16), 0xf, 'bits'), gapsAll = [];
    const settings = {
        periodUs: r.range(r.u32(4), 10000, 10000000, 'period'), widthUs: r.u32(8),
        debounceCycles: r.range(r.u32(12), 0, 1250000, 'debounce'), trigActiveLow: !!(bits & 1),
        startFallingEdge: !!(bits & 2), strobeEnabled: !!(bits & 4),
        strobeActiveLow: !!(bits & 8), sync: r.range(r.u8(17), 0, 2, 'sync'),
        waitTimeoutS: r.u16(18), preambleMs: [],
    };
    r.range(settings.widthUs, 10, settings.periodUs - 1000, 'width');
    for (let index = 0; index < 8; index++) {
        gapsAll.push(r.u16(20 + 2 * index));
    }
    const end = gapsAll.indexOf(0) < 0 ? 8 : gapsAll.indexOf(0);
    settings.preambleMs = gapsAll.slice(0, end);
    if (gapsAll.slice(end).some((gap) => gap)) {
        fail('a gap behind the end of the preamble');
    }
    settings.preambleMs.forEach((gap) => {
        r.range(gap, 10, 10000, 'gap');
        r.range(gap * 1000, settings.widthUs + 1000, Infinity, 'gap');
    });
    return settings;
}

/** What a GET of SETTINGS returned. */
export function readSettings(bytes) {
    const r = new Reader(bytes, ID.SETTINGS), bits = r.bits(r.u8(3), 3, 'flags');
    const report = { lastSet: r.range(r.u8(2), 0, 9, 'refusal'), pending: !!(bits & 1),
        stored: !!(bits & 2), settings: readSettingsFields(r), crc: r.u16(36) };
    if (report.crc !== crc16(r.bytes.subarray(4, 36))) {
        fail('CRC of the settings');
    }
    return r.end(report);
}

/** What a SET of SETTINGS holds. */
export function readSettingsSet(bytes) {
    const r = new Reader(bytes, ID.SETTINGS);
    r.range(r.u8(2), 0, 0, 'refusal');
    r.range(r.u8(3), 0, 0, 'flags');
    r.range(r.u16(36), 0, 0, 'CRC');
    return r.end(readSettingsFields(r));
}

export function readHistoryRequest(bytes) {
    const r = new Reader(bytes, ID.HISTORY);
    return r.end({ token: r.notZero(r.u16(2), 'token'), session: r.notZero(r.u32(4), 'session'),
        first: r.notZero(r.u32(8), 'first'), count: r.range(r.u16(12), 1, 8192, 'count') });
}

function readEntry(r, at, number) {
    const entry = { number, time: r.time(at, at + 16), strobeDelay: r.u32(at + 8),
        strobeLength: r.u32(at + 12), flags: r.bits(r.u16(at + 18), 0x7f, 'flags') };
    if (entry.flags & FLAG.NOT_HELD && (entry.flags !== FLAG.NOT_HELD || entry.time)) {
        fail('NOT_HELD with something else');
    }
    if (!(entry.flags & FLAG.NOT_HELD)) {
        checkFlags(entry.flags);
    }
    if (!(entry.flags & FLAG.STROBE) && (entry.strobeDelay || entry.strobeLength)) {
        fail('an exposure without STROBE');
    }
    return entry;
}

export function readHistory(bytes) {
    const r = new Reader(bytes, ID.HISTORY);
    const report = { token: r.u16(2), boot: r.notZero(r.u32(4), 'boot'), session: r.u32(8),
        first: r.u32(12), remaining: r.u16(16), count: r.range(r.u8(18), 0, 2, 'count'),
        entries: [] };
    r.range(report.remaining + report.count, 0, report.count ? 8192 : 0, 'remaining');
    if (!report.count) {
        r.range(report.first, 0, 0, 'first');
    }
    for (let index = 0; index < report.count; index++) {
        report.entries.push(readEntry(r, 20 + 20 * index, (report.first + index) >>> 0));
    }
    return r.end(report);
}

export function readBootloader(bytes) {
    const r = new Reader(bytes, ID.BOOTLOADER);
    return r.end({ magic: r.range(r.u32(4), BOOTLOADER_MAGIC, BOOTLOADER_MAGIC, 'magic') });
}

/** An input report by its id: {id, ...}. */
export function readInput(bytes) {
    const readers = { 1: readTrigger, 2: readPong, 3: readStatus, 4: readEvent };
    const reader = readers[bytes[0]] ?? fail(`input report ${bytes[0]}`);
    return { id: bytes[0], ...reader(bytes) };
}
