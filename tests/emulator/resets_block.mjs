// SPDX-License-Identifier: Apache-2.0
/** RESETS, and the guard that finds a program which uses a block that is still held in reset: on
 * silicon that reads zeros or hangs, in rp2040js it would go unnoticed. */
import { RegisterBlock } from './register_block.mjs';

// Bit of RESETS by peripheral, and its place in rp2040js' table.
export const RESET_BITS = {
    ADC: [0, 0x4004c], BUSCTRL: [1, 0x40030], DMA: [2, 0x50000], I2C0: [3, 0x40044],
    I2C1: [4, 0x40048], IO_BANK0: [5, 0x40014], IO_QSPI: [6, 0x40018],
    PADS_BANK0: [8, 0x4001c], PADS_QSPI: [9, 0x40020], PIO0: [10, 0x50200], PIO1: [11, 0x50300],
    PLL_SYS: [12, 0x40028], PLL_USB: [13, 0x4002c], PWM: [14, 0x40050], RTC: [15, 0x4005c],
    SPI0: [16, 0x4003c], SPI1: [17, 0x40040], SYSCFG: [18, 0x40004], SYSINFO: [19, 0x40000],
    TBMAN: [20, 0x4006c], TIMER: [21, 0x40054], UART0: [22, 0x40034], UART1: [23, 0x40038],
    USBCTRL: [24, 0x50110],
};
const ALL = 0x01ffffff;
const OPEN_AFTER_BOOTROM = (1 << 6) | (1 << 9); // it needs the flash's pins

export class ResetsBlock extends RegisterBlock {
    constructor(chip) {
        super(chip, 'RESETS');
        this.held = ALL & ~OPEN_AFTER_BOOTROM;
        this.wdsel = 0;
        this.released = new Map(); // name -> cycle of the first release
        this.blocks = new Map();   // bit -> block of ours with a reset()
    }

    isHeld(bit) {
        return (this.held & (1 << bit)) !== 0;
    }

    read(offset) {
        switch (offset) {
            case 0: return this.held;
            case 4: return this.wdsel;
            case 8: return ~this.held & ALL;
            default: return this.unknownRead(offset);
        }
    }

    write(offset, value) {
        if (offset === 4) {
            this.wdsel = value;
            return;
        }
        if (offset !== 0) {
            this.unknownWrite(offset, value);
            return;
        }
        const fresh = value & ~this.held, freed = this.held & ~value;
        this.held = value & ALL;
        for (const [name, [bit]] of Object.entries(RESET_BITS)) {
            if (fresh & (1 << bit)) {
                this.blocks.get(bit)?.reset();
            }
            if (freed & (1 << bit) && !this.released.has(name)) {
                this.released.set(name, this.chip.now);
            }
        }
    }
}

/** Stands before a peripheral in rp2040js' table. */
export class ResetGuard {
    constructor(chip, name, bit, block) {
        this.chip = chip;
        this.resets = chip.resets;
        this.name = name;
        this.bit = bit;
        this.block = block;
        this.onWrite = null; // called after each write with the offset
    }

    /** The SDK's start-up looks whether USB's transceiver was left on before it releases the block;
     * the block ignores that, as silicon does. */
    #isToldToIgnore(offset) {
        return this.name === 'USBCTRL' && (offset & 0xfff) === 0x4c &&
            !this.resets.released.has('USBCTRL');
    }

    readUint32(offset) {
        if (this.resets.isHeld(this.bit)) {
            if (this.#isToldToIgnore(offset)) {
                return 0;
            }
            this.chip.fault(`${this.name} is read at 0x${(offset & 0xfff).toString(16)} ` +
                'while it is held in reset');
            return 0;
        }
        return this.block.readUint32(offset);
    }

    writeUint32Atomic(offset, value, alias) {
        if (this.resets.isHeld(this.bit)) {
            if (this.#isToldToIgnore(offset)) {
                return;
            }
            this.chip.fault(`${this.name} is written at 0x${offset.toString(16)} ` +
                'while it is held in reset');
            return;
        }
        this.block.writeUint32Atomic(offset, value, alias);
        if (this.onWrite) {
            this.onWrite(offset);
        }
    }
}
