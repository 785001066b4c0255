// SPDX-License-Identifier: Apache-2.0
/** The pins: what chip and outside world make of them together, and when PIO gets to see it.
 *
 * rp2040js keeps the registers (function, overrides, pads); the level of a pin is what the chip
 * drives, else what the outside drives, else what the pull resistors make of it. */

const SYNCHRONISER_CYCLES = 2;
const PULLED_UP = 3; // GPIOPinState of rp2040js: 0 and 1 driven, 2 input, 3 and 4 pulled

export class GpioNets {
    /** @param outside  levels driven from outside by pin; kept over resets of the chip.
     *  @param onLevel  called with (pin, level) at each change. */
    constructor(chip, outside, onLevel) {
        this.chip = chip;
        this.outside = outside;
        this.onLevel = onLevel;
        this.padWrites = new Map(); // pin -> cycle of the first write to its pad register
        this.levels = chip.mcu.gpio.map(() => 0);
        this.inputs = chip.mcu.gpio.map(() => false);
        for (const pin of chip.mcu.gpio) {
            pin.padValue = 0x56; // silicon's reset value: input enabled, pulled down
            pin.addListener(() => this.refresh(pin.index));
        }
    }

    /** The outside drives a pin, or lets go of it with null. */
    drive(pin, level) {
        this.outside[pin] = level;
        this.refresh(pin);
    }

    /** PIO drives other values on the pins of the mask. */
    outputsChanged(mask) {
        for (const pin of this.chip.mcu.gpio) {
            if (mask & (1 << pin.index)) {
                pin.checkForUpdates();
            }
        }
    }

    refreshAll() {
        this.chip.mcu.gpio.forEach((pin) => this.refresh(pin.index));
    }

    refresh(index) {
        const pin = this.chip.mcu.gpio[index], state = pin.value;
        let level = this.outside[index] ?? (state === PULLED_UP ? 1 : 0);
        if (state <= 1 && !pin.outputDisable) {
            level = state;
        }
        if (level !== this.levels[index]) {
            this.levels[index] = level;
            pin.setInputValue(level === 1);
            this.onLevel(index, level);
        }
        this.#refreshInput(pin);
    }

    #refreshInput(pin) {
        const { index } = pin, input = pin.inputValue;
        if (input === this.inputs[index]) {
            return;
        }
        this.inputs[index] = input;
        const { pio, events, now } = this.chip;
        for (const block of pio) {
            if (block.bypass & (1 << index)) {
                block.setInput(index, input);
            } else {
                events.at(now + SYNCHRONISER_CYCLES, () => block.setInput(index, input));
            }
        }
    }
}
