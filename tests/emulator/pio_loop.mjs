// SPDX-License-Identifier: Apache-2.0
/** Find loops that do nothing but count, look at a pin, or drive pins as they are.
 *
 * A box that waits 100 ms spends twelve million instructions in `jmp x-- self`, one that debounces
 * spends them in `jmp pin` and `jmp x--`. Their course is known beforehand: they are stepped over
 * in one go. Anything that is not plainly such a loop is carried out instruction by instruction. */

const LONGEST = 8;
const JMP = { always: 0, notX: 1, decX: 2, notY: 3, decY: 4, differ: 5, pin: 6 };

const isSetPins = (opcode) => [0xe000, 0xe080].includes(opcode & 0xe0e0);
const isNop = (opcode) => (opcode & 0xe0ff) === 0xa042 || (opcode & 0xe0ff) === 0xa021;

/** The pins that an instruction drives: {mask, value, isDirections}, by side-set or by SET. */
function drives(machine, opcode, { value, bits }) {
    const driven = [];
    if (bits) {
        driven.push({ base: (machine.pinctrl >>> 10) & 0x1f, bits, value,
            isDirections: (machine.execctrl & (1 << 29)) !== 0 });
    }
    if (isSetPins(opcode)) {
        driven.push({ base: (machine.pinctrl >>> 5) & 0x1f, bits: (machine.pinctrl >>> 26) & 7,
            value: opcode & 0x1f, isDirections: ((opcode >>> 5) & 7) === 4 });
    }
    return driven;
}

/** The pins that an instruction leaves as they are by driving them so; null if it changes one. */
function heldPins(machine, opcode, side) {
    const { block } = machine;
    let held = 0;
    for (const { base, bits, value, isDirections } of drives(machine, opcode, side)) {
        const now = isDirections ? block.pinDirections : block.pinValues;
        for (let bit = 0; bit < bits; bit++) {
            const pin = (base + bit) & 0x1f;
            if (((now >>> pin) & 1) !== ((value >>> bit) & 1)) {
                return null;
            }
            held |= 1 << pin;
        }
    }
    return held;
}

/** Is the jump taken, as long as what it counts has not come to an end? */
function outcome(machine, condition) {
    switch (condition) {
        case JMP.always: case JMP.decX: case JMP.decY: return true;
        case JMP.notX: return machine.x === 0;
        case JMP.notY: return machine.y === 0;
        case JMP.differ: return machine.x !== machine.y;
        case JMP.pin: return machine.block.input(machine.jmpPin);
        default: return machine.osrCount < machine.pullThreshold;
    }
}

/** The loop that begins at the machine's next instruction.
 * @returns {length, holds, iterations, xSteps, ySteps, pin}: its length in ticks, a mask of the
 * pins that it keeps driving, the pin that it looks at or -1; null if there is no such loop. */
export function findLoop(machine) {
    const used = new Set();
    const { memory } = machine.block;
    let { pc } = machine, length = 0, holds = 0;
    const steps = { [JMP.decX]: 0, [JMP.decY]: 0 };
    for (let count = 0; count < LONGEST; count++) {
        const opcode = memory[pc], side = machine.side(opcode);
        const held = heldPins(machine, opcode, side);
        const isQuiet = opcode >>> 13 === 0 || isNop(opcode) || isSetPins(opcode);
        if (held === null || !isQuiet) {
            return null;
        }
        holds |= held;
        length += 1 + side.delay;
        let taken = false;
        if (opcode >>> 13 === 0) {
            const condition = (opcode >>> 5) & 7;
            used.add(condition);
            if (condition in steps) {
                steps[condition]++;
            }
            taken = outcome(machine, condition);
            pc = taken ? opcode & 0x1f : pc;
        }
        if (!taken) {
            pc = pc === machine.wrapTop ? machine.wrapBottom : (pc + 1) & 0x1f;
        }
        if (pc === machine.pc) {
            return describe(machine, used, steps, { length, holds });
        }
    }
    return null;
}

function describe(machine, used, steps, loop) {
    const xSteps = steps[JMP.decX], ySteps = steps[JMP.decY];
    const looksAtX = used.has(JMP.notX) || used.has(JMP.differ);
    const looksAtY = used.has(JMP.notY) || used.has(JMP.differ);
    const unknown = xSteps > 1 || ySteps > 1 || (xSteps && looksAtX) || (ySteps && looksAtY) ||
        used.has(7);
    const iterations = Math.min(xSteps ? machine.x : Infinity, ySteps ? machine.y : Infinity);
    if (unknown || iterations < 2) {
        return null;
    }
    const pin = used.has(JMP.pin) ? machine.jmpPin : -1;
    return { ...loop, iterations, xSteps, ySteps, pin };
}
