// SPDX-License-Identifier: Apache-2.0
/** The watchdog, its scratch registers and the tick generator that the timer lives by. */
import { RegisterBlock } from './register_block.mjs';

const CTRL = 0, LOAD = 4, REASON = 8, SCRATCH = 0xc, TICK = 0x2c;
const TRIGGER = 0x80000000, ENABLE = 0x40000000, TICK_ENABLE = 1 << 9, TICK_RUNNING = 1 << 10;
const CYCLES_PER_REFERENCE = 125 / 12; // clk_sys 125 MHz, clk_ref 12 MHz
export const REASON_TIMER = 1, REASON_FORCE = 2;

export class WatchdogBlock extends RegisterBlock {
    /** @param kept  {reason, scratch} from before the reset. */
    constructor(chip, kept) {
        super(chip, 'WATCHDOG');
        this.reason = kept.reason;
        this.scratch = kept.scratch;
        this.enabled = false;
        this.load = 0;
        this.ctrl = 0x07000000;
        this.tick = TICK_ENABLE; // silicon: enabled, with a divider of 0 that gives no tick
        this.event = null;
        this.loadedAt = 0;
        this.feeds = 0;
    }

    get tickPeriod() {
        return this.tick & TICK_ENABLE ? (this.tick & 0x1ff) * CYCLES_PER_REFERENCE : 0;
    }

    /** RP2040-E1: the counter goes down by two each tick. */
    get #counter() {
        const passed = this.tickPeriod
            ? Math.floor((this.chip.now - this.loadedAt) / this.tickPeriod) * 2 : 0;
        return this.enabled ? Math.max(0, this.load - passed) : this.load;
    }

    #restart(counter) {
        this.load = counter;
        this.loadedAt = this.chip.now;
        this.chip.events.cancel(this.event);
        this.event = null;
        if (this.enabled && this.tickPeriod) {
            const due = this.chip.now + (counter / 2) * this.tickPeriod;
            this.event = this.chip.events.at(due, () => this.#bite(REASON_TIMER));
        }
    }

    #bite(reason) {
        if (this.chip.psm.selection === 0) {
            this.chip.fault('WATCHDOG: it bites, but PSM_WDSEL selects nothing to be reset');
            return;
        }
        this.chip.requestReset({ reason, scratch: this.scratch });
    }

    read(offset) {
        if (offset >= SCRATCH && offset < TICK) {
            return this.scratch[(offset - SCRATCH) >> 2];
        }
        switch (offset) {
            case CTRL: return this.ctrl | (this.enabled ? ENABLE : 0) | this.#counter;
            case LOAD: return 0;
            case REASON: return this.reason;
            case TICK: return this.tick | (this.tickPeriod ? TICK_RUNNING : 0);
            default: return this.unknownRead(offset);
        }
    }

    write(offset, value) {
        if (offset >= SCRATCH && offset < TICK) {
            this.scratch[(offset - SCRATCH) >> 2] = value;
            return;
        }
        switch (offset) {
            case CTRL: {
                const counter = this.#counter;
                this.ctrl = value & 0x07000000;
                this.enabled = (value & ENABLE) !== 0;
                this.#restart(counter);
                if (value & TRIGGER) {
                    this.#bite(REASON_FORCE);
                }
                break;
            }
            case LOAD: this.feeds++; this.#restart(value & 0xffffff); break;
            case TICK: {
                const counter = this.#counter;
                this.tick = value & (0x1ff | TICK_ENABLE);
                this.chip.timer.setTick(this.tickPeriod);
                this.#restart(counter);
                break;
            }
            default: this.unknownWrite(offset, value);
        }
    }
}
