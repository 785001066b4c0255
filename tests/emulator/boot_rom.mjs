// SPDX-License-Identifier: Apache-2.0
/** A boot ROM of our own: the header and function table that the SDK looks up, and behind each
 * function a breakpoint at which JavaScript does the work. Nothing of Raspberry Pi's is in it. */
import { PAGE, SECTOR } from './flash_chip.mjs';

const WORDS = 4096, TABLE = 0x80, DATA_TABLE = 0x60, STUBS = 0x200, FLOATS = 0x1000;
const code = (name) => name.charCodeAt(0) | (name.charCodeAt(1) << 8);
const CYCLES_PER_MS = 125000;
export const ERASE_MS = 50, PROGRAM_MS = 0.5; // a sector, a page: typical of a W25Q16

/** What the ROM's functions do; arguments are registers, the result goes to r0 if not undefined. */
const FUNCTIONS = {
    P3: ([value]) => popcount(value),
    R3: ([value]) => reverse(value),
    L3: ([value]) => Math.clz32(value),
    T3: ([value]) => (value ? 31 - Math.clz32(value & -value) : 32),
    MS: ([to, value, count], chip) => fill(chip, to, value & 0xff, count),
    S4: ([to, value, count], chip) => fill(chip, to, value & 0xff, count),
    MC: ([to, from, count], chip) => copy(chip, to, from, count),
    C4: ([to, from, count], chip) => copy(chip, to, from, count),
    IF: (_, chip) => chip.ssi.enterSerial(),
    EX: (_, chip) => chip.ssi.enterSerial(),
    FC: (_, chip) => chip.ssi.forceSelect(false),
    CX: (_, chip) => chip.ssi.enterXip(),
    RE: ([offset, count], chip) => eraseFlash(chip, offset, count),
    RP: ([offset, from, count], chip) => programFlash(chip, offset, from, count),
    UB: ([pins, disabled], chip) => chip.enterBootloader(pins, disabled),
};
const NAMES = Object.keys(FUNCTIONS);
const LOOKUP = NAMES.length, FLOAT = LOOKUP + 1; // the last stubs

function popcount(value) {
    let count = 0;
    for (let rest = value >>> 0; rest; rest &= rest - 1) {
        count++;
    }
    return count;
}

function reverse(value) {
    let result = 0;
    for (let bit = 0; bit < 32; bit++) {
        result = (result << 1) | ((value >>> bit) & 1);
    }
    return result >>> 0;
}

function fill(chip, to, value, count) {
    for (let index = 0; index < count; index++) {
        chip.mcu.writeUint8(to + index, value);
    }
    chip.spend(count);
    return to;
}

function copy(chip, to, from, count) {
    for (let index = 0; index < count; index++) {
        chip.mcu.writeUint8(to + index, chip.mcu.readUint8(from + index));
    }
    chip.spend(count * 2);
    return to;
}

function needSerial(chip, what) {
    if (chip.ssi.xip) {
        chip.fault(`ROM: ${what} while the flash is in XIP mode`);
    }
}

function eraseFlash(chip, offset, count) {
    needSerial(chip, 'flash_range_erase');
    chip.flash.eraseRange(offset, count);
    chip.keepFlashBusy((count / SECTOR) * ERASE_MS * CYCLES_PER_MS);
}

function programFlash(chip, offset, from, count) {
    needSerial(chip, 'flash_range_program');
    const data = new Uint8Array(count);
    for (let index = 0; index < count; index++) {
        data[index] = chip.mcu.readUint8(from + index);
    }
    chip.flash.programRange(offset, data);
    chip.keepFlashBusy((count / PAGE) * PROGRAM_MS * CYCLES_PER_MS);
}

/** The image: 16 KiB as 32-bit words. */
export function bootRomImage() {
    const words = new Uint32Array(WORDS), view = new DataView(words.buffer);
    const set16 = (address, value) => view.setUint16(address, value, true);
    view.setUint8(0x10, 0x4d); // "Mu", 1: how the SDK knows an RP2040's ROM
    view.setUint8(0x11, 0x75);
    view.setUint8(0x12, 0x01);
    view.setUint8(0x13, 3);    // version of the B2 chip
    set16(0x14, TABLE);
    set16(0x16, DATA_TABLE);
    NAMES.forEach((name, index) => {
        set16(TABLE + 4 * index, code(name));
        set16(TABLE + 4 * index + 2, stub(index));
    });
    set16(0x18, stub(LOOKUP));
    ['SF', 'SD'].forEach((name, index) => { // looked up at start-up even where none is used
        set16(DATA_TABLE + 4 * index, code(name));
        set16(DATA_TABLE + 4 * index + 2, FLOATS);
    });
    words.fill(stub(FLOAT), FLOATS / 4, FLOATS / 4 + 64);
    for (let index = 0; index <= FLOAT; index++) {
        set16(STUBS + 4 * index, 0xbe00 | index); // bkpt #index
        set16(STUBS + 4 * index + 2, 0x4770);     // bx lr
    }
    return words;
}

const stub = (index) => (STUBS + 4 * index) | 1;

/** Do what the breakpoint at `index` stands for. */
export function callRom(chip, index) {
    const { registers } = chip.mcu.core;
    if (index === LOOKUP) {
        registers[0] = lookUp(chip, registers[0], registers[1]);
        return;
    }
    if (index === FLOAT) {
        chip.fault('ROM: floating point is not modelled');
        return;
    }
    if (index > FLOAT) {
        throw new Error(`breakpoint ${index} at 0x${chip.mcu.core.PC.toString(16)}`);
    }
    const result = FUNCTIONS[NAMES[index]]([...registers.slice(0, 4)], chip);
    if (result !== undefined) {
        registers[0] = result;
    }
}

function lookUp(chip, table, wanted) {
    for (let at = table; chip.mcu.readUint16(at); at += 4) {
        if (chip.mcu.readUint16(at) === wanted) {
            return chip.mcu.readUint16(at + 2);
        }
    }
    chip.fault(`ROM: nothing is called "${String.fromCharCode(wanted & 0xff, wanted >>> 8)}"`);
    return 0;
}
