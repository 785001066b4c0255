// SPDX-License-Identifier: Apache-2.0
/** The DMA controller: channels, rings, chains, requests from PIO, interrupts.
 *
 * A transfer takes a fixed number of cycles from its request to its write; contention for the bus
 * is not modelled. */
import { RegisterBlock } from './register_block.mjs';

const TRANSFER_CYCLES = 4, CHANNELS = 12, PERMANENT = 0x3f;
const EN = 1, INCR_READ = 1 << 4, INCR_WRITE = 1 << 5, RING_WRITE = 1 << 10;
const QUIET = 1 << 21, BSWAP = 1 << 22, SNIFF = 1 << 23, BUSY = 1 << 24;
const INTR = 0x400, MULTI_TRIGGER = 0x430, ABORT = 0x444, CHANNEL_COUNT = 0x448;
// Registers of a channel by alias: 0 read address, 1 write address, 2 count, 3 control; the last
// of each row triggers.
const ALIASES = [[0, 1, 2, 3], [3, 0, 1, 2], [3, 2, 0, 1], [3, 1, 2, 0]];

class Channel {
    constructor(index) {
        this.index = index;
        this.registers = new Uint32Array(4);
        this.registers[3] = index << 11;
        this.reload = 0;
        this.event = null;
    }

    get ctrl() {
        return this.registers[3];
    }
    get busy() {
        return (this.ctrl & BUSY) !== 0;
    }
    get request() {
        return (this.ctrl >>> 15) & 0x3f;
    }
    get chainTo() {
        return (this.ctrl >>> 11) & 0xf;
    }
    get size() {
        return 1 << ((this.ctrl >>> 2) & 3);
    }

    setBusy(on) {
        this.registers[3] = on ? this.ctrl | BUSY : this.ctrl & ~BUSY;
    }

    /** Step an address on, within its ring where it has one. */
    step(register, increments, isRing) {
        if (!(this.ctrl & increments)) {
            return;
        }
        const address = this.registers[register], bits = (this.ctrl >>> 6) & 0xf;
        const next = address + this.size;
        const ring = bits && isRing ? (1 << bits) - 1 : 0;
        this.registers[register] = ring ? (address & ~ring) | (next & ring) : next;
    }
}

export class DmaBlock extends RegisterBlock {
    constructor(chip) {
        super(chip, 'DMA');
        this.channels = [];
        this.reset();
    }

    reset() {
        this.channels.forEach((channel) => this.chip.events.cancel(channel.event));
        this.channels = Array.from({ length: CHANNELS }, (_, index) => new Channel(index));
        this.raw = 0;
        this.inte = [0, 0];
        this.intf = [0, 0];
    }

    // rp2040js' other peripherals (UART, SPI, ADC) announce requests by these; the box uses none.
    setDREQ() {}
    clearDREQ() {}

    /** A FIFO of PIO changed its level. */
    requestChanged(dreq) {
        for (const channel of this.channels) {
            if (channel.busy && channel.request === dreq) {
                this.#schedule(channel);
            }
        }
    }

    #isRequested(channel) {
        const dreq = channel.request;
        if (dreq === PERMANENT) {
            return true;
        }
        if (dreq < 16) {
            return this.chip.pio[dreq >> 3].requests(dreq);
        }
        this.chip.fault(`DMA: request ${dreq} is not modelled`);
        return false;
    }

    #schedule(channel) {
        if (channel.event === null && channel.busy && this.#isRequested(channel)) {
            const { events, now } = this.chip;
            channel.event = events.at(now + TRANSFER_CYCLES, () => this.#transfer(channel));
        }
    }

    #transfer(channel) {
        channel.event = null;
        if (!this.#isRequested(channel)) { // somebody else emptied the FIFO
            return;
        }
        this.#copy(channel);
        const { ctrl } = channel;
        channel.step(0, INCR_READ, !(ctrl & RING_WRITE));
        channel.step(1, INCR_WRITE, !!(ctrl & RING_WRITE));
        channel.registers[2]--;
        if (channel.registers[2]) {
            this.#schedule(channel);
            return;
        }
        channel.setBusy(false);
        if (!(ctrl & QUIET)) {
            this.#interrupt(channel);
        }
        if (channel.chainTo !== channel.index && channel.chainTo < CHANNELS) {
            this.#trigger(this.channels[channel.chainTo]);
        }
    }

    #copy(channel) {
        const { mcu } = this.chip, [from, to] = channel.registers;
        switch (channel.size) {
            case 1: mcu.writeUint8(to, mcu.readUint8(from)); break;
            case 2: mcu.writeUint16(to, swap(mcu.readUint16(from), channel.ctrl, 2)); break;
            default: mcu.writeUint32(to, swap(mcu.readUint32(from), channel.ctrl, 4)); break;
        }
    }

    #trigger(channel) {
        if (!(channel.ctrl & EN) || channel.busy) {
            return;
        }
        if (channel.ctrl & SNIFF) {
            this.chip.fault('DMA: the sniffer is not modelled');
        }
        channel.registers[2] = channel.reload;
        if (channel.reload) {
            channel.setBusy(true);
            this.#schedule(channel);
        }
    }

    #interrupt(channel) {
        this.raw |= 1 << channel.index;
        this.#updateInterrupts();
    }

    #status(line) {
        return (this.raw & this.inte[line]) | this.intf[line];
    }

    #updateInterrupts() {
        this.chip.mcu.setInterrupt(11, this.#status(0) !== 0);
        this.chip.mcu.setInterrupt(12, this.#status(1) !== 0);
    }

    // --- registers ------------------------------------------------------------------------------

    read(offset) {
        if (offset < CHANNELS * 0x40) {
            const channel = this.channels[offset >> 6];
            return channel.registers[ALIASES[(offset >> 4) & 3][(offset >> 2) & 3]];
        }
        switch (offset) {
            case INTR: return this.raw;
            case 0x404: return this.inte[0];
            case 0x408: return this.intf[0];
            case 0x40c: return this.#status(0);
            case 0x414: return this.inte[1];
            case 0x418: return this.intf[1];
            case 0x41c: return this.#status(1);
            case MULTI_TRIGGER: return 0;
            case ABORT: return 0; // aborts are done at once
            case CHANNEL_COUNT: return CHANNELS;
            default: break;
        }
        if (offset >= 0x800 && offset < 0x800 + CHANNELS * 0x40 && (offset & 0x3f) === 4) {
            return this.channels[(offset - 0x800) >> 6].reload;
        }
        return this.unknownRead(offset);
    }

    write(offset, value, raw) {
        if (offset < CHANNELS * 0x40) {
            this.#writeChannel(this.channels[offset >> 6], offset, value);
            return;
        }
        switch (offset) {
            case INTR: case 0x40c: case 0x41c: this.raw &= ~raw; break;
            case 0x404: this.inte[0] = value; break;
            case 0x408: this.intf[0] = value; break;
            case 0x414: this.inte[1] = value; break;
            case 0x418: this.intf[1] = value; break;
            case MULTI_TRIGGER: this.#each(value, (channel) => this.#trigger(channel)); break;
            case ABORT: this.#each(value, (channel) => this.#abort(channel)); break;
            default: this.unknownWrite(offset, value);
        }
        this.#updateInterrupts();
    }

    #each(mask, action) {
        this.channels.filter((channel) => mask & (1 << channel.index)).forEach(action);
    }

    #abort(channel) {
        this.chip.events.cancel(channel.event);
        channel.event = null;
        channel.setBusy(false);
    }

    #writeChannel(channel, offset, value) {
        const position = (offset >> 2) & 3, register = ALIASES[(offset >> 4) & 3][position];
        if (register === 3) {
            channel.registers[3] = (value & 0xffffff) | (channel.ctrl & BUSY);
            if (!(value & EN)) { // pauses; nothing of ours resumes one
                this.chip.events.cancel(channel.event);
                channel.event = null;
            } else if (channel.busy) {
                this.#schedule(channel);
            }
        } else if (register === 2) {
            channel.reload = value;
        } else {
            channel.registers[register] = value;
        }
        if (position === 3) {
            if (value) {
                this.#trigger(channel);
            } else if (channel.ctrl & QUIET) {
                this.#interrupt(channel); // a null trigger
            }
        }
    }
}

function swap(value, ctrl, size) {
    if (!(ctrl & BSWAP)) {
        return value;
    }
    const half = (v) => ((v & 0xff) << 8) | ((v >>> 8) & 0xff);
    return size === 2 ? half(value) : ((half(value) << 16) | half(value >>> 16)) >>> 0;
}
