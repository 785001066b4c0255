// SPDX-License-Identifier: Apache-2.0
/** The NOR flash of the board (W25Q16: 2 MiB): erase makes ones, programming only clears bits, and
 * what is in it outlives the power. The power can be cut after any byte of an erase or a write. */
import { randomGenerator } from './small_blocks.mjs';

export const FLASH_SIZE = 2 * 1024 * 1024, SECTOR = 4096, PAGE = 256;
const WRITE_ENABLED = 2;

/** Thrown out of the emulation when the supply fails; the chip must not be run any further. */
export class PowerCut extends Error {
    constructor() {
        super('the power was cut');
    }
}

export class FlashChip {
    constructor({ uniqueId = [0xe6, 0x60, 0x58, 0x38, 0x83, 0x3a, 0x5f, 0x2c] } = {}) {
        this.bytes = new Uint8Array(FLASH_SIZE).fill(0xff);
        this.view = new DataView(this.bytes.buffer);
        this.uniqueId = Uint8Array.from(uniqueId);
        this.status = 0;
        this.status2 = 0;
        this.cutAfter = Infinity; // bytes of work until the power fails
        this.scramble = null;     // generator: what is being worked on is left half done
        this.work = 0;            // bytes erased and programmed so far
        this.eraseSectors = 0;
        this.command = [];
    }

    /** Put in what a programmer would: no wear, no commands. */
    load(image) {
        this.bytes.set(image, 0);
    }

    /** Fail after `bytes` further bytes of erasing and programming.
     * @param seed  not null: bytes that were not finished hold random bits between old and new. */
    cutPowerAfter(bytes, seed = null) {
        this.cutAfter = bytes;
        this.scramble = seed === null ? null : randomGenerator(seed);
    }

    restorePower() {
        this.cutAfter = Infinity;
        this.command = [];
    }

    eraseRange(offset, count) {
        this.#check(offset, count, SECTOR);
        for (let at = offset; at < offset + count; at++) {
            if (this.cutAfter === 0) {
                const end = Math.floor(at / SECTOR + 1) * SECTOR;
                this.#leaveHalfDone(at, end, (old, random) => old | random);
            }
            this.#spend();
            this.bytes[at] = 0xff;
        }
        this.eraseSectors += count / SECTOR;
    }

    programRange(offset, data) {
        this.#check(offset, data.length, PAGE);
        data.forEach((value, index) => {
            const at = offset + index;
            if (this.cutAfter === 0) {
                this.#leaveHalfDone(at, at + 1, (old, random) => old & (value | random));
            }
            this.#spend();
            this.bytes[at] &= value;
        });
    }

    #check(offset, count, unit) {
        if (offset % unit || count % unit || offset + count > FLASH_SIZE) {
            throw new Error(`flash: ${count} bytes at ${offset} are not whole units of ${unit}`);
        }
    }

    #leaveHalfDone(from, to, mix) {
        for (let at = from; this.scramble && at < to; at++) {
            this.bytes[at] = mix(this.bytes[at], this.scramble() & 0xff);
        }
        throw new PowerCut();
    }

    #spend() {
        this.cutAfter--;
        this.work++;
    }

    // --- serial commands ------------------------------------------------------------------------

    deselect() {
        const [code] = this.command;
        if (code === 0x06) {
            this.status |= WRITE_ENABLED;
        } else if (code === 0x04) {
            this.status &= ~WRITE_ENABLED;
        } else if (code === 0x01 && this.status & WRITE_ENABLED) {
            this.status2 = this.command[2] ?? this.status2;
            this.status &= ~WRITE_ENABLED;
        }
        this.command = [];
    }

    /** One byte in, one byte out, while the chip is selected. @returns null: unknown command. */
    transfer(byte) {
        this.command.push(byte);
        const [code] = this.command, index = this.command.length - 1;
        if (index === 0) {
            return [0x01, 0x03, 0x04, 0x05, 0x06, 0x35, 0x4b, 0x9f, 0xff].includes(code) ? 0xff
                : null;
        }
        switch (code) {
            case 0x05: return this.status;
            case 0x35: return this.status2;
            case 0x4b: return index >= 5 ? this.uniqueId[(index - 5) % 8] : 0xff;
            case 0x9f: return [0xef, 0x40, 0x15][(index - 1) % 3];
            case 0x03: return index < 4 ? 0xff : this.bytes[this.#address() + index - 4];
            default: return 0xff;
        }
    }

    #address() {
        return ((this.command[1] << 16) | (this.command[2] << 8) | this.command[3]) % FLASH_SIZE;
    }
}
