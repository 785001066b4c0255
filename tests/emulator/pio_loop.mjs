// SPDX-License-Identifier: Apache-2.0
/** Find loops that do nothing but count and look at a pin.
 *
 * A box that waits 100 ms spends twelve million instructions in `jmp x-- self`, one that debounces
 * spends them in `jmp pin` and `jmp x--`. Their course is known beforehand: they are stepped over
 * in one go. Anything that is not plainly such a loop is carried out instruction by instruction. */

const LONGEST = 8;
const JMP = { always: 0, notX: 1, decX: 2, notY: 3, decY: 4, differ: 5, pin: 6 };

const isNop = (opcode) => (opcode & 0xe0ff) === 0xa042 || (opcode & 0xe0ff) === 0xa021;

/** Does the instruction's side-set leave pins as they are? */
function sideIsQuiet(machine, { value, bits }) {
    if (!bits) {
        return true;
    }
    const { block } = machine, base = (machine.pinctrl >>> 10) & 0x1f;
    const now = machine.execctrl & (1 << 29) ? block.pinDirections : block.pinValues;
    for (let bit = 0; bit < bits; bit++) {
        if (((now >>> ((base + bit) & 0x1f)) & 1) !== ((value >>> bit) & 1)) {
            return false;
        }
    }
    return true;
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
 * @returns {length, iterations, xSteps, ySteps, pin} with the length in ticks and pin -1 if none is
 * looked at; null if there is no such loop. */
export function findLoop(machine) {
    const used = new Set();
    const { memory } = machine.block;
    let { pc } = machine, length = 0;
    const steps = { [JMP.decX]: 0, [JMP.decY]: 0 };
    for (let count = 0; count < LONGEST; count++) {
        const opcode = memory[pc], side = machine.side(opcode);
        if (!sideIsQuiet(machine, side) || (opcode >>> 13 !== 0 && !isNop(opcode))) {
            return null;
        }
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
            return describe(machine, used, steps, length);
        }
    }
    return null;
}

function describe(machine, used, steps, length) {
    const xSteps = steps[JMP.decX], ySteps = steps[JMP.decY];
    const looksAtX = used.has(JMP.notX) || used.has(JMP.differ);
    const looksAtY = used.has(JMP.notY) || used.has(JMP.differ);
    const unknown = xSteps > 1 || ySteps > 1 || (xSteps && looksAtX) || (ySteps && looksAtY) ||
        used.has(7);
    const iterations = Math.min(xSteps ? machine.x : Infinity, ySteps ? machine.y : Infinity);
    if (unknown || iterations < 2) {
        return null;
    }
    return { length, iterations, xSteps, ySteps, pin: used.has(JMP.pin) ? machine.jmpPin : -1 };
}
