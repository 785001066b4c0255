// SPDX-License-Identifier: Apache-2.0
/** SSI, the interface to the flash: plain serial transfers, and execution in place (XIP), which
 * works only between a set-up such as the second boot stage does and the next serial access. */
import { RegisterBlock } from './register_block.mjs';

const CTRLR0 = 0, SSIENR = 8, SR = 0x28, DR0 = 0x60, SPI_CTRLR0 = 0xf4, IDR = 0x58, VERSION = 0x5c;
const FIFO = 16;

export class SsiBlock extends RegisterBlock {
    constructor(chip, flash) {
        super(chip, 'SSI');
        this.flash = flash;
        this.store = new Map();
        this.received = [];
        this.xip = false; // may the CPU read flash?
        this.forced = false;
    }

    /** Leave XIP and get ready for serial commands, as the ROM's functions do. */
    enterSerial() {
        this.xip = false;
        this.flash.deselect();
        this.store.set(CTRLR0, 7 << 16);
        this.store.set(SSIENR, 1);
        this.received = [];
    }

    enterXip() {
        this.xip = true;
    }

    forceSelect(low) {
        if (this.forced && !low) {
            this.flash.deselect();
        }
        this.forced = low;
    }

    get #isPlainSerial() {
        const ctrl = this.store.get(CTRLR0) ?? 0;
        return ((ctrl >>> 21) & 3) === 0 && ((ctrl >>> 16) & 0x1f) === 7;
    }

    read(offset) {
        switch (offset) {
            case SR:
                if (!this.forced) {
                    this.flash.deselect(); // the FIFO has run empty by now
                }
                return 4 | (this.received.length < FIFO ? 2 : 0) | (this.received.length ? 8 : 0);
            case DR0: return this.received.shift() ?? 0;
            case 0x20: return 0;
            case 0x24: return this.received.length;
            case IDR: return 0x51535049;
            case VERSION: return 0x3430312a;
            default: return this.store.get(offset) ?? 0;
        }
    }

    write(offset, value) {
        if (offset === DR0) {
            this.#send(value);
            return;
        }
        this.store.set(offset, value);
        if (offset === SSIENR) {
            this.received = [];
            this.flash.deselect();
            const control = this.store.get(SPI_CTRLR0) ?? 0;
            const addressBits = (control >>> 2) & 0xf, command = control >>> 24;
            this.xip = value === 1 && addressBits !== 0 && command !== 0;
        }
    }

    #send(value) {
        if (!this.store.get(SSIENR)) {
            this.chip.fault('SSI: data written while it is disabled');
        } else if (!this.#isPlainSerial) {
            this.received = [0]; // the dummy read that leads the flash into continuous reading
        } else {
            const reply = this.flash.transfer(value & 0xff);
            if (reply === null) {
                this.chip.fault(`flash: command 0x${value.toString(16)} is not modelled`);
            }
            this.received.push(reply ?? 0xff);
        }
    }
}
