// SPDX-License-Identifier: Apache-2.0
/** The RP2040's USB controller as a device: registers, buffer memory, and what it answers to the
 * tokens of a host (usb_host.mjs). Nothing is completed unless a host asks for it. */
import { RegisterBlock } from './register_block.mjs';

const ADDR = 0, MAIN_CTRL = 0x40, SOF_WR = 0x44, SOF_RD = 0x48, SIE_CTRL = 0x4c, SIE_STATUS = 0x50;
const BUFF_STATUS = 0x58, CPU_HANDLE = 0x5c, ABORT = 0x60, ABORT_DONE = 0x64, STALL_ARM = 0x68;
const NAK_POLL = 0x6c, STALL_NAK = 0x70, MUXING = 0x74, PWR = 0x78;
const INTR = 0x8c, INTE = 0x90, INTF = 0x94, INTS = 0x98;
// SIE_STATUS
const SETUP_REC = 1 << 17, CONNECTED = 1 << 16, BUS_RESET = 1 << 19, RESUMED = 1 << 11;
const SUSPENDED = 1 << 4, VBUS = 1, DATA_SEQ_ERROR = 0x80000000, LINE_J = 1 << 2;
const WRITE_CLEARS = 0xff000000 | BUS_RESET | (1 << 18) | SETUP_REC | RESUMED | SUSPENDED;
// Buffer control
const AVAILABLE = 1 << 10, STALL = 1 << 11, DATA1 = 1 << 13, FULL = 1 << 15, LENGTH = 0x3ff;
const ENDPOINT_ENABLED = 0x80000000, IRQ_PER_BUFFER = 1 << 29, BUFFERS_OF_EP0 = 0x100;
const SOF_INTERRUPT = 1 << 17;
const KEPT_REGISTERS = [SOF_WR, NAK_POLL, MUXING, 0x54, 0x7c, 0x80, 0x84];

export class UsbDeviceBlock extends RegisterBlock {
    constructor(chip) {
        super(chip, 'USBCTRL');
        this.onPullup = () => undefined; // (attached) when the device shows or hides itself
        this.attached = false;
        this.reset();
    }

    /** A fault to test with: the IN endpoint's buffer never leaves, until the device shows itself
     * anew on the bus. */
    wedge(endpoint) {
        this.wedged = endpoint;
    }

    reset() {
        this.address = 0;
        this.mainCtrl = this.sieCtrl = this.sieStatus = this.buffStatus = 0;
        this.abort = this.abortDone = this.stallArm = this.stallNak = 0;
        this.power = 0;
        this.wedged = 0;
        this.inte = this.intf = 0;
        this.sofInterrupt = false;
        this.frame = 0;
        this.kept = new Map();
        this.#updateAttached();
        this.#updateInterrupts();
    }

    /** rp2040js tells each write to the buffer memory; a buffer goes when a host asks for it. */
    DPRAMUpdated(offset, value) {
        if (offset >= 0x80 && offset < 0x100 && value & (AVAILABLE << 16)) {
            this.chip.fault('USBCTRL: double buffering is not modelled');
        }
    }

    // --- registers ------------------------------------------------------------------------------

    get #raw() {
        const s = this.sieStatus;
        return (this.buffStatus ? 1 << 4 : 0) | (s & BUS_RESET ? 1 << 12 : 0) |
            (s & SUSPENDED ? 1 << 14 : 0) | (s & RESUMED ? 1 << 15 : 0) |
            (s & SETUP_REC ? 1 << 16 : 0) | (s & DATA_SEQ_ERROR ? 1 << 5 : 0) |
            (this.sofInterrupt ? SOF_INTERRUPT : 0) | (this.abortDone ? 1 << 18 : 0) |
            (this.stallNak ? 1 << 19 : 0);
    }

    get #ints() {
        return (this.#raw & this.inte) | this.intf;
    }

    #updateInterrupts() {
        this.chip.mcu?.setInterrupt(5, this.#ints !== 0);
    }

    #updateAttached() {
        const powered = (this.power & 0xc) === 0xc || (this.sieStatus & VBUS) !== 0;
        const attached = powered && (this.mainCtrl & 1) === 1 && (this.sieCtrl & (1 << 16)) !== 0;
        if (attached !== this.attached) {
            this.attached = attached;
            this.wedged = 0;
            this.onPullup(attached);
        }
    }

    peek(offset) {
        return offset === SOF_RD ? this.frame : this.read(offset);
    }

    read(offset) {
        switch (offset) {
            case ADDR: return this.address;
            case MAIN_CTRL: return this.mainCtrl;
            case SOF_RD:
                this.sofInterrupt = false;
                this.#updateInterrupts();
                return this.frame;
            case SIE_CTRL: return this.sieCtrl;
            case SIE_STATUS: return this.sieStatus | (this.attached ? LINE_J : 0);
            case BUFF_STATUS: return this.buffStatus;
            case CPU_HANDLE: return 0;
            case ABORT: return this.abort;
            case ABORT_DONE: return this.abortDone;
            case STALL_ARM: return this.stallArm;
            case STALL_NAK: return this.stallNak;
            case PWR: return this.power;
            case INTR: return this.#raw;
            case INTE: return this.inte;
            case INTF: return this.intf;
            case INTS: return this.#ints;
            default:
                return KEPT_REGISTERS.includes(offset) || (offset > ADDR && offset < MAIN_CTRL)
                    ? this.kept.get(offset) ?? 0 : this.unknownRead(offset);
        }
    }

    write(offset, value, raw) {
        switch (offset) {
            case ADDR: this.address = value & 0x7f; break;
            case MAIN_CTRL: this.mainCtrl = value; break;
            case SIE_CTRL: this.sieCtrl = value; break;
            case SIE_STATUS: this.sieStatus &= ~(raw & WRITE_CLEARS); break;
            case BUFF_STATUS: this.buffStatus &= ~raw; break;
            case ABORT: this.abort = value; this.abortDone |= value; break;
            case ABORT_DONE: this.abortDone &= ~raw; break;
            case STALL_ARM: this.stallArm = value & 3; break;
            case STALL_NAK: this.stallNak &= ~raw; break;
            case PWR: this.power = value; break;
            case INTE: this.inte = value; break;
            case INTF: this.intf = value; break;
            default: // the whole block may be cleared in one go, unused registers included
                this.kept.set(offset, value);
        }
        this.#updateAttached();
        this.#updateInterrupts();
    }

    // --- what a host does -----------------------------------------------------------------------

    #word(offset) {
        return this.chip.mcu.usbDPRAMView.getUint32(offset, true);
    }

    #setWord(offset, value) {
        this.chip.mcu.usbDPRAMView.setUint32(offset, value >>> 0, true);
    }

    busReset() {
        this.sieStatus |= BUS_RESET | CONNECTED;
        this.sieStatus &= ~SUSPENDED;
        this.#updateInterrupts();
    }

    startOfFrame(frame) {
        this.frame = frame & 0x7ff;
        this.sofInterrupt = true;
        this.sieStatus |= CONNECTED;
        if (this.inte & SOF_INTERRUPT) {
            this.#updateInterrupts();
        }
    }

    suspend() {
        this.sieStatus |= SUSPENDED;
        this.#updateInterrupts();
    }

    resume() {
        this.sieStatus = (this.sieStatus & ~SUSPENDED) | RESUMED;
        this.#updateInterrupts();
    }

    /** Does the device listen to this address? */
    listens(address) {
        return this.attached && this.address === address;
    }

    setup(bytes) {
        this.chip.mcu.usbDPRAM.set(bytes, 0);
        this.stallArm = 0;
        this.sieStatus |= SETUP_REC;
        this.#updateInterrupts();
    }

    /** @returns {kind: 'STALL' | 'NAK' | 'NONE' | 'DATA', data, toggle} */
    in(endpoint) {
        const control = this.#ready(endpoint, false);
        if (endpoint && endpoint === this.wedged) {
            return { kind: 'NAK' };
        }
        if (typeof control === 'string') {
            return { kind: control };
        }
        if (!(control & FULL)) {
            this.chip.fault(`USBCTRL: IN ${endpoint} made available without data`);
        }
        const from = this.#buffer(endpoint, false);
        const data = this.chip.mcu.usbDPRAM.slice(from, from + (control & LENGTH));
        this.#setWord(0x80 + endpoint * 8, control & ~(AVAILABLE | FULL));
        this.#complete(endpoint, false);
        return { kind: 'DATA', data, toggle: control & DATA1 ? 1 : 0 };
    }

    /** @returns 'STALL' | 'NAK' | 'NONE' | 'ACK', or 'REPEATED': taken for a repetition */
    out(endpoint, data, toggle) {
        const control = this.#ready(endpoint, true);
        if (typeof control === 'string') {
            return control;
        }
        if ((control & DATA1 ? 1 : 0) !== toggle) {
            this.sieStatus |= DATA_SEQ_ERROR;
            this.#updateInterrupts();
            return 'REPEATED'; // acknowledged and thrown away
        }
        if (data.length > (control & LENGTH)) {
            this.chip.fault(`USBCTRL: ${data.length} bytes for a buffer of ${control & LENGTH}`);
            return 'NAK';
        }
        this.chip.mcu.usbDPRAM.set(data, this.#buffer(endpoint, true));
        const next = (control & ~(AVAILABLE | LENGTH)) | FULL | data.length;
        this.#setWord(0x84 + endpoint * 8, next);
        this.#complete(endpoint, true);
        return 'ACK';
    }

    /** The buffer's control word where it can be served, else what the host gets to see. */
    #ready(endpoint, isOut) {
        const control = this.#word((isOut ? 0x84 : 0x80) + endpoint * 8);
        const bit = 1 << (endpoint * 2 + (isOut ? 1 : 0));
        if (endpoint && !(this.#endpointControl(endpoint, isOut) & ENDPOINT_ENABLED)) {
            return 'NONE'; // no such endpoint: silence
        }
        if (control & STALL && (endpoint || this.stallArm & (isOut ? 2 : 1))) {
            return 'STALL';
        }
        return control & AVAILABLE && !(this.abort & bit) ? control : 'NAK';
    }

    #endpointControl(endpoint, isOut) {
        return this.#word(endpoint * 8 + (isOut ? 4 : 0));
    }

    #buffer(endpoint, isOut) {
        return endpoint ? this.#endpointControl(endpoint, isOut) & 0xffc0 : BUFFERS_OF_EP0;
    }

    #complete(endpoint, isOut) {
        const control = endpoint ? this.#endpointControl(endpoint, isOut) : this.sieCtrl;
        if (!(control & IRQ_PER_BUFFER)) {
            this.chip.fault(`USBCTRL: endpoint ${endpoint} without its buffer interrupt`);
            return;
        }
        this.buffStatus |= 1 << (endpoint * 2 + (isOut ? 1 : 0));
        this.#updateInterrupts();
    }
}
