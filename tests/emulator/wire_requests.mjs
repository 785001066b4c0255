// SPDX-License-Identifier: Apache-2.0
/** Reports that a host sends, by docs/wire.md. */
import { BOOTLOADER_MAGIC, CRC_AT, ID, PROTOCOL, SIZE, crc16 } from './wire_reports.mjs';

/** Put the CRC where it belongs; also after something was changed on purpose. */
export function seal(bytes) {
    new DataView(bytes.buffer, bytes.byteOffset).setUint16(CRC_AT, crc16(bytes.subarray(0, CRC_AT)),
        true);
    return bytes;
}

function make(id, fill) {
    const bytes = new Uint8Array(SIZE);
    bytes[0] = id;
    bytes[1] = PROTOCOL;
    fill(new DataView(bytes.buffer));
    return seal(bytes);
}

export const command = (opcode, argument = 0) => make(ID.COMMAND, (view) => {
    view.setUint8(2, opcode);
    view.setUint32(4, argument, true);
});

export const DEFAULTS = Object.freeze({ periodUs: 100000, widthUs: 1000, debounceCycles: 125,
    trigActiveLow: false, startFallingEdge: false, strobeEnabled: false, strobeActiveLow: false,
    sync: 0, waitTimeoutS: 0, preambleMs: [100, 200, 100, 300, 100] });

/** @param changes  what differs from the defaults. */
export function settingsSet(changes = {}) {
    const s = { ...DEFAULTS, ...changes };
    return make(ID.SETTINGS, (view) => {
        view.setUint32(4, s.periodUs, true);
        view.setUint32(8, s.widthUs, true);
        view.setUint32(12, s.debounceCycles, true);
        view.setUint8(16, (s.trigActiveLow ? 1 : 0) | (s.startFallingEdge ? 2 : 0) |
            (s.strobeEnabled ? 4 : 0) | (s.strobeActiveLow ? 8 : 0));
        view.setUint8(17, s.sync);
        view.setUint16(18, s.waitTimeoutS, true);
        s.preambleMs.forEach((gap, index) => view.setUint16(20 + 2 * index, gap, true));
    });
}

export const historyRequest = ({ token, session, first, count }) => make(ID.HISTORY, (view) => {
    view.setUint16(2, token, true);
    view.setUint32(4, session, true);
    view.setUint32(8, first, true);
    view.setUint16(12, count, true);
});

export const bootloader = (magic = BOOTLOADER_MAGIC) => make(ID.BOOTLOADER, (view) => {
    view.setUint32(4, magic, true);
});
