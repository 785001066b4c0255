// SPDX-License-Identifier: Apache-2.0
/** One PIO block: four state machines, their FIFOs and flags, and the registers in front of them.
 * Each machine knows when its next instruction is due, so that idle time costs nothing. */
import { PioMachine } from './pio_machine.mjs';
import { RegisterBlock } from './register_block.mjs';

const FIRST_MACHINE = 0xc8, MACHINE_STEP = 0x18;
const CTRL = 0, FSTAT = 4, FDEBUG = 8, FLEVEL = 0xc, TXF = 0x10, RXF = 0x20, IRQ = 0x30;
const IRQ_FORCE = 0x34, SYNC_BYPASS = 0x38, DBG_PADOUT = 0x3c, DBG_PADOE = 0x40, CFGINFO = 0x44;
const MEMORY = 0x48, INTR = 0x128, INTE = 0x12c;

export class PioBlock extends RegisterBlock {
    /** @param firstDreq  TX of machine 0; RX is four further. */
    constructor(chip, index, firstIrq, firstDreq) {
        super(chip, `PIO${index}`);
        this.firstIrq = firstIrq;
        this.firstDreq = firstDreq;
        this.machines = []; // what rp2040js' pins would look at: there is nothing for them here
        this.sms = [0, 1, 2, 3].map((number) => new PioMachine(this, number));
        this.inputs = 0;    // pins as machines see them, behind the synchroniser
        this.reset();
    }

    reset() {
        this.memory = new Uint16Array(32);
        this.flags = this.flagsSeen = this.flagsToSet = this.flagsToClear = 0;
        this.fdebug = 0;
        this.bypass = 0;
        this.pinValues = this.pinDirections = 0;
        this.shownValues = this.shownDirections = 0;
        this.inte = [0, 0];
        this.intf = [0, 0];
        this.due = Infinity; // cycle of the next instruction of any machine
        this.sms.forEach((sm) => sm.reset());
        this.enabledAt = null;
    }

    // --- what machines call ---------------------------------------------------------------------

    input(pin) {
        return ((this.inputs >>> pin) & 1) === 1;
    }

    drivePins(value, base, count) {
        this.pinValues = merge(this.pinValues, value, base, count);
    }

    driveDirections(value, base, count) {
        this.pinDirections = merge(this.pinDirections, value, base, count);
    }

    rxPushed(sm) {
        this.chip.dma.requestChanged(this.firstDreq + 4 + sm.index);
        this.updateInterrupts();
    }

    txPulled(sm) {
        this.chip.dma.requestChanged(this.firstDreq + sm.index);
        this.updateInterrupts();
    }

    noteRxStall(index) {
        this.fdebug |= 1 << index;
    }

    noteTxStall(index) {
        this.fdebug |= 1 << (24 + index);
    }

    /** Does a DREQ of this block ask for a transfer? */
    requests(dreq) {
        const sm = this.sms[dreq & 3];
        return dreq - this.firstDreq >= 4 ? sm.rx.length > 0 : sm.tx.length < sm.txSize;
    }

    // --- time -----------------------------------------------------------------------------------

    /** Carry out what is due in cycle `now`. */
    step(now) {
        this.flagsSeen = this.flags;
        for (const sm of this.sms) {
            if (Math.ceil(sm.due / 256) <= now) {
                const { pinValues, pinDirections } = this;
                sm.tick();
                this.#contest(sm.index, now,
                    (pinValues ^ this.pinValues) | (pinDirections ^ this.pinDirections));
            }
        }
        this.#applyFlags(now);
        this.showPins();
        this.updateDue();
    }

    /** A machine changed pins that another one keeps driving in a loop that is stepped over: of two
     * in one cycle, the higher number counts. */
    #contest(index, now, changed) {
        if (changed) {
            for (const other of this.sms) {
                if (other.loop && other.loop.holds & changed) {
                    other.catchUp(other.index > index ? now : now + 1);
                }
            }
        }
    }

    #applyFlags(now) {
        const before = this.flags;
        this.flags = (before & ~this.flagsToClear) | this.flagsToSet;
        this.flagsToSet = this.flagsToClear = 0;
        this.flagsSeen = this.flags;
        if (this.flags !== before) {
            this.sms.forEach((sm) => sm.wake(now + 1));
            this.updateInterrupts();
        }
    }

    updateDue() {
        let due = Infinity;
        for (const sm of this.sms) {
            if (sm.due < due) {
                due = sm.due;
            }
        }
        this.due = Math.ceil(due / 256);
    }

    showPins() {
        const changed = (this.pinValues ^ this.shownValues) |
            (this.pinDirections ^ this.shownDirections);
        if (changed) {
            this.shownValues = this.pinValues;
            this.shownDirections = this.pinDirections;
            this.chip.nets.outputsChanged(changed);
        }
    }

    /** A pin as machines see it becomes `level` when the cycle begins. */
    setInput(pin, level) {
        const { now } = this.chip;
        for (const sm of this.sms) {
            if (sm.loop && sm.loop.pin === pin) {
                sm.catchUp(now);
            }
        }
        this.inputs = level ? this.inputs | (1 << pin) : this.inputs & ~(1 << pin);
        this.sms.forEach((sm) => sm.wake(now));
        this.updateDue();
    }

    updateInterrupts() {
        const raw = this.interruptsRaw();
        for (const line of [0, 1]) {
            const status = (raw & this.inte[line]) | this.intf[line];
            this.chip.mcu.setInterrupt(this.firstIrq + line, status !== 0);
        }
    }

    interruptsRaw() {
        let raw = (this.flags & 0xf) << 8;
        this.sms.forEach((sm, index) => {
            raw |= sm.rx.length ? 1 << index : 0;
            raw |= sm.tx.length < sm.txSize ? 16 << index : 0;
        });
        return raw;
    }

    // --- registers ------------------------------------------------------------------------------

    read(offset) {
        if (offset >= FIRST_MACHINE && offset < INTR) {
            return this.#readMachine(offset);
        }
        if (offset >= RXF && offset < IRQ) {
            return this.#readFifo((offset - RXF) >> 2);
        }
        if (offset >= INTE && offset < INTE + 24) {
            return this.#readInterrupt(offset - INTE);
        }
        switch (offset) {
            case CTRL: return this.#bits((sm) => sm.enabled);
            case FSTAT: return this.#fifoStatus();
            case FDEBUG: return this.fdebug;
            case FLEVEL: return this.sms.reduce((all, sm, index) =>
                all | ((sm.tx.length | (sm.rx.length << 4)) << (8 * index)), 0);
            case IRQ: return this.flags;
            case IRQ_FORCE: return 0;
            case SYNC_BYPASS: return this.bypass;
            case DBG_PADOUT: return this.pinValues;
            case DBG_PADOE: return this.pinDirections;
            case CFGINFO: return 0x200404;
            case INTR: return this.interruptsRaw();
            default: return this.unknownRead(offset);
        }
    }

    #bits(test) {
        return this.sms.reduce((all, sm, index) => all | (test(sm) ? 1 << index : 0), 0);
    }

    #fifoStatus() {
        return (this.#bits((sm) => sm.rx.length >= sm.rxSize)) |
            (this.#bits((sm) => sm.rx.length === 0) << 8) |
            (this.#bits((sm) => sm.tx.length >= sm.txSize) << 16) |
            (this.#bits((sm) => sm.tx.length === 0) << 24);
    }

    #readFifo(index) {
        const sm = this.sms[index];
        if (!sm.rx.length) {
            this.fdebug |= 1 << (8 + index);
            return 0;
        }
        const value = sm.rx.shift();
        sm.wake(this.chip.now + 1);
        this.updateDue();
        this.chip.dma.requestChanged(this.firstDreq + 4 + index);
        this.updateInterrupts();
        return value;
    }

    #readMachine(offset) {
        const sm = this.sms[Math.floor((offset - FIRST_MACHINE) / MACHINE_STEP)];
        sm.catchUp(this.chip.now);
        this.updateDue();
        const stalled = sm.forcedStall ? 0x80000000 : 0;
        switch ((offset - FIRST_MACHINE) % MACHINE_STEP) {
            case 0: return sm.clkdiv;
            case 4: return (sm.execctrl | stalled) >>> 0;
            case 8: return sm.shiftctrl >>> 0;
            case 0xc: return sm.pc;
            case 0x10: return sm.injected ?? this.memory[sm.pc];
            default: return sm.pinctrl >>> 0;
        }
    }

    #readInterrupt(offset) {
        const line = offset >= 12 ? 1 : 0;
        switch (offset % 12) {
            case 0: return this.inte[line];
            case 4: return this.intf[line];
            default: return (this.interruptsRaw() & this.inte[line]) | this.intf[line];
        }
    }

    write(offset, value, raw) {
        const { now } = this.chip;
        if (offset >= FIRST_MACHINE && offset < INTR) {
            this.#writeMachine(offset, value);
        } else if (offset >= MEMORY && offset < FIRST_MACHINE) {
            this.sms.forEach((sm) => sm.catchUp(now));
            this.memory[(offset - MEMORY) >> 2] = value;
        } else if (offset >= TXF && offset < RXF) {
            this.#writeFifo((offset - TXF) >> 2, value);
        } else if (offset >= INTE && offset < INTE + 24) {
            const line = offset - INTE >= 12 ? 1 : 0;
            const which = (offset - INTE) % 12 === 0 ? this.inte : this.intf;
            which[line] = value & 0xfff;
        } else {
            this.#writeControl(offset, value, raw, now);
        }
        this.showPins();
        this.updateDue();
        this.updateInterrupts();
    }

    #writeControl(offset, value, raw, now) {
        switch (offset) {
            case CTRL: this.#control(value, now); break;
            case FDEBUG: this.fdebug &= ~raw; break;
            case IRQ: this.flagsToClear |= raw & 0xff; this.#applyFlags(now); break;
            case IRQ_FORCE: this.flagsToSet |= value & 0xff; this.#applyFlags(now); break;
            case SYNC_BYPASS: this.bypass = value; break;
            default: this.unknownWrite(offset, value);
        }
    }

    #control(value, now) {
        this.sms.forEach((sm, index) => {
            sm.catchUp(now);
            if (value & (0x10 << index)) {
                sm.restart();
            }
            sm.setEnabled(!!(value & (1 << index)), now);
        });
        if (value & 0xf && this.enabledAt === null) {
            this.enabledAt = now;
            this.chip.onPioEnabled(this);
        }
    }

    #force(sm, opcode, now) {
        const { pinValues, pinDirections } = this;
        this.flagsSeen = this.flags;
        sm.force(opcode, now);
        this.#contest(-1, now, (pinValues ^ this.pinValues) | (pinDirections ^ this.pinDirections));
        this.#applyFlags(now);
    }

    #writeFifo(index, value) {
        const sm = this.sms[index];
        if (sm.tx.length >= sm.txSize) {
            this.fdebug |= 1 << (16 + index);
            return;
        }
        sm.tx.push(value >>> 0);
        sm.wake(this.chip.now + 1);
        this.chip.dma.requestChanged(this.firstDreq + index);
    }

    #writeMachine(offset, value) {
        const { now } = this.chip;
        const sm = this.sms[Math.floor((offset - FIRST_MACHINE) / MACHINE_STEP)];
        sm.catchUp(now);
        switch ((offset - FIRST_MACHINE) % MACHINE_STEP) {
            case 0: sm.clkdiv = value >>> 0; break;
            case 4: sm.execctrl = value & 0x7fffffff; break;
            case 8:
                if ((sm.shiftctrl ^ value) & 0xc0000000) { // joining FIFOs empties them
                    sm.rx = [];
                    sm.tx = [];
                }
                sm.shiftctrl = value;
                break;
            case 0x10:
                this.#force(sm, value & 0xffff, now);
                break;
            case 0x14: sm.pinctrl = value; break;
            default: break;
        }
    }
}

function merge(before, value, base, count) {
    let result = before;
    for (let bit = 0; bit < count; bit++) {
        const pin = 1 << ((base + bit) & 0x1f);
        result = (value >>> bit) & 1 ? result | pin : result & ~pin;
    }
    return result;
}
