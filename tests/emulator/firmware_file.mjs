// SPDX-License-Identifier: Apache-2.0
/** The program that ships, as a file: UF2 or the plain binary, and which pins it uses. */
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { dirname, extname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const FLASH = 0x10000000, BLOCK = 512, FAMILY_RP2040 = 0xe48bff56;
const MAGIC = [0x0a324655, 0x9e5d5157], MAGIC_END = 0x0ab16f30, HAS_FAMILY = 0x2000;

export const repository = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
export const defaultFirmware = join(repository, 'build', 'firmware', 'opms-box.uf2');

/** What a Pico's drive writes to flash from a UF2 file, from offset 0 on. */
export function unpackUf2(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
    const word = (at) => view.getUint32(at, true);
    const chunks = [];
    if (!bytes.length || bytes.length % BLOCK) {
        throw new Error(`UF2: ${bytes.length} bytes are not whole blocks`);
    }
    for (let at = 0; at < bytes.length; at += BLOCK) {
        const isBlock = word(at) === MAGIC[0] && word(at + 4) === MAGIC[1] &&
            word(at + BLOCK - 4) === MAGIC_END;
        if (!isBlock || !(word(at + 8) & HAS_FAMILY) || word(at + 28) !== FAMILY_RP2040) {
            throw new Error(`UF2: block ${at / BLOCK} is not one for an RP2040`);
        }
        const size = word(at + 16), offset = word(at + 12) - FLASH;
        if (offset < 0 || offset % 256 || size !== 256) {
            throw new Error(`UF2: block ${at / BLOCK} writes ${size} bytes at ${offset}`);
        }
        if (word(at + 20) !== at / BLOCK || word(at + 24) !== bytes.length / BLOCK) {
            throw new Error(`UF2: block ${at / BLOCK} has a wrong number`);
        }
        chunks.push({ offset, data: bytes.subarray(at + 32, at + 32 + size) });
    }
    const end = Math.max(...chunks.map(({ offset, data }) => offset + data.length));
    const image = new Uint8Array(end).fill(0xff);
    chunks.forEach(({ offset, data }) => image.set(data, offset));
    return image;
}

/** @returns {path, image, sha256} of a .uf2 or .bin file. */
export function loadFirmware(path = defaultFirmware) {
    const bytes = new Uint8Array(readFileSync(path));
    const image = extname(path) === '.uf2' ? unpackUf2(bytes) : bytes;
    return { path, image, sha256: createHash('sha256').update(image).digest('hex') };
}

/** The same program in the other form: the .bin that lies beside a .uf2, or the other way. */
export function firmwareBeside(path) {
    const suffix = extname(path);
    return path.slice(0, -suffix.length) + (suffix === '.uf2' ? '.bin' : '.uf2');
}

/** Pins by name, from the one file that says so. */
export function boardPins() {
    const text = readFileSync(join(repository, 'firmware', 'app', 'board_pins.h'), 'utf8');
    const pins = {};
    for (const [, name, number] of text.matchAll(/^#define PIN_(\w+) (\d+)U?\b/gm)) {
        pins[name] = Number(number);
    }
    for (const name of ['START', 'TRIG', 'STROBE', 'SYNC', 'LED']) {
        if (pins[name] === undefined) {
            throw new Error(`board_pins.h does not define PIN_${name}`);
        }
    }
    return pins;
}
