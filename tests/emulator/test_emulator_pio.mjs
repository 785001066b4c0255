// SPDX-License-Identifier: Apache-2.0
/** The emulator's own PIO and DMA: instructions by the datasheet's timing, and loops that are
 * stepped over against the same loops carried out one instruction at a time. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { DmaBlock } from './dma_block.mjs';
import { EventQueue } from './event_queue.mjs';
import { PioBlock } from './pio_block.mjs';
import { randomGenerator } from './small_blocks.mjs';

const PIN_IN = 2, PIN_OUT = 3;
const JMP = { always: 0, notX: 1, decX: 2, notY: 3, decY: 4, differ: 5, pin: 6 };
const jmp = (condition, to, delay = 0) => (condition << 5) | to | (delay << 8);
const set = (destination, value, delay = 0) => 0xe000 | (destination << 5) | value | (delay << 8);
const PINS = 0, X = 1, Y = 2;
const waitPin = (level) => 0x2000 | (level << 7) | (1 << 5);
const PUSH = 0x8000, PULL_BLOCK = 0x80a0, MOV_ISR_X = 0xa0c1, MOV_X_OSR = 0xa027;

/** As much of a chip as one PIO block and the DMA need. */
function fakeChip() {
    const chip = { now: 0, events: new EventQueue(), edges: [], faults: [], memory: new Map(),
        mcu: { setInterrupt: () => undefined }, onPioEnabled: () => undefined,
        fault: (text) => chip.faults.push(text) };
    chip.nets = { outputsChanged: () => chip.edges.push(
        [chip.now, (chip.pio[0].pinValues >>> PIN_OUT) & 1]) };
    chip.dma = new DmaBlock(chip);
    chip.pio = [new PioBlock(chip, 0, 7, 0), new PioBlock(chip, 1, 9, 8)];
    chip.run = (until) => {
        for (;;) {
            const due = Math.min(chip.events.next, chip.pio[0].due);
            if (due > until) {
                chip.now = until;
                return;
            }
            chip.now = Math.max(due, chip.now);
            chip.events.run(chip.now);
            if (chip.pio[0].due <= chip.now) {
                chip.pio[0].step(chip.now);
            }
        }
    };
    return chip;
}

/** A machine with a program, its pins set up; started at cycle 0. */
function machine(program, { parks = true, index = 0, clkdiv = 1 << 16, wrap = null } = {}) {
    const chip = fakeChip(), [pio] = chip.pio, at = 0xc8 + 0x18 * index;
    program.forEach((opcode, position) => pio.writeUint32(0x48 + 4 * position, opcode));
    const top = wrap ?? program.length - 1;
    pio.writeUint32(at, clkdiv);
    pio.writeUint32(at + 4, (PIN_IN << 24) | (top << 12));
    pio.writeUint32(at + 0x14, (1 << 26) | (PIN_OUT << 5) | (PIN_IN << 15));
    const sm = pio.sms[index];
    sm.mayPark = parks;
    if (!parks) {
        sm.park = () => undefined;
    }
    pio.writeUint32(0, 1 << index);
    return { chip, pio, sm };
}

test('an instruction takes one cycle and its delay, and SET drives in its own cycle', () => {
    const { chip } = machine([set(PINS, 1, 4), set(PINS, 0, 2)]);
    chip.run(20);
    assert.deepEqual(chip.edges.map(([cycle]) => cycle), [1, 6, 9, 14, 17]);
});

test('the clock divider stretches every cycle, fractions included', () => {
    const { chip } = machine([set(PINS, 1), set(PINS, 0)], { clkdiv: (2 << 16) | (128 << 8) });
    chip.run(30);
    const cycles = chip.edges.map(([cycle]) => cycle);
    assert.deepEqual(cycles.slice(0, 7), [1, 4, 6, 9, 11, 14, 16]);
});

test('jmp x-- loops x + 1 times and leaves x at its largest', () => {
    for (const parks of [true, false]) {
        const { chip, sm } = machine([PULL_BLOCK, MOV_X_OSR, jmp(JMP.decX, 2), set(PINS, 1),
            jmp(JMP.always, 4)], { parks });
        chip.pio[0].writeUint32(0x10, 1000);
        chip.run(5000);
        assert.deepEqual(chip.edges, [[1 + 1 + 1 + 1001, 1]], `${parks}`);
        assert.equal(sm.x, 0xffffffff);
    }
});

test('a machine that is looked at or stopped within a loop has counted so far', () => {
    const { chip, pio, sm } = machine([PULL_BLOCK, MOV_X_OSR, jmp(JMP.decX, 2), set(PINS, 1)]);
    pio.writeUint32(0x10, 1000);
    chip.run(503); // two instructions, then 500 of the loop
    assert.equal(pio.readUint32(0xd4), 2);
    pio.writeUint32(0, 0);
    assert.equal(sm.x, 500);
    chip.run(10000);
    assert.deepEqual(chip.edges, []);
    pio.writeUint32(0xd8, MOV_ISR_X);
    pio.writeUint32(0xd8, PUSH);
    assert.equal(pio.readUint32(0x20), 500);
});

test('WAIT sees a pin in the cycle in which the synchroniser shows it', () => {
    const { chip, pio } = machine([waitPin(1), set(PINS, 1), waitPin(0), set(PINS, 0)]);
    chip.events.at(100, () => pio.setInput(PIN_IN, true));
    chip.events.at(200, () => pio.setInput(PIN_IN, false));
    chip.run(300);
    assert.deepEqual(chip.edges, [[101, 1], [201, 0]]);
});

test('IRQ flags reach another machine in the next cycle, and WAIT clears them', () => {
    const { chip, pio } = machine([set(X, 5), jmp(JMP.decX, 1), 0xc004, jmp(JMP.always, 3)]);
    pio.writeUint32(0x48 + 4 * 10, 0x20c4); // machine 1: wait 1 irq 4, set pins 1
    pio.writeUint32(0x48 + 4 * 11, set(PINS, 1));
    pio.writeUint32(0x48 + 4 * 12, jmp(JMP.always, 12));
    pio.writeUint32(0xe0 + 0x14, (1 << 26) | (PIN_OUT << 5));
    pio.writeUint32(0xe0 + 0x10, jmp(JMP.always, 10));
    pio.writeUint32(0, 3);
    chip.run(50);
    assert.deepEqual(chip.edges, [[8 + 2, 1]]); // set at 8, seen at 9, driven at 10
    assert.equal(pio.flags, 0);
});

/** A program of jumps, waits and pushes, which may loop in any way. */
function randomProgram(random) {
    const length = 4 + (random() % 8);
    return Array.from({ length }, () => {
        const delay = random() % 3 ? 0 : random() % 5, to = random() % length;
        switch (random() % 10) {
            case 0: return set(PINS, random() & 1, delay);
            case 1: return set(random() & 1 ? X : Y, random() % 32, delay);
            case 2: return waitPin(random() & 1) | (delay << 8);
            case 3: return MOV_X_OSR;
            case 4: return 0xa042 | (delay << 8);
            case 5: return jmp(JMP.pin, to, delay);
            case 6: return jmp(JMP.decY, to, delay);
            case 7: return jmp(random() % 7, to, delay);
            default: return jmp(JMP.decX, to, delay);
        }
    });
}

test('stepping over loops changes nothing: 400 random programs with random pins', () => {
    const random = randomGenerator(4242);
    let skipped = 0;
    for (let count = 0; count < 400; count++) {
        const program = randomProgram(random), clkdiv = random() % 3 ? 1 << 16 : 0x00034000;
        const flips = Array.from({ length: 12 }, () => 5 + (random() % 4000))
            .sort((a, b) => a - b);
        const runs = [true, false].map((parks) => {
            const { chip, pio, sm } = machine(program, { parks, clkdiv });
            pio.writeUint32(0xd8, 0x80a0); // OSR for MOV
            pio.writeUint32(0x10, 1500);
            flips.forEach((at, index) =>
                chip.events.at(at, () => pio.setInput(PIN_IN, index % 2 === 0)));
            chip.run(4500);
            skipped += sm.loop ? 1 : 0;
            sm.catchUp(chip.now + 1);
            pio.writeUint32(0, 0);
            return { edges: chip.edges, x: sm.x, y: sm.y, pc: sm.pc };
        });
        assert.deepEqual(runs[0], runs[1], `program ${count}: ${program.map((opcode) =>
            opcode.toString(16))}`);
    }
    assert.ok(skipped > 40, `${skipped} of the programs ended in a loop that is stepped over`);
});

test('of two machines that drive a pin in one cycle the higher counts, also out of a loop', () => {
    for (const parks of [true, false]) {
        const { chip, pio } = machine([jmp(JMP.decX, 1), set(PINS, 1), jmp(JMP.always, 1)],
            { parks, index: 1, wrap: 2 });
        pio.writeUint32(0x48 + 4 * 10, set(PINS, 0)); // machine 0 pulls it down once
        pio.writeUint32(0x48 + 4 * 11, jmp(JMP.always, 11));
        pio.writeUint32(0xc8 + 0x14, (1 << 26) | (PIN_OUT << 5));
        pio.writeUint32(0xc8 + 0x10, jmp(JMP.always, 10));
        chip.run(101);
        pio.writeUint32(0, 3);
        chip.run(300);
        const low = chip.edges.filter(([, level]) => level === 0).length;
        assert.ok(low <= 1 && (pio.pinValues >>> PIN_OUT) & 1, `${JSON.stringify(chip.edges)}`);
    }
});

test('DMA copies what a FIFO gets into a ring, word by word', () => {
    const { chip, pio } = machine([set(X, 31), MOV_ISR_X, PUSH, jmp(JMP.decX, 1, 3)]);
    const written = [];
    chip.mcu.readUint32 = () => pio.readUint32(0x20);
    chip.mcu.writeUint32 = (address, value) => written.push([address, value]);
    const { dma } = chip;
    dma.writeUint32(0x00, 0x50200020);
    dma.writeUint32(0x04, 0x20000000);
    dma.writeUint32(0x08, 20);
    // EN, 32 bits, write increment, ring of 16 bytes on write, DREQ of PIO0 RX0
    dma.writeUint32(0x0c, 1 | (2 << 2) | (1 << 5) | (4 << 6) | (1 << 10) | (4 << 15));
    chip.run(1000);
    assert.deepEqual(written.slice(0, 6).map(([address]) => address & 0xf), [0, 4, 8, 12, 0, 4]);
    assert.deepEqual(written.map(([, value]) => value),
        Array.from({ length: 20 }, (_, index) => 31 - index));
    assert.equal(dma.readUint32(0x08), 0);
    assert.equal(dma.raw, 1);
});

test('events happen in the order of their times, and of asking where these are equal', () => {
    const queue = new EventQueue(), seen = [];
    for (const [time, name] of [[5, 'a'], [3, 'b'], [5, 'c'], [4, 'd'], [5, 'e']]) {
        queue.at(time, () => seen.push(name));
    }
    const cancelled = queue.at(4, () => seen.push('never'));
    queue.cancel(cancelled);
    queue.run(4);
    assert.deepEqual([seen.join(''), queue.next], ['bd', 5]);
    queue.run(9);
    assert.deepEqual([seen.join(''), queue.next], ['bdace', Infinity]);
});
