#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
/** The emulated box in real time behind a socket, as docs/emulated-box.md says.
 *
 *     box_server.mjs [--port P] [--wires P] [--firmware FILE] [--flash FILE] [--seed N]
 *
 * With --flash the contents of the flash are kept in a file. Where the machine cannot keep up,
 * the box's time falls behind; it never skips anything. */
import { existsSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { parseArgs } from 'node:util';
import { Board } from './board.mjs';
import { BoxSession } from './box_session.mjs';
import * as socketMessages from './box_socket.mjs';
import { BoxWires } from './box_wires.mjs';
import { boardPins, defaultFirmware, loadFirmware } from './firmware_file.mjs';
import { FLASH_SIZE, FlashChip } from './flash_chip.mjs';
import { UsbHost } from './usb_host.mjs';

const CYCLES_PER_MS = 125000, TICK_MS = 1, MOST_MS_AT_ONCE = 20, SAVE_EVERY_MS = 1000;

function fail(text) {
    process.stderr.write(`emulated box: ${text}\n`);
    process.exit(2);
}

const HELP = `usage: box_server.mjs [--port P] [--wires P] [--firmware FILE] [--flash FILE]
                      [--seed N]

The trigger box's firmware on an emulated board, in real time, on a socket of this machine
(docs/emulated-box.md).

  --port P         TCP port on 127.0.0.1; 0 picks one (47653)
  --wires P        TCP port for a simulated camera on TRIG and STROBE; 0 picks one (none)
  --firmware FILE  .uf2 or .bin (build/firmware/opms-box.uf2)
  --flash FILE     keeps the flash, settings included, over runs (nothing is kept)
  --seed N         of the board's noise, so that boot ids repeat (another one each run)
`;

function readArguments() {
    try {
        return parseArgs({ options: {
            help: { type: 'boolean' },
            port: { type: 'string', default: '47653' },
            wires: { type: 'string' },
            firmware: { type: 'string', default: defaultFirmware },
            flash: { type: 'string' },
            seed: { type: 'string', default: String(process.pid) },
        } }).values;
    } catch (error) {
        return fail(error.message);
    }
}

function loadFlash(path) {
    const flash = new FlashChip();
    if (path && existsSync(path)) {
        const bytes = readFileSync(path);
        if (bytes.length !== FLASH_SIZE) {
            fail(`${path} has ${bytes.length} bytes, not ${FLASH_SIZE}`);
        }
        flash.load(bytes);
    }
    return flash;
}

/** The box, and the one session that hears of it. */
class EmulatedBox {
    constructor({ image, flash, flashPath, seed }) {
        this.flashPath = flashPath;
        this.pins = boardPins();
        this.board = new Board({ image, flash, seed });
        this.host = new UsbHost(this.board);
        this.disconnect();
        this.saved = flash.work;
        this.told = 0;
        const tell = (bytes) => this.session?.write(bytes);
        this.host.onReady = (device) => tell(socketMessages.attached(device));
        this.host.onGone = () => tell(socketMessages.detached());
        this.host.onInput = (_, data) => tell(socketMessages.input(data));
        this.board.listeners.push((...edge) => this.session?.edge(...edge));
    }

    /** The endpoint is read while somebody has the device open, as operating systems do. */
    connect(session) {
        this.session = session;
        this.host.polls = true;
        if (this.host.device) {
            session.write(socketMessages.attached(this.host.device));
        }
    }

    disconnect() {
        this.session = null;
        this.host.polls = false;
    }

    /** Keep up with the wall clock, a little at a time so that the socket stays responsive. */
    runInRealTime() {
        let last = process.hrtime.bigint(), owed = 0;
        setInterval(() => {
            const now = process.hrtime.bigint();
            owed = Math.min(owed + Number(now - last) / 1e6, 10 * MOST_MS_AT_ONCE);
            last = now;
            const ms = Math.min(owed, MOST_MS_AT_ONCE);
            owed -= ms;
            this.board.runTo(this.board.now + Math.round(ms * CYCLES_PER_MS));
        }, TICK_MS);
        setInterval(() => {
            this.save();
            this.tellFaults();
        }, SAVE_EVERY_MS);
    }

    save() {
        const { flash } = this.board;
        if (this.flashPath && flash.work !== this.saved) {
            writeFileSync(`${this.flashPath}.new`, flash.bytes);
            renameSync(`${this.flashPath}.new`, this.flashPath);
            this.saved = flash.work;
        }
    }

    /** What the emulator has found wrong with the program, each once. */
    tellFaults() {
        const faults = this.board.allFaults();
        faults.slice(this.told).forEach((text) => process.stderr.write(`emulated box: ${text}\n`));
        this.told = faults.length;
    }
}

/** One host at a time; the next one waits until it is gone. */
class Door {
    constructor(box) {
        this.box = box;
        this.waiting = [];
    }

    arrive(socket) {
        socket.setNoDelay(true);
        socket.pause();
        socket.on('error', () => socket.destroy());
        socket.on('close', () => {
            this.waiting = this.waiting.filter((other) => other !== socket);
            if (this.inside === socket) {
                this.inside = null;
                this.box.disconnect();
                this.#next();
            }
        });
        this.waiting.push(socket);
        this.#next();
    }

    #next() {
        if (this.inside || !this.waiting.length) {
            return;
        }
        const socket = this.waiting.shift();
        this.inside = socket;
        const session = new BoxSession(this.box, (bytes) => socket.writable && socket.write(bytes));
        socket.on('data', (chunk) => {
            try {
                session.take(chunk);
            } catch (error) {
                if (!(error instanceof socketMessages.SocketError)) {
                    throw error;
                }
                process.stderr.write(`emulated box: ${error.message}; connection closed\n`);
                socket.destroy();
            }
        });
        this.box.connect(session);
        socket.resume();
    }
}

function portOf(name, text) {
    const port = Number(text);
    return Number.isInteger(port) && port >= 0 && port <= 65535
        ? port : fail(`${name} ${text} is no port`);
}

function listenForCameras(box, port) {
    const wires = new BoxWires(box.board, box.pins);
    const server = createServer((socket) => wires.arrive(socket));
    server.on('error', (error) => fail(error.message));
    server.listen(port, '127.0.0.1', () =>
        process.stdout.write(`wires on 127.0.0.1:${server.address().port}\n`));
}

function main() {
    const options = readArguments();
    if (options.help) {
        process.stdout.write(HELP);
        return;
    }
    const port = portOf('--port', options.port);
    const wiresPort = options.wires === undefined ? null : portOf('--wires', options.wires);
    if (!existsSync(options.firmware)) {
        fail(`no firmware at ${options.firmware}: build it with ./run firmware`);
    }
    const { image } = loadFirmware(options.firmware);
    const box = new EmulatedBox({ image, flash: loadFlash(options.flash),
        flashPath: options.flash, seed: Number(options.seed) });
    const door = new Door(box);
    const server = createServer((socket) => door.arrive(socket));
    server.on('error', (error) => fail(error.message));
    server.listen(port, '127.0.0.1', () => {
        box.board.powerOn();
        box.runInRealTime();
        process.stdout.write(`emulated box on 127.0.0.1:${server.address().port}\n`);
        if (wiresPort !== null) {
            listenForCameras(box, wiresPort);
        }
    });
    for (const signal of ['SIGINT', 'SIGTERM']) {
        process.on(signal, () => {
            box.save();
            box.tellFaults();
            process.exit(0);
        });
    }
}

main();
