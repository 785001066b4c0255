// SPDX-License-Identifier: Apache-2.0
/** A parser of HID report descriptors by the HID 1.11 specification, section 6.2.2, written for the
 * tests alone: it shares nothing with the firmware that wrote the descriptor. */

const MAIN = 0, GLOBAL = 1, LOCAL = 2;
const MAIN_ITEMS = { 0x8: 'input', 0x9: 'output', 0xb: 'feature', 0xa: 'collection', 0xc: 'end' };
const GLOBAL_ITEMS = ['usagePage', 'logicalMinimum', 'logicalMaximum', 'physicalMinimum',
    'physicalMaximum', 'unitExponent', 'unit', 'reportSize', 'reportId', 'reportCount', 'push',
    'pop'];
const LOCAL_ITEMS = ['usage', 'usageMinimum', 'usageMaximum'];
const SIGNED = new Set(['logicalMinimum', 'logicalMaximum', 'physicalMinimum', 'physicalMaximum']);

export class DescriptorError extends Error {}

function numberOf(bytes, isSigned) {
    let value = 0;
    bytes.forEach((byte, index) => {
        value += byte * 2 ** (8 * index);
    });
    const range = 2 ** (8 * bytes.length);
    return isSigned && bytes.length && value >= range / 2 ? value - range : value;
}

/** The items of a descriptor: {type, tag, data}. */
function* items(bytes) {
    for (let at = 0; at < bytes.length;) {
        const prefix = bytes[at];
        if (prefix === 0xfe) {
            throw new DescriptorError(`long item at ${at}: none is defined`);
        }
        const size = [0, 1, 2, 4][prefix & 3];
        if (at + 1 + size > bytes.length) {
            throw new DescriptorError(`the item at ${at} is cut off`);
        }
        yield { at, type: (prefix >> 2) & 3, tag: prefix >> 4,
            data: bytes.subarray(at + 1, at + 1 + size) };
        at += 1 + size;
    }
}

class Parser {
    constructor() {
        this.globals = {};
        this.stack = [];
        this.locals = { usages: [] };
        this.open = [];
        this.collections = [];
        this.reports = new Map(); // "input 1" -> {kind, id, bits, fields}
    }

    take(item) {
        switch (item.type) {
            case MAIN: this.#main(item); break;
            case GLOBAL: this.#global(item); break;
            case LOCAL: this.#local(item); break;
            default: throw new DescriptorError(`reserved item at ${item.at}`);
        }
    }

    #global({ at, tag, data }) {
        const name = GLOBAL_ITEMS[tag];
        if (!name) {
            throw new DescriptorError(`unknown global item at ${at}`);
        }
        if (name === 'push') {
            this.stack.push({ ...this.globals });
        } else if (name === 'pop') {
            if (!this.stack.length) {
                throw new DescriptorError(`pop without push at ${at}`);
            }
            this.globals = this.stack.pop();
        } else {
            this.globals[name] = numberOf(data, SIGNED.has(name));
        }
        if (name === 'reportId' && (this.globals.reportId < 1 || this.globals.reportId > 255)) {
            throw new DescriptorError(`report id ${this.globals.reportId} at ${at}`);
        }
    }

    #local({ at, tag, data }) {
        const name = LOCAL_ITEMS[tag];
        if (!name) {
            throw new DescriptorError(`local item ${tag} at ${at} is not known to this parser`);
        }
        const value = numberOf(data, false);
        const usage = data.length === 4 ? value : (this.globals.usagePage ?? 0) * 65536 + value;
        if (name === 'usage') {
            this.locals.usages.push(usage);
        } else {
            this.locals[name] = usage;
        }
    }

    #main({ at, tag, data }) {
        const kind = MAIN_ITEMS[tag];
        if (!kind) {
            throw new DescriptorError(`unknown main item at ${at}`);
        }
        if (kind === 'collection') {
            const made = { type: numberOf(data, false), usage: this.locals.usages[0] ?? 0 };
            (this.open.length ? this.open[this.open.length - 1].inside : this.collections)
                .push(made);
            made.inside = [];
            this.open.push(made);
        } else if (kind === 'end') {
            if (!this.open.pop()) {
                throw new DescriptorError(`end of no collection at ${at}`);
            }
        } else {
            this.#field(at, kind, numberOf(data, false));
        }
        this.locals = { usages: [] };
    }

    #field(at, kind, flags) {
        const { reportSize, reportCount, reportId = 0, logicalMinimum, logicalMaximum } =
            this.globals;
        if (!this.open.length) {
            throw new DescriptorError(`${kind} outside of a collection at ${at}`);
        }
        if (!reportSize || !reportCount) {
            throw new DescriptorError(`${kind} without size or count at ${at}`);
        }
        if (logicalMinimum === undefined || logicalMaximum === undefined ||
            logicalMinimum > logicalMaximum) {
            throw new DescriptorError(`${kind} without a logical range at ${at}`);
        }
        const isConstant = (flags & 1) === 1;
        if (!isConstant && !this.locals.usages.length && this.locals.usageMinimum === undefined) {
            throw new DescriptorError(`${kind} without a usage at ${at}`);
        }
        const key = `${kind} ${reportId}`;
        const report = this.reports.get(key) ?? { kind, id: reportId, bits: 0, fields: [] };
        report.fields.push({ flags, reportSize, reportCount, logicalMinimum, logicalMaximum,
            usages: this.locals.usages });
        report.bits += reportSize * reportCount;
        this.reports.set(key, report);
    }

    finish() {
        if (this.open.length) {
            throw new DescriptorError('a collection is not closed');
        }
        const reports = [...this.reports.values()];
        const numbered = reports.filter((report) => report.id !== 0).length;
        if (numbered && numbered !== reports.length) {
            throw new DescriptorError('some reports have an id and some have none');
        }
        return { collections: this.collections, reports: reports.map((report) => {
            if (report.bits % 8) {
                throw new DescriptorError(`${report.kind} ${report.id}: ${report.bits} bits`);
            }
            return { ...report, bytes: report.bits / 8 + (report.id ? 1 : 0) };
        }) };
    }
}

/** @returns {collections, reports: [{kind, id, bytes, fields}]}, the id counted in `bytes`. */
export function parseReportDescriptor(bytes) {
    const parser = new Parser();
    for (const item of items(Uint8Array.from(bytes))) {
        parser.take(item);
    }
    return parser.finish();
}
