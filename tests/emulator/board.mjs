// SPDX-License-Identifier: Apache-2.0
/** The trigger box's board: power, flash, lines, and the chip with its resets.
 *
 * Time is counted in cycles of 8 ns since the board was made; it goes on over resets and power
 * cuts. Edges of the lines are recorded from all of it. */
import { Chip } from './chip.mjs';
import { FlashChip, PowerCut } from './flash_chip.mjs';
import { HAD_POR, HAD_RUN, randomGenerator } from './small_blocks.mjs';

export class Board {
    /** @param options  {image, flash, seed}: the program for the flash, or a flash that has it. */
    constructor({ image = null, flash = null, seed = 1 } = {}) {
        this.flash = flash ?? new FlashChip();
        if (image) {
            this.flash.load(image);
        }
        this.random = randomGenerator(seed);
        this.outside = {};          // pin -> level driven from outside
        this.listeners = [];        // (pin, level, cycle)
        this.onAttach = () => undefined;
        this.now = 0;
        this.chip = null;
        this.boots = 0;
        this.faults = [];
        this.later = [];            // events of the outside world, kept over resets
        this.instructions = 0;
    }

    get isOn() {
        return this.chip !== null;
    }

    powerOn() {
        this.flash.restorePower();
        this.#start({ resetCause: HAD_POR, ram: null, watchdog: coldWatchdog() });
    }

    powerOff() {
        this.#stopChip();
        this.onAttach(false);
    }

    /** The RUN pin is pulled low for a moment. */
    pulseRunPin() {
        const ram = this.chip.mcu.sram;
        this.#stopChip();
        this.onAttach(false);
        this.#start({ resetCause: HAD_RUN, ram, watchdog: coldWatchdog() });
    }

    #start({ resetCause, ram, watchdog }) {
        this.resetCause = resetCause;
        this.boots++;
        const seeds = randomGenerator(this.random());
        this.chip = new Chip({
            flash: this.flash, now: this.now, random: seeds, outside: this.outside, resetCause,
            ram, watchdog, onLevel: (pin, level) => this.#levelChanged(pin, level),
            onReset: (kept) => {
                this.pendingReset = kept;
            },
        });
        this.chip.usb.onPullup = (attached) => this.onAttach(attached);
        this.pendingReset = null;
        this.later.forEach((event) => this.#hand(event));
    }

    #stopChip() {
        if (!this.chip) {
            return;
        }
        this.now = this.chip.now;
        this.faults.push(...this.chip.faults);
        this.instructions += this.chip.instructions;
        const levels = [...this.chip.nets.levels];
        this.chip.dead = true;
        this.chip = null;
        // Without a driver a line falls to what the outside or the pull-down makes of it.
        levels.forEach((level, pin) => {
            if (level !== (this.outside[pin] ?? 0)) {
                this.#levelChanged(pin, this.outside[pin] ?? 0);
            }
        });
    }

    #levelChanged(pin, level) {
        const cycle = this.chip ? this.chip.now : this.now;
        this.listeners.forEach((listener) => listener(pin, level, cycle));
    }

    // --- the outside world ----------------------------------------------------------------------

    /** Call `action` at a cycle, whatever becomes of the chip until then.
     * @returns a handle for cancel(). */
    at(cycle, action) {
        const event = { cycle, action, handle: null };
        this.later.push(event);
        if (this.chip) {
            this.#hand(event);
        }
        return event;
    }

    cancel(event) {
        const index = this.later.indexOf(event);
        if (index >= 0) {
            this.later.splice(index, 1);
            this.chip?.events.cancel(event.handle);
        }
    }

    #hand(event) {
        event.handle = this.chip.events.at(event.cycle, () => {
            this.later.splice(this.later.indexOf(event), 1);
            event.action();
        });
    }

    /** Drive a pin from outside from now on. */
    drive(pin, level) {
        this.outside[pin] = level;
        this.chip?.nets.drive(pin, level);
    }

    level(pin) {
        return this.chip ? this.chip.nets.levels[pin] : this.outside[pin] ?? 0;
    }

    // --- time -----------------------------------------------------------------------------------

    /** Run to a cycle. A power cut inside ends in the board being off; so does none. */
    runTo(cycle) {
        while (this.now < cycle) {
            if (!this.chip) {
                this.#passWithoutPower(cycle);
                return;
            }
            try {
                this.chip.run(cycle);
            } catch (error) {
                if (!(error instanceof PowerCut)) {
                    throw error;
                }
                this.powerOff();
                continue;
            }
            this.now = this.chip.now;
            if (this.pendingReset) {
                const watchdog = this.pendingReset, ram = this.chip.mcu.sram;
                this.#stopChip();
                this.onAttach(false);
                this.#start({ resetCause: this.resetCause, ram, watchdog });
            }
        }
    }

    #passWithoutPower(cycle) {
        this.later.sort((a, b) => a.cycle - b.cycle);
        while (this.later.length && this.later[0].cycle <= cycle && !this.chip) {
            const event = this.later.shift();
            this.now = Math.max(this.now, event.cycle);
            event.action();
        }
        if (this.chip) {
            this.runTo(cycle);
        } else {
            this.now = cycle;
        }
    }

    /** The time inside of an event: the chip may be ahead of what runTo() has told. */
    get cycle() {
        return this.chip ? this.chip.now : this.now;
    }

    allFaults() {
        return [...this.faults, ...(this.chip ? this.chip.faults : [])];
    }
}

const coldWatchdog = () => ({ reason: 0, scratch: new Uint32Array(8) });
