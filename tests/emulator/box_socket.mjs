// SPDX-License-Identifier: Apache-2.0
/** Messages of docs/emulated-box.md: `u32 length, u8 kind, payload`, little-endian. The wires'
 * socket has a kind of its own besides. */

export const KIND = { ATTACHED: 1, DETACHED: 2, INPUT: 3, DONE: 4, EDGE: 5, EXPOSURE: 6,
    EXPOSING: 7, OUTPUT: 16, GET: 17, SET: 18, LINE: 19, PLUG: 20, POWER: 21, WATCH: 22,
    EXPOSE: 23 };
export const STATUS = { DONE: 0, STALLED: 1, GONE: 2, TIMED_OUT: 3 };
const PAYLOAD = { [KIND.OUTPUT]: 68, [KIND.GET]: 7, [KIND.SET]: 68, [KIND.LINE]: 10,
    [KIND.PLUG]: 1, [KIND.POWER]: 0, [KIND.WATCH]: 1 };
export const WIRES_PAYLOAD = { [KIND.EXPOSE]: 16 };

export class SocketError extends Error {}

function message(kind, size, fill = () => undefined) {
    const bytes = Buffer.alloc(5 + size);
    bytes.writeUInt32LE(1 + size, 0);
    bytes.writeUInt8(kind, 4);
    fill(bytes.subarray(5));
    return bytes;
}

export function attached({ device, strings }) {
    const view = new DataView(device.buffer, device.byteOffset, device.length);
    const serial = Buffer.from(strings.serial ?? '', 'latin1');
    const product = Buffer.from(strings.product ?? '', 'latin1');
    return message(KIND.ATTACHED, 8 + serial.length + product.length, (payload) => {
        [8, 10, 12].forEach((at, index) =>
            payload.writeUInt16LE(view.getUint16(at, true), 2 * index));
        payload.writeUInt8(serial.length, 6);
        serial.copy(payload, 7);
        payload.writeUInt8(product.length, 7 + serial.length);
        product.copy(payload, 8 + serial.length);
    });
}

export const detached = () => message(KIND.DETACHED, 0);

export const input = (bytes) => message(KIND.INPUT, bytes.length, (payload) => payload.set(bytes));

export const done = (request, status, bytes = []) =>
    message(KIND.DONE, 5 + bytes.length, (payload) => {
        payload.writeUInt32LE(request, 0);
        payload.writeUInt8(status, 4);
        payload.set(bytes, 5);
    });

export const edge = (line, level, ns) => message(KIND.EDGE, 10, (payload) => {
    payload.writeUInt8(line, 0);
    payload.writeUInt8(level, 1);
    payload.writeBigUInt64LE(BigInt(ns), 2);
});

export const exposure = (triggerNs, delayNs, lengthNs) =>
    message(KIND.EXPOSURE, 24, (payload) => [triggerNs, delayNs, lengthNs].forEach((ns, index) =>
        payload.writeBigUInt64LE(BigInt(ns), 8 * index)));

export const exposing = () => message(KIND.EXPOSING, 0);

/** Cuts what arrives into messages. */
export class MessageReader {
    /** @param payload  bytes of the payload by kind. */
    constructor(payload = PAYLOAD) {
        this.payload = payload;
        this.rest = Buffer.alloc(0);
    }

    /** @returns [{kind, payload}]; throws SocketError at what no host may send. */
    take(chunk) {
        this.rest = Buffer.concat([this.rest, chunk]);
        const messages = [];
        while (this.rest.length >= 5) {
            const length = this.rest.readUInt32LE(0), kind = this.rest.readUInt8(4);
            if (!(kind in this.payload)) {
                throw new SocketError(`message of unknown kind ${kind}`);
            }
            if (length !== 1 + this.payload[kind]) {
                throw new SocketError(`message of kind ${kind} with length ${length}`);
            }
            if (this.rest.length < 4 + length) {
                break;
            }
            messages.push({ kind, payload: this.rest.subarray(5, 4 + length) });
            this.rest = this.rest.subarray(4 + length);
        }
        return messages;
    }
}
