// SPDX-License-Identifier: Apache-2.0
/** A peripheral of ours in rp2040js' address map: registers with the RP2040's atomic aliases. */
export class RegisterBlock {
    constructor(chip, name) {
        this.chip = chip;
        this.name = name;
    }

    readUint32(offset) {
        return this.read(offset & 0xfff) >>> 0;
    }

    /** @param alias  0 plain, 1 XOR, 2 set, 3 clear; `raw` tells write() what the CPU wrote. */
    writeUint32Atomic(offset, raw, alias) {
        const now = alias ? this.peek(offset) : 0;
        const value = [raw, now ^ raw, now | raw, now & ~raw][alias];
        this.write(offset, value >>> 0, raw >>> 0);
    }

    writeUint32(offset, value) {
        this.write(offset, value >>> 0, value >>> 0);
    }

    /** What an atomic write works on: the register without what reading it would set off. */
    peek(offset) {
        return this.read(offset);
    }

    unknownRead(offset) {
        this.chip.fault(`${this.name}: read of register 0x${offset.toString(16)}, not modelled`);
        return 0;
    }

    unknownWrite(offset, value) {
        this.chip.fault(`${this.name}: 0x${value.toString(16)} written to register ` +
            `0x${offset.toString(16)}, not modelled`);
    }
}
