// SPDX-License-Identifier: Apache-2.0
/** The wires between the emulated box and a camera: TRIG goes out, STROBE comes back.
 *
 * A socket is too slow for edges that follow each other within microseconds. So the camera tells
 * beforehand what exposure it makes after a pulse, and STROBE is driven here, at the emulated
 * instant. */
import * as socketMessages from './box_socket.mjs';

const NS_PER_CYCLE = 8, TRIG_LINE = 2;

export class BoxWires {
    constructor(board, pins) {
        this.board = board;
        this.pins = pins;
        this.cameras = new Set();
        board.listeners.push((pin, level, cycle) => {
            if (pin === pins.TRIG) {
                this.#trigger(level, cycle);
            }
        });
    }

    /** A camera's connection. */
    arrive(socket) {
        const camera = { socket, delay: 0, length: 0,
            reader: new socketMessages.MessageReader(socketMessages.WIRES_PAYLOAD) };
        this.cameras.add(camera);
        socket.setNoDelay(true);
        socket.on('error', () => socket.destroy());
        socket.on('close', () => this.cameras.delete(camera));
        socket.on('data', (chunk) => {
            try {
                camera.reader.take(chunk).forEach(({ payload }) => this.#command(camera, payload));
            } catch (error) {
                if (!(error instanceof socketMessages.SocketError)) {
                    throw error;
                }
                process.stderr.write(`wires: ${error.message}; connection closed\n`);
                socket.destroy();
            }
        });
    }

    /** In whole cycles, as the emulated clock counts. */
    #command(camera, payload) {
        const [delay, length] = [0, 8].map((at) =>
            Math.round(Number(payload.readBigUInt64LE(at)) / NS_PER_CYCLE));
        Object.assign(camera, { delay, length });
        camera.socket.write(socketMessages.exposing());
    }

    #trigger(level, cycle) {
        for (const { socket, delay, length } of this.cameras) {
            if (socket.writable) {
                socket.write(socketMessages.edge(TRIG_LINE, level, cycle * NS_PER_CYCLE));
            }
            if (level === 1 && length > 0) {
                const { board, pins } = this;
                board.at(cycle + delay, () => board.drive(pins.STROBE, 1));
                board.at(cycle + delay + length, () => board.drive(pins.STROBE, 0));
                if (socket.writable) {
                    socket.write(socketMessages.exposure(cycle * NS_PER_CYCLE,
                        delay * NS_PER_CYCLE, length * NS_PER_CYCLE));
                }
            }
        }
    }
}
