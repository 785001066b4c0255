// SPDX-License-Identifier: Apache-2.0
/** One state machine of a PIO block, by the RP2040 datasheet, section 3.
 *
 * Time is counted in 1/256 cycles where the clock divider matters. An instruction that is due at
 * cycle t sees input pins as they were at the pads two cycles before, and FIFOs and flags as they
 * were when the cycle began; what it drives leaves the chip at t. With the input synchroniser's
 * two cycles this gives the delays of the silicon from edge to edge. */
import { findLoop } from './pio_loop.mjs';

const SIDE_EN = 1 << 30, SIDE_PINDIR = 1 << 29, STATUS_SEL = 1 << 4;
const AUTOPUSH = 1 << 16, AUTOPULL = 1 << 17, IN_RIGHT = 1 << 18, OUT_RIGHT = 1 << 19;
const FOREVER = Infinity;

function reverseBits(value) {
    let result = 0;
    for (let bit = 0; bit < 32; bit++) {
        result = (result << 1) | ((value >>> bit) & 1);
    }
    return result >>> 0;
}

const mask = (bits) => (bits >= 32 ? 0xffffffff : (1 << bits) - 1) >>> 0;

export class PioMachine {
    constructor(block, index) {
        this.block = block;
        this.index = index;
        this.reset();
    }

    reset() {
        this.enabled = false;
        this.x = this.y = this.isr = this.osr = 0;
        this.isrCount = 0;
        this.osrCount = 32;
        this.pc = 0;
        this.clkdiv = 1 << 16;
        this.execctrl = 0x1f << 12;
        this.shiftctrl = 3 << 18;
        this.pinctrl = 5 << 26;
        this.rx = [];
        this.tx = [];
        this.due = FOREVER;       // next instruction, 1/256 cycles
        this.stalledSince = null; // its first attempt, 1/256 cycles
        this.irqRaised = false;   // IRQ WAIT has set its flag and waits for it to clear
        this.injected = null;     // by EXEC, or forced and stalled: goes before instruction memory
        this.forcedStall = false;
        this.loop = null;         // see park()
        this.mayPark = true;
        this.frozenDelay = 0;     // what was left of a delay when the machine was disabled
    }

    // --- settings -------------------------------------------------------------------------------

    get divider() {
        return ((this.clkdiv >>> 16) || 65536) * 256 + ((this.clkdiv >>> 8) & 0xff);
    }
    get rxSize() {
        return this.shiftctrl >>> 31 ? 8 : (this.shiftctrl >>> 30) & 1 ? 0 : 4;
    }
    get txSize() {
        return (this.shiftctrl >>> 30) & 1 ? 8 : this.shiftctrl >>> 31 ? 0 : 4;
    }
    get jmpPin() {
        return (this.execctrl >>> 24) & 0x1f;
    }
    get wrapTop() {
        return (this.execctrl >>> 12) & 0x1f;
    }
    get wrapBottom() {
        return (this.execctrl >>> 7) & 0x1f;
    }
    get pushThreshold() {
        return ((this.shiftctrl >>> 20) & 0x1f) || 32;
    }
    get pullThreshold() {
        return ((this.shiftctrl >>> 25) & 0x1f) || 32;
    }
    get status() {
        const level = this.execctrl & STATUS_SEL ? this.rx.length : this.tx.length;
        return level < (this.execctrl & 0xf) ? 0xffffffff : 0;
    }

    /** Delay and side-set of an instruction: the five bits are shared as PINCTRL says. */
    side(opcode) {
        const count = this.pinctrl >>> 29, field = (opcode >>> 8) & 0x1f;
        const delay = field & mask(5 - count);
        let value = field >>> (5 - count), bits = count;
        if (this.execctrl & SIDE_EN) {
            bits--;
            const wanted = (value >>> bits) & 1;
            value &= mask(bits);
            bits = wanted ? bits : 0;
        }
        return { delay, value, bits };
    }

    // --- time -----------------------------------------------------------------------------------

    setEnabled(on, now) {
        if (on === this.enabled) {
            return;
        }
        this.catchUp(now);
        this.enabled = on;
        if (!on) {
            this.frozenDelay = this.due === FOREVER ? 0 : Math.max(0, this.due - (now + 1) * 256);
            this.due = FOREVER;
        } else {
            this.due = (now + 1) * 256 + this.frozenDelay;
        }
    }

    restart() {
        this.isrCount = 0;
        this.isr = 0;
        this.osrCount = 32;
        this.stalledSince = null;
        this.irqRaised = false;
        this.injected = null;
        this.forcedStall = false;
        this.frozenDelay = 0;
    }

    /** Something changed at cycle `time` that a stalled instruction may have waited for. */
    wake(time) {
        if (this.stalledSince === null || !this.enabled && !this.forcedStall) {
            return;
        }
        const step = this.forcedStall && !this.enabled ? 256 : this.divider;
        const ticks = Math.max(1, Math.ceil((time * 256 - this.stalledSince) / step));
        this.due = Math.min(this.due, this.stalledSince + ticks * step);
    }

    /** Carry out the instruction that is due; the block calls it in the cycle when it is. */
    tick() {
        if (this.loop) {
            const { iterations } = this.loop;
            this.#leaveLoop(iterations);
        }
        const at = this.due, pcBefore = this.pc, { injected } = this;
        const opcode = injected ?? this.block.memory[this.pc];
        const { delay, value, bits } = this.side(opcode);
        this.injected = null;
        this.jumped = false;
        const done = this.execute(opcode);
        if (bits) {
            this.#driveSide(value, bits);
        }
        if (!done) {
            this.injected = injected;
            this.stalledSince = this.stalledSince === null ? at : Math.max(at, this.stalledSince);
            this.due = FOREVER;
            return;
        }
        const wasForced = this.forcedStall;
        this.stalledSince = null;
        this.forcedStall = false;
        if (injected === null && !this.jumped) {
            this.#advance();
        }
        this.due = this.enabled || !wasForced ? at + (1 + delay) * this.divider : FOREVER;
        if (!this.enabled) {
            this.due = FOREVER;
        }
        if (this.pc <= pcBefore && injected === null && this.mayPark) {
            this.park();
        }
    }

    #advance() {
        this.pc = this.pc === this.wrapTop ? this.wrapBottom : (this.pc + 1) & 0x1f;
    }

    /** An instruction from SMx_INSTR: carried out at once, whatever the machine was doing. */
    force(opcode, now) {
        this.catchUp(now);
        const { value, bits } = this.side(opcode);
        this.jumped = false;
        const stalledBefore = this.stalledSince;
        const done = this.execute(opcode);
        if (bits) {
            this.#driveSide(value, bits);
        }
        if (!done) {
            this.injected = opcode;
            this.forcedStall = true;
            this.stalledSince = now * 256;
            this.due = FOREVER;
            return;
        }
        if (this.jumped) {
            this.stalledSince = null;
            this.irqRaised = false;
            this.injected = null;
            this.frozenDelay = 0;
            this.due = this.enabled ? (now + 1) * 256 : FOREVER;
        } else {
            this.stalledSince = stalledBefore;
            this.wake(now + 1);
        }
    }

    // --- loops that only count ------------------------------------------------------------------

    /** Skip a loop of jumps whose course is known until it ends or its pin changes. */
    park() {
        const loop = findLoop(this);
        if (loop && this.due !== FOREVER) {
            this.loop = { ...loop, since: this.due, ticks: loop.length * this.divider };
            this.due += loop.iterations * this.loop.ticks; // may be for ever
        }
    }

    /** Bring registers to what they are when cycle `time` begins. */
    catchUp(time) {
        if (!this.loop) {
            return;
        }
        const { since, ticks, iterations } = this.loop, last = (time - 1) * 256;
        const passed = Math.max(0, Math.floor((last - since) / ticks));
        this.#leaveLoop(Math.min(passed, iterations));
        // What these instructions drive was driven already when the loop was entered.
        const { pinValues, pinDirections } = this.block;
        this.mayPark = false;
        while (this.due <= last) {
            this.tick();
        }
        this.mayPark = true;
        Object.assign(this.block, { pinValues, pinDirections });
    }

    #leaveLoop(count) {
        const { since, ticks, xSteps, ySteps } = this.loop;
        this.x = (this.x - count * xSteps) >>> 0;
        this.y = (this.y - count * ySteps) >>> 0;
        this.due = since + count * ticks;
        this.loop = null;
    }

    // --- instructions ---------------------------------------------------------------------------

    /** @returns false if the instruction stalls. */
    execute(opcode) {
        const argument = opcode & 0xff;
        switch (opcode >>> 13) {
            case 0: return this.#jmp(argument >>> 5, argument & 0x1f);
            case 1: return this.#wait(argument);
            case 2: return this.#in(argument >>> 5, (argument & 0x1f) || 32);
            case 3: return this.#out(argument >>> 5, (argument & 0x1f) || 32);
            case 4: return argument & 0x80 ? this.#pull(argument) : this.#push(argument);
            case 5: return this.#mov(argument);
            case 6: return this.#irq(argument);
            default: return this.#set(argument >>> 5, argument & 0x1f);
        }
    }

    #goto(address) {
        this.pc = address & 0x1f;
        this.jumped = true;
    }

    condition(code) {
        switch (code) {
            case 0: return true;
            case 1: return this.x === 0;
            case 2: this.x = (this.x - 1) >>> 0; return this.x !== 0xffffffff;
            case 3: return this.y === 0;
            case 4: this.y = (this.y - 1) >>> 0; return this.y !== 0xffffffff;
            case 5: return this.x !== this.y;
            case 6: return this.block.input(this.jmpPin);
            default: return this.osrCount < this.pullThreshold;
        }
    }

    #jmp(code, address) {
        if (this.condition(code)) {
            this.#goto(address);
        }
        return true;
    }

    #flag(argument) {
        return argument & 0x10 ? (argument & 4) | ((argument + this.index) & 3) : argument & 7;
    }

    #wait(argument) {
        const polarity = !!(argument & 0x80), source = (argument >>> 5) & 3;
        if (source === 2) {
            const flag = this.#flag(argument & 0x1f);
            if (!!(this.block.flagsSeen & (1 << flag)) !== polarity) {
                return false;
            }
            if (polarity) {
                this.block.flagsToClear |= 1 << flag;
            }
            return true;
        }
        const base = source === 1 ? (this.pinctrl >>> 15) & 0x1f : 0;
        return this.block.input((base + (argument & 0x1f)) & 0x1f) === polarity;
    }

    #source(code) {
        const base = (this.pinctrl >>> 15) & 0x1f, pins = this.block.inputs;
        switch (code) {
            case 0: return ((pins >>> base) | (base ? pins << (32 - base) : 0)) >>> 0;
            case 1: return this.x;
            case 2: return this.y;
            case 5: return this.status;
            case 6: return this.isr;
            case 7: return this.osr;
            default: return 0;
        }
    }

    #in(source, count) {
        if (this.shiftctrl & AUTOPUSH && this.isrCount >= this.pushThreshold) {
            if (!this.#pushNow()) {
                return false;
            }
        }
        const value = this.#source(source) & mask(count);
        if (count === 32) {
            this.isr = value >>> 0;
        } else if (this.shiftctrl & IN_RIGHT) {
            this.isr = ((this.isr >>> count) | (value << (32 - count))) >>> 0;
        } else {
            this.isr = ((this.isr << count) | value) >>> 0;
        }
        this.isrCount = Math.min(32, this.isrCount + count);
        if (this.shiftctrl & AUTOPUSH && this.isrCount >= this.pushThreshold) {
            this.#pushNow(); // else the next IN stalls
        }
        return true;
    }

    #pushNow() {
        if (this.rx.length >= this.rxSize) {
            this.block.noteRxStall(this.index);
            return false;
        }
        this.rx.push(this.isr >>> 0);
        this.isr = 0;
        this.isrCount = 0;
        this.block.rxPushed(this);
        return true;
    }

    #push(argument) {
        const blocking = argument & 0x20;
        if (argument & 0x40 && this.isrCount < this.pushThreshold) {
            return true;
        }
        if (this.#pushNow()) {
            return true;
        }
        if (!blocking) {
            this.isr = 0;
            this.isrCount = 0;
        }
        return !blocking;
    }

    #pull(argument) {
        const blocking = argument & 0x20;
        if (argument & 0x40 && this.osrCount < this.pullThreshold) {
            return true;
        }
        if (this.shiftctrl & AUTOPULL && this.osrCount === 0) {
            return true;
        }
        if (this.tx.length === 0 && !blocking) {
            this.osr = this.x;
            this.osrCount = 0;
            return true;
        }
        return this.#pullNow();
    }

    #pullNow() {
        if (this.tx.length === 0) {
            this.block.noteTxStall(this.index);
            return false;
        }
        this.osr = this.tx.shift();
        this.osrCount = 0;
        this.block.txPulled(this);
        return true;
    }

    #out(destination, count) {
        const auto = this.shiftctrl & AUTOPULL;
        if (auto && this.osrCount >= this.pullThreshold && !this.#pullNow()) {
            return false;
        }
        let value;
        if (this.shiftctrl & OUT_RIGHT) {
            value = this.osr & mask(count);
            this.osr = count === 32 ? 0 : this.osr >>> count;
        } else {
            value = count === 32 ? this.osr : this.osr >>> (32 - count);
            this.osr = count === 32 ? 0 : (this.osr << count) >>> 0;
        }
        this.osrCount = Math.min(32, this.osrCount + count);
        this.#write(destination, value >>> 0, count);
        if (auto && this.osrCount >= this.pullThreshold && this.tx.length) {
            this.#pullNow();
        }
        return true;
    }

    /** Destinations of OUT. */
    #write(destination, value, count) {
        const base = this.pinctrl & 0x1f, pins = (this.pinctrl >>> 20) & 0x3f;
        switch (destination) {
            case 0: this.block.drivePins(value, base, pins); break;
            case 1: this.x = value; break;
            case 2: this.y = value; break;
            case 4: this.block.driveDirections(value, base, pins); break;
            case 5: this.#goto(value); break;
            case 6: this.isr = value; this.isrCount = count; break;
            case 7: this.injected = value & 0xffff; break;
            default: break;
        }
    }

    #mov(argument) {
        const operation = (argument >>> 3) & 3;
        let value = this.#source(argument & 7);
        if (operation === 1) {
            value = ~value >>> 0;
        } else if (operation === 2) {
            value = reverseBits(value);
        }
        switch (argument >>> 5) {
            case 4: this.injected = value & 0xffff; break;
            case 6: this.isr = value; this.isrCount = 0; break;
            case 7: this.osr = value; this.osrCount = 0; break;
            default: this.#write(argument >>> 5, value, 32); break;
        }
        return true;
    }

    #irq(argument) {
        const flag = 1 << this.#flag(argument & 0x1f);
        if (argument & 0x40) {
            this.block.flagsToClear |= flag;
            return true;
        }
        if (this.irqRaised) {
            this.irqRaised = !!(this.block.flagsSeen & flag);
            return !this.irqRaised;
        }
        this.block.flagsToSet |= flag;
        this.irqRaised = !!(argument & 0x20);
        return !this.irqRaised;
    }

    #set(destination, value) {
        const base = (this.pinctrl >>> 5) & 0x1f, pins = (this.pinctrl >>> 26) & 7;
        switch (destination) {
            case 0: this.block.drivePins(value, base, pins); break;
            case 1: this.x = value; break;
            case 2: this.y = value; break;
            case 4: this.block.driveDirections(value, base, pins); break;
            default: break;
        }
        return true;
    }

    #driveSide(value, bits) {
        const base = (this.pinctrl >>> 10) & 0x1f;
        if (this.execctrl & SIDE_PINDIR) {
            this.block.driveDirections(value, base, bits);
        } else {
            this.block.drivePins(value, base, bits);
        }
    }
}
