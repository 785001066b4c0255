// SPDX-License-Identifier: Apache-2.0
/** One connected host of the emulated box: its messages to the board, the board's to it. */
import * as socketMessages from './box_socket.mjs';

const { KIND, STATUS } = socketMessages;
const NS_PER_CYCLE = 8, LINES = ['START', 'STROBE', 'TRIG', 'SYNC'], DRIVEN = 2;
const SET_REPORT = { type: 0x21, request: 9 }, GET_REPORT = { type: 0xa1, request: 1 };
const FEATURE = 3 << 8, OFF_CYCLES = 12500000;

export class BoxSession {
    /** @param box  {board, host, pins} @param write  (bytes) to the connected host. */
    constructor(box, write) {
        this.box = box;
        this.write = write;
        this.reader = new socketMessages.MessageReader();
        this.watches = false;
    }

    /** Bytes from the host. Throws SocketError where they are not messages. */
    take(chunk) {
        for (const { kind, payload } of this.reader.take(chunk)) {
            this.#carryOut(kind, payload);
        }
    }

    edge(pin, level, cycle) {
        const line = LINES.findIndex((name) => this.box.pins[name] === pin);
        if (this.watches && line >= 0) {
            this.write(socketMessages.edge(line, level, cycle * NS_PER_CYCLE));
        }
    }

    #carryOut(kind, payload) {
        const { board, host } = this.box;
        switch (kind) {
            case KIND.OUTPUT: this.#output(payload.readUInt32LE(0), payload.subarray(4)); break;
            case KIND.GET: this.#get(payload); break;
            case KIND.SET: this.#set(payload.readUInt32LE(0), payload.subarray(4)); break;
            case KIND.LINE: this.#line(payload); break;
            case KIND.PLUG: host.plug(payload.readUInt8(0) !== 0); break;
            case KIND.POWER:
                board.powerOff();
                board.at(board.now + OFF_CYCLES, () => board.isOn || board.powerOn());
                break;
            default: this.watches = payload.readUInt8(0) !== 0; // WATCH
        }
    }

    #output(request, bytes) {
        const { host } = this.box, [endpoint] = host.device?.outEndpoints ?? [0];
        host.send(endpoint, Uint8Array.from(bytes), (result) => this.#answer(request, result));
    }

    #get(payload) {
        const request = payload.readUInt32LE(0), id = payload.readUInt8(4);
        this.#control(request, { ...GET_REPORT, value: FEATURE | id,
            length: payload.readUInt16LE(5) });
    }

    #set(request, bytes) {
        this.#control(request, { ...SET_REPORT, value: FEATURE | bytes[0], length: bytes.length,
            data: Uint8Array.from(bytes) });
    }

    #control(request, transfer) {
        const { host } = this.box;
        if (!host.device) {
            this.#answer(request, 'GONE');
            return;
        }
        host.submit(transfer, (result) => this.#answer(request, result));
    }

    #answer(request, result) {
        if (typeof result !== 'string') {
            this.write(socketMessages.done(request, STATUS.DONE, result));
            return;
        }
        const status = { OK: STATUS.DONE, ACK: STATUS.DONE, STALL: STATUS.STALLED,
            GONE: STATUS.GONE, NONE: STATUS.TIMED_OUT, TIMEOUT: STATUS.TIMED_OUT }[result];
        this.write(socketMessages.done(request, status));
    }

    #line(payload) {
        const line = payload.readUInt8(0), level = payload.readUInt8(1) ? 1 : 0;
        if (line >= DRIVEN) {
            throw new socketMessages.SocketError(`line ${line} cannot be driven`);
        }
        const { board, pins } = this.box;
        const delay = Number(payload.readBigUInt64LE(2)) / NS_PER_CYCLE;
        board.at(Math.round(board.cycle + delay), () => board.drive(pins[LINES[line]], level));
    }
}
