// SPDX-License-Identifier: Apache-2.0
/** The emulator finds what it is there to find: small programs with one mistake each. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Board } from './board.mjs';
import { unpackUf2 } from './firmware_file.mjs';

const MS = 125000, PROGRAM = 0x100, CODE = 0x1c0, LITERALS = 0x400;
// Addresses
const RESETS_CLEAR = 0x4000f000, TIMER_RAWL = 0x40054028, WATCHDOG = 0x40058000;
const PIO0_CTRL = 0x50200000, PSM_WDSEL = 0x40010008, TICK = 0x4005802c, SSI = 0x18000000;
const DONE = 0x20000100;
// What a second stage must have done for the flash to be readable: a set-up in RAM, like a ROM's.
const XIP_SETUP = [[SSI + 8, 0], [SSI + 0xf4, 0x03000218], [SSI + 8, 1]];

/** CRC-32 of the boot ROM, written once more on purpose. */
function bootCrc(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) {
        for (let bit = 7; bit >= 0; bit--) {
            const top = (crc >>> 31) ^ ((byte >>> bit) & 1);
            crc = ((crc << 1) ^ (top ? 0x04c11db7 : 0)) >>> 0;
        }
    }
    return crc;
}

/** Thumb code that does `steps`: [address, value] writes; {read}; {wfi}; then it loops. */
class Program {
    constructor() {
        this.image = new Uint8Array(0x1000).fill(0xff);
        this.view = new DataView(this.image.buffer);
    }

    /** Second stage: the writes, then on to the vector table. */
    boot2(writes) {
        let at = 0, pool = 0x80;
        const load = (register, value) => { // ldr register, [pc, ...]
            this.view.setUint32(pool, value, true);
            const offset = (pool - ((at + 4) & ~3)) / 4;
            this.view.setUint16(at, 0x4800 | (register << 8) | offset, true);
            at += 2;
            pool += 4;
        };
        const put = (opcode) => {
            this.view.setUint16(at, opcode, true);
            at += 2;
        };
        for (const [address, value] of writes) {
            load(0, address);
            load(1, value);
            put(0x6001); // str r1, [r0]
        }
        load(0, 0x10000000 + CODE + 1);
        put(0x4700); // bx r0
        this.view.setUint32(252, bootCrc(this.image.subarray(0, 252)), true);
        return this;
    }

    main(steps) {
        let at = CODE, pool = LITERALS;
        this.view.setUint32(PROGRAM, 0x20040000, true);
        this.view.setUint32(PROGRAM + 4, 0x10000000 + CODE + 1, true);
        const put = (opcode) => {
            this.view.setUint16(at, opcode, true);
            at += 2;
        };
        const load = (register, value) => {
            this.view.setUint32(pool, value >>> 0, true);
            put(0x4800 | (register << 8) | ((pool - ((at + 4) & ~3)) / 4));
            pool += 4;
        };
        for (const { read, write } of steps) {
            load(0, read ?? write[0]);
            if (read !== undefined) {
                put(0x6802); // ldr r2, [r0]
                load(0, DONE);
                put(0x6002); // str r2, [r0]
            } else {
                load(1, write[1]);
                put(0x6001);
            }
        }
        put(0xe7fe); // b .
        return this;
    }

    run(ms = 1) {
        const board = new Board({ image: this.image });
        board.powerOn();
        board.runTo(ms * MS);
        const { mcu } = board.chip ?? {};
        return { board, faults: board.allFaults(), result: mcu?.readUint32(DONE) };
    }
}

const program = (...steps) => new Program().boot2(XIP_SETUP).main(steps);
const release = (bit) => ({ write: [RESETS_CLEAR, 1 << bit] });
const TICK_ON = { write: [TICK, 0x200 | 12] };

test('a block that is used while it is held in reset is a fault, and none once released', () => {
    const { faults } = program({ write: [PIO0_CTRL, 1] }).run();
    assert.match(faults[0], /PIO0 is written.*held in reset/);
    assert.deepEqual(program(release(10), { write: [PIO0_CTRL, 1] }).run().faults, []);
});

test('the timer stands still without the watchdog\'s tick, and counts microseconds with it', () => {
    const idle = Array.from({ length: 60 }, () => ({ read: TIMER_RAWL }));
    assert.equal(program(release(21), ...idle).run().result, 0);
    const { result, faults } = program(release(21), TICK_ON, ...idle).run();
    assert.ok(result > 0 && result < 20, `${result} us`);
    assert.deepEqual(faults, []);
});

test('a watchdog that bites resets the chip, keeps scratch registers, and says so', () => {
    const { board, faults, result } = program(release(21), TICK_ON,
        { read: WATCHDOG + 8 }, { write: [PSM_WDSEL, 0x1fffc] },
        { write: [WATCHDOG + 4, 20000] }, { write: [WATCHDOG, 0x40000000] }).run(35);
    assert.deepEqual(faults, []);
    assert.equal(board.boots, 4, 'a bite each 10 ms: two counts a microsecond');
    assert.equal(result, 1, 'the reason is the timer');
});

test('a watchdog that would reset nothing is a fault', () => {
    const { faults } = program(TICK_ON, { write: [WATCHDOG, 0x80000000] }).run();
    assert.match(faults[0], /PSM_WDSEL selects nothing/);
});

test('reading flash outside of XIP is a fault', () => {
    const { faults } = new Program().boot2([]).main([]).run();
    assert.match(faults[0], /flash is read at .* outside of XIP/);
});

test('a second stage with a wrong CRC ends in the bootloader', () => {
    const broken = program();
    broken.image[7] ^= 1;
    assert.notEqual(broken.run().board.chip.bootloader, null);
});

test('writing to flash as if it were memory is a fault, writing to ROM has no effect', () => {
    assert.match(program({ write: [0x10000800, 1] }).run().faults[0], /write to flash/);
    assert.deepEqual(program({ write: [0, 1] }).run().faults, []);
});

test('UF2 files that are damaged or for another chip are refused', () => {
    const block = new Uint8Array(512), view = new DataView(block.buffer);
    [0x0a324655, 0x9e5d5157, 0x2000, 0x10000000, 256, 0, 1, 0xe48bff56].forEach((word, index) =>
        view.setUint32(4 * index, word, true));
    view.setUint32(508, 0x0ab16f30, true);
    block.fill(7, 32, 288);
    assert.deepEqual(unpackUf2(block), new Uint8Array(256).fill(7));
    for (const at of [0, 4, 9, 12, 16, 20, 24, 28, 508]) {
        const bad = Uint8Array.from(block);
        bad[at] ^= 0x21;
        assert.throws(() => unpackUf2(bad), /UF2/, `byte ${at}`);
    }
    assert.throws(() => unpackUf2(block.subarray(0, 511)), /UF2/);
    assert.throws(() => unpackUf2(new Uint8Array(0)), /UF2/);
});
