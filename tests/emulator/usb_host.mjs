// SPDX-License-Identifier: Apache-2.0
/** An honest full-speed host: frames of 1 ms, tokens that may be NAKed or stalled, data toggles
 * that are checked, bus resets, suspend. It enumerates a device as soon as it shows itself.
 *
 * All of it happens in events of the board's time, so that it goes on whoever runs the board. */
import { enumerate } from './usb_enumerate.mjs';

export const MS = 125000;
const FIRST_SLOT = 2500, LAST_SLOT = 0.9 * MS, RETRY = 5000, BYTE = 84, OVERHEAD = 1000;
const EP0_SIZE = 64, CONTROL_TIMEOUT = 5000 * MS, SUSPEND_AFTER = 3 * MS;

export class UsbHost {
    /** @param options  {enumerates}: false to leave the device alone after the first bus reset. */
    constructor(board, { enumerates = true } = {}) {
        this.board = board;
        this.enumerates = enumerates;
        this.errors = [];       // violations of the protocol by the device
        this.onInput = () => undefined;    // (endpoint, data, cycle)
        this.onReady = () => undefined;    // enumerated
        this.onGone = () => undefined;     // detached
        this.hammer = null;     // () => control request, asked for whenever nothing else is to do
        this.polls = true;      // the IN endpoints, once they are known
        this.plugged = true;
        this.counts = { naks: 0, inputs: 0, controls: 0, resets: 0, attaches: 0 };
        this.board.onAttach = (attached) => this.#pullupChanged(attached);
        this.pullup = false;
        this.#forget();
    }

    #forget() {
        this.connected = false;  // the host has seen the device
        this.device = null;      // what enumeration found out
        this.address = 0;
        this.toggles = new Map();
        this.control = null;     // the transfer that is going on
        this.controlQueue = [];
        this.outQueue = [];
        this.script = null;
        this.framesFrom = Infinity;
        this.frame = 0;
        this.suspended = false;
    }

    get #usb() {
        return this.board.chip?.usb;
    }

    get #now() {
        return this.board.cycle;
    }

    // --- the cable ------------------------------------------------------------------------------

    #pullupChanged(attached) {
        this.pullup = attached;
        this.#updateConnection();
    }

    plug(on) {
        this.plugged = on;
        if (!on && this.#usb) {
            const usb = this.#usb;
            this.board.at(this.#now + SUSPEND_AFTER, () => !this.plugged && usb.suspend());
        }
        this.#updateConnection();
    }

    #updateConnection() {
        const connected = this.pullup && this.plugged;
        if (connected === this.connected) {
            return;
        }
        if (!connected) {
            this.#disconnect();
            return;
        }
        this.connected = true;
        this.counts.attaches++;
        if (this.enumerates) {
            this.run(enumerate());
        }
    }

    #disconnect() {
        const open = [this.control, ...this.controlQueue, ...this.outQueue].filter(Boolean);
        const wasReady = this.device !== null;
        this.board.cancel(this.frameEvent);
        this.board.cancel(this.slotEvent);
        this.board.cancel(this.scriptEvent);
        this.#forget();
        open.forEach((transfer) => transfer.done('GONE'));
        if (wasReady) {
            this.onGone();
        }
    }

    // --- scripts: generators that yield what is to be done --------------------------------------

    /** Carry out a script: it yields {wait}, {reset}, {address}, {ready} or {control} and gets the
     * result of the latter. */
    run(script) {
        this.script = script;
        this.#stepScript(script, undefined);
    }

    #stepScript(script, value) {
        if (this.script !== script) {
            return; // the device is gone
        }
        const { done, value: wish } = script.next(value);
        if (done) {
            this.script = null;
            return;
        }
        const next = (result) => this.#stepScript(script, result);
        if (wish.wait) {
            this.scriptEvent = this.board.at(this.#now + wish.wait, next);
        } else if (wish.reset) {
            this.busReset(next);
        } else if (wish.control) {
            this.submit(wish.control, next);
        } else {
            if (wish.address !== undefined) {
                this.address = wish.address;
            }
            if (wish.ready) {
                this.device = wish.ready;
                this.onReady(this.device);
            }
            next();
        }
    }

    busReset(done = () => undefined) {
        this.counts.resets++;
        this.address = 0;
        this.toggles.clear();
        this.#stopFrames();
        this.board.at(this.#now + 10 * MS, () => {
            this.#usb?.busReset();
            this.#startFrames(this.#now + 100);
            this.scriptEvent = this.board.at(this.#now + 10 * MS, () => done());
        });
    }

    suspend() {
        this.suspended = true;
        this.#stopFrames();
        this.board.at(this.#now + SUSPEND_AFTER, () => this.suspended && this.#usb?.suspend());
    }

    resume() {
        this.suspended = false;
        this.#usb?.resume();
        this.#startFrames(this.#now + 20 * MS);
    }

    // --- frames ---------------------------------------------------------------------------------

    #stopFrames() {
        this.board.cancel(this.frameEvent);
        this.board.cancel(this.slotEvent);
    }

    #startFrames(cycle) {
        this.framesFrom = cycle;
        this.frameEvent = this.board.at(cycle, () => this.#beginFrame());
    }

    #beginFrame() {
        this.frameEvent = this.board.at(this.framesFrom + MS, () => this.#beginFrame());
        this.frameStart = this.framesFrom;
        this.framesFrom += MS;
        this.frame++;
        this.#usb?.startOfFrame(this.frame);
        this.periodic = [];
        if (this.device) {
            if (this.polls) {
                this.periodic.push(...this.device.inEndpoints.map((ep) => () => this.#pollIn(ep)));
            }
            if (this.outQueue.length) {
                this.periodic.push(() => this.#sendOut());
            }
        }
        if (this.periodic.length || this.control || this.controlQueue.length || this.hammer) {
            this.#slotAt(this.frameStart + FIRST_SLOT);
        }
    }

    #slotAt(cycle) {
        this.slotEvent = this.board.at(cycle, () => this.#slot());
    }

    /** One transaction, then the next, as long as the frame has room. */
    #slot() {
        const transaction = this.periodic.shift() ?? this.#controlTransaction();
        const duration = transaction && this.connected ? transaction() : 0;
        const next = this.#now + OVERHEAD + duration;
        if (transaction && this.connected && next < this.frameStart + LAST_SLOT) {
            this.#slotAt(next);
        }
    }

    // --- interrupt endpoints --------------------------------------------------------------------

    #toggle(key) {
        return this.toggles.get(key) ?? 0;
    }

    #pollIn(endpoint) {
        if (!this.#usb?.listens(this.address)) {
            return RETRY;
        }
        const answer = this.#usb.in(endpoint);
        if (answer.kind !== 'DATA') {
            this.counts.naks++;
            if (answer.kind !== 'NAK') {
                this.errors.push(`IN ${endpoint}: ${answer.kind}`);
            }
            return 0;
        }
        const key = `in${endpoint}`;
        if (answer.toggle !== this.#toggle(key)) {
            this.errors.push(`IN ${endpoint}: DATA${answer.toggle} out of turn`);
        } else {
            this.toggles.set(key, answer.toggle ^ 1);
            this.counts.inputs++;
            this.onInput(endpoint, answer.data, this.#now);
        }
        return answer.data.length * BYTE;
    }

    /** Send bytes to an interrupt OUT endpoint. @param done  called with 'ACK', 'STALL', 'GONE' */
    send(endpoint, data, done = () => undefined) {
        if (!this.device) {
            done('GONE');
            return;
        }
        this.outQueue.push({ endpoint, data, done });
    }

    #sendOut() {
        const [transfer] = this.outQueue;
        if (!transfer || !this.#usb?.listens(this.address)) {
            return RETRY;
        }
        const key = `out${transfer.endpoint}`;
        const answer = this.#usb.out(transfer.endpoint, transfer.data, this.#toggle(key));
        if (answer === 'NAK' || answer === 'NONE') {
            this.counts.naks++;
            return RETRY;
        }
        if (answer === 'REPEATED') {
            this.errors.push(`OUT ${transfer.endpoint}: the device expected the other toggle`);
        }
        this.toggles.set(key, this.#toggle(key) ^ 1);
        this.outQueue.shift();
        transfer.done(answer === 'STALL' ? 'STALL' : 'ACK');
        return transfer.data.length * BYTE;
    }

    // --- control transfers ----------------------------------------------------------------------

    /** @param request  {type, request, value, index, length, data, timeout}
     *  @param done  called with a Uint8Array, 'OK', 'STALL', 'TIMEOUT' or 'GONE'. */
    submit(request, done) {
        if (!this.connected) {
            done('GONE');
            return;
        }
        this.controlQueue.push({ request, done });
        if (!this.control && this.frameStart !== undefined && this.periodic?.length === 0) {
            this.board.cancel(this.slotEvent);
            if (this.#now + OVERHEAD < this.frameStart + LAST_SLOT) {
                this.#slotAt(this.#now + OVERHEAD);
            }
        }
    }

    #controlTransaction() {
        if (!this.control && !this.controlQueue.length && this.hammer && this.device) {
            const request = this.hammer();
            if (request) {
                this.controlQueue.push({ request, done: request.done ?? (() => undefined) });
            }
        }
        if (!this.control && this.controlQueue.length) {
            this.control = { ...this.controlQueue.shift(), stage: 'setup', toggle: 1, bytes: [],
                since: this.#now };
            this.counts.controls++;
        }
        return this.control ? () => this.#controlStep() : null;
    }

    #controlStep() {
        const transfer = this.control, usb = this.#usb;
        const limit = transfer.request.timeout ?? CONTROL_TIMEOUT;
        if (this.#now - transfer.since > limit) {
            return this.#endControl('TIMEOUT');
        }
        if (!usb?.listens(this.address)) {
            return RETRY;
        }
        switch (transfer.stage) {
            case 'setup': return this.#setupStage(transfer, usb);
            case 'in': return this.#dataIn(transfer, usb);
            case 'out': return this.#dataOut(transfer, usb);
            case 'statusIn': return this.#statusIn(transfer, usb);
            default: return this.#statusOut(transfer, usb);
        }
    }

    #setupStage(transfer, usb) {
        const { type, request, value = 0, index = 0, length = 0 } = transfer.request;
        usb.setup([type, request, value & 255, value >> 8, index & 255, index >> 8, length & 255,
            length >> 8]);
        const isIn = (type & 0x80) !== 0;
        transfer.stage = length === 0 ? 'statusIn' : isIn ? 'in' : 'out';
        return 8 * BYTE + RETRY;
    }

    #nak() {
        this.counts.naks++;
        return RETRY;
    }

    #dataIn(transfer, usb) {
        const answer = usb.in(0);
        if (answer.kind === 'NAK') {
            return this.#nak();
        }
        if (answer.kind !== 'DATA') {
            return this.#endControl(answer.kind);
        }
        if (answer.toggle !== transfer.toggle) {
            this.errors.push(`control IN: DATA${answer.toggle} out of turn`);
        }
        transfer.toggle ^= 1;
        transfer.bytes.push(...answer.data);
        const { length } = transfer.request;
        if (transfer.bytes.length > length) {
            this.errors.push(`control IN: ${transfer.bytes.length} bytes where ${length} asked`);
        }
        if (answer.data.length < EP0_SIZE || transfer.bytes.length >= length) {
            transfer.stage = 'statusOut';
        }
        return answer.data.length * BYTE;
    }

    #dataOut(transfer, usb) {
        const rest = Uint8Array.from(transfer.request.data).subarray(transfer.bytes.length);
        const packet = rest.subarray(0, EP0_SIZE);
        const answer = usb.out(0, packet, transfer.toggle);
        if (answer === 'NAK') {
            return this.#nak();
        }
        if (answer === 'STALL') {
            return this.#endControl(answer);
        }
        if (answer !== 'ACK') {
            this.errors.push(`control OUT: ${answer}`);
        }
        transfer.toggle ^= 1;
        transfer.bytes.push(...packet);
        if (transfer.bytes.length >= transfer.request.length) {
            transfer.stage = 'statusIn';
        }
        return packet.length * BYTE;
    }

    #statusIn(transfer, usb) {
        const answer = usb.in(0);
        if (answer.kind === 'NAK') {
            return this.#nak();
        }
        if (answer.kind !== 'DATA') {
            return this.#endControl(answer.kind);
        }
        if (answer.data.length || answer.toggle !== 1) {
            this.errors.push(`status: DATA${answer.toggle} with ${answer.data.length} bytes`);
        }
        return this.#endControl('OK');
    }

    #statusOut(transfer, usb) {
        const answer = usb.out(0, new Uint8Array(0), 1);
        if (answer === 'NAK') {
            return this.#nak();
        }
        if (answer !== 'ACK') {
            this.errors.push(`status: ${answer}`);
        }
        return this.#endControl(answer === 'STALL' ? answer : Uint8Array.from(transfer.bytes));
    }

    #endControl(result) {
        const { done } = this.control;
        this.control = null;
        done(result);
        return 0;
    }
}
