// SPDX-License-Identifier: Apache-2.0
/** The 64-bit microsecond timer. It counts only while the watchdog's tick generator runs: without
 * it, time stands still, as it does in silicon. */
import { RegisterBlock } from './register_block.mjs';

const TIMEHW = 0, TIMELW = 4, TIMEHR = 8, TIMELR = 0xc, ALARM = 0x10, ARMED = 0x20;
const RAWH = 0x24, RAWL = 0x28, DBGPAUSE = 0x2c, PAUSE = 0x30, INTR = 0x34, INTE = 0x38;
const INTF = 0x3c, INTS = 0x40;
const TWO32 = 2 ** 32;

export class TimerBlock extends RegisterBlock {
    constructor(chip) {
        super(chip, 'TIMER');
        this.period = 0; // cycles of a tick, 0 while there is none
        this.alarms = [];
        this.reset();
    }

    reset() {
        this.base = 0;   // count at `since`
        this.since = this.chip.now;
        this.high = 0;
        this.writeLow = 0;
        this.raw = this.inte = this.intf = 0;
        this.alarms.forEach((alarm) => this.chip.events.cancel(alarm.event));
        this.alarms = [0, 1, 2, 3].map(() => ({ target: 0, event: null }));
    }

    /** The tick generator was switched: `period` cycles each, 0 for off. */
    setTick(period) {
        if (period !== this.period) {
            this.#rebase(this.count());
            this.period = period;
            this.alarms.forEach((alarm, index) => alarm.event && this.#arm(index, alarm.target));
        }
    }

    #rebase(count) {
        this.base = count;
        this.since = this.chip.now;
    }

    count() {
        const passed = this.period ? Math.floor((this.chip.now - this.since) / this.period) : 0;
        return this.base + passed;
    }

    /** The cycle at which the count was 0, by the tick that it counts now. */
    get zeroCycle() {
        return this.since - this.base * this.period;
    }

    #arm(index, target) {
        const { events } = this.chip, alarm = this.alarms[index];
        events.cancel(alarm.event);
        alarm.target = target >>> 0;
        if (!this.period) {
            alarm.event = events.at(Infinity, () => undefined);
            return;
        }
        // It fires when the low word equals the target: at once counts as a whole round.
        const away = ((alarm.target - this.count() % TWO32 + TWO32) % TWO32) || TWO32;
        const ticks = this.count() - this.base + away;
        alarm.event = events.at(this.since + ticks * this.period, () => {
            alarm.event = null;
            this.raw |= 1 << index;
            this.#updateInterrupts();
        });
    }

    #updateInterrupts() {
        const status = (this.raw & this.inte) | this.intf;
        for (let line = 0; line < 4; line++) {
            this.chip.mcu.setInterrupt(line, ((status >>> line) & 1) === 1);
        }
    }

    read(offset) {
        if (offset >= ALARM && offset < ARMED) {
            return this.alarms[(offset - ALARM) >> 2].target;
        }
        switch (offset) {
            case TIMEHW: case TIMELW: return 0;
            case TIMELR:
                this.high = Math.floor(this.count() / TWO32);
                return this.count() % TWO32;
            case TIMEHR: return this.high;
            case RAWH: return Math.floor(this.count() / TWO32);
            case RAWL: return this.count() % TWO32;
            case ARMED: return this.alarms.reduce((all, alarm, i) =>
                all | (alarm.event ? 1 << i : 0), 0);
            case DBGPAUSE: return 7;
            case PAUSE: return 0;
            case INTR: return this.raw;
            case INTE: return this.inte;
            case INTF: return this.intf;
            case INTS: return (this.raw & this.inte) | this.intf;
            default: return this.unknownRead(offset);
        }
    }

    write(offset, value, raw) {
        if (offset >= ALARM && offset < ARMED) {
            this.#arm((offset - ALARM) >> 2, value);
            return;
        }
        switch (offset) {
            case TIMELW: this.writeLow = value; break;
            case TIMEHW: this.#rebase(value * TWO32 + this.writeLow); break;
            case ARMED: this.#disarm(raw); break;
            case DBGPAUSE: break;
            case PAUSE:
                if (value) {
                    this.chip.fault('TIMER: pausing is not modelled');
                }
                break;
            case INTR: this.raw &= ~raw; break;
            case INTE: this.inte = value & 0xf; break;
            case INTF: this.intf = value & 0xf; break;
            default: this.unknownWrite(offset, value);
        }
        this.#updateInterrupts();
    }

    #disarm(mask) {
        this.alarms.forEach((alarm, index) => {
            if (mask & (1 << index)) {
                this.chip.events.cancel(alarm.event);
                alarm.event = null;
            }
        });
    }
}
