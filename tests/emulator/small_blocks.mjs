// SPDX-License-Identifier: Apache-2.0
/** Peripherals of a few registers: ring oscillator, chip reset, flash pins, XIP control, PSM. */
import { RegisterBlock } from './register_block.mjs';

/** A small generator of numbers (mulberry32): the same seed gives the same run. */
export function randomGenerator(seed) {
    let state = seed >>> 0;
    return () => {
        state = (state + 0x6d2b79f5) >>> 0;
        let value = Math.imul(state ^ (state >>> 15), state | 1);
        value ^= value + Math.imul(value ^ (value >>> 7), value | 61);
        return (value ^ (value >>> 14)) >>> 0;
    };
}

/** Registers that only keep what was written, with some that say something of their own. */
class StoreBlock extends RegisterBlock {
    constructor(chip, name, initial = {}) {
        super(chip, name);
        this.store = new Map(Object.entries(initial).map(([key, value]) => [Number(key), value]));
    }

    read(offset) {
        return this.store.get(offset) ?? 0;
    }

    write(offset, value) {
        this.store.set(offset, value);
    }
}

/** ROSC: RANDOMBIT comes from the board's seed and the number of its boots. */
export class RoscBlock extends StoreBlock {
    constructor(chip, random) {
        super(chip, 'ROSC', { 0: 0xfabaa0 });
        this.random = random;
    }

    read(offset) {
        switch (offset) {
            case 0x18: return 0x80001000; // stable, enabled
            case 0x1c: return this.random() & 1;
            default: return super.read(offset);
        }
    }
}

export const HAD_POR = 1 << 8, HAD_RUN = 1 << 16;

/** VREG_AND_CHIP_RESET: why the chip was reset last; a watchdog's bite leaves it as it was. */
export class ChipResetBlock extends StoreBlock {
    constructor(chip, cause) {
        super(chip, 'VREG_AND_CHIP_RESET', { 0: 0xb1, 4: 9, 8: cause });
    }

    write(offset, value) {
        if (offset !== 8) {
            super.write(offset, value);
        }
    }
}

/** IO_QSPI: the chip select can be forced, as reading the unique id does. */
export class IoQspiBlock extends StoreBlock {
    constructor(chip) {
        super(chip, 'IO_QSPI');
    }

    write(offset, value) {
        super.write(offset, value);
        if (offset === 0xc) { // SS_CTRL; OUTOVER 2 forces it low
            this.chip.ssi.forceSelect(((value >>> 8) & 3) === 2);
        }
    }
}

/** XIP_CTRL: cache control; there is no cache here, it is always empty and ready. */
export class XipControlBlock extends StoreBlock {
    constructor(chip) {
        super(chip, 'XIP_CTRL', { 0: 3, 8: 2 });
    }

    read(offset) {
        return offset === 8 ? 2 : super.read(offset);
    }
}

/** SYSINFO of a B2 chip, as on every Pico sold since 2021. */
export class SysInfoBlock extends RegisterBlock {
    read(offset) {
        return { 0: 0x20002927, 4: 2, 0x40: 0xe0c912e8 }[offset] ?? this.unknownRead(offset);
    }

    write(offset, value) {
        this.unknownWrite(offset, value);
    }
}

/** PSM: all power domains are on; WDSEL says what a bite of the watchdog resets. */
export class PsmBlock extends StoreBlock {
    constructor(chip) {
        super(chip, 'PSM');
    }

    get selection() {
        return this.store.get(8) ?? 0;
    }

    read(offset) {
        return offset === 0xc ? 0x1ffff : super.read(offset);
    }
}
