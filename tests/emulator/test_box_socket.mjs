// SPDX-License-Identifier: Apache-2.0
/** The emulated box on its socket, message by message as docs/emulated-box.md says. */
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync, statSync } from 'node:fs';
import { connect } from 'node:net';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { firmwarePath, shippedFirmware } from './box_bench.mjs';
import { KIND, STATUS } from './box_socket.mjs';
import * as wire from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

const here = dirname(fileURLToPath(import.meta.url)), PATIENCE_MS = 120000;
const folder = mkdtempSync(join(tmpdir(), 'opms-emulated-box-'));
const started = [];
after(() => {
    started.forEach((child) => child.kill('SIGKILL'));
    rmSync(folder, { recursive: true });
});

function within(promise, what) {
    let timer;
    const late = new Promise((_, reject) => {
        timer = setTimeout(() => reject(new Error(`waited for ${what}`)), PATIENCE_MS);
    });
    return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** A running server: {port, stderr(), stop()}. */
async function server(...extra) {
    shippedFirmware();
    const child = spawn(process.execPath, [join(here, 'box_server.mjs'), '--port', '0',
        '--firmware', firmwarePath, ...extra]);
    started.push(child);
    let errors = '';
    child.stderr.on('data', (text) => {
        errors += text;
    });
    const line = await within(new Promise((resolve) => {
        child.stdout.once('data', (text) => resolve(String(text)));
    }), 'the server');
    assert.match(line, /^emulated box on 127\.0\.0\.1:\d+\n$/);
    return { port: Number(line.match(/:(\d+)/)[1]), stderr: () => errors,
        stop: () => new Promise((resolve) => {
            child.on('exit', resolve);
            child.kill('SIGTERM');
        }) };
}

/** A host: sends messages and waits for some. */
class Client {
    constructor(port) {
        this.socket = connect(port, '127.0.0.1');
        this.messages = [];
        this.waiting = [];
        this.request = 0;
        this.closed = new Promise((resolve) => {
            this.socket.on('close', resolve);
        });
        this.socket.on('error', () => undefined);
        let rest = Buffer.alloc(0);
        this.socket.on('data', (chunk) => {
            rest = Buffer.concat([rest, chunk]);
            while (rest.length >= 4 && rest.length >= 4 + rest.readUInt32LE(0)) {
                const end = 4 + rest.readUInt32LE(0);
                this.#take({ kind: rest[4], payload: rest.subarray(5, end) });
                rest = rest.subarray(end);
            }
        });
    }

    #take(message) {
        this.messages.push(message);
        this.waiting = this.waiting.filter(({ test: fits, resolve }) => {
            if (fits(message)) {
                resolve(message);
                return false;
            }
            return true;
        });
    }

    /** The next message that fits, out of those that have not been there yet. */
    next(fits, what) {
        return within(new Promise((resolve) => {
            this.waiting.push({ test: fits, resolve });
        }), what);
    }

    kind(kind) {
        return this.next((message) => message.kind === kind, `message ${kind}`);
    }

    report(id, fits = () => true) {
        return this.next(({ kind, payload }) => kind === KIND.INPUT && payload[0] === id &&
            fits(wire.readInput(payload)), `report ${id}`)
            .then(({ payload }) => wire.readInput(payload));
    }

    send(kind, ...parts) {
        const payload = Buffer.concat(parts.map((part) => Buffer.from(part)));
        const head = Buffer.alloc(5);
        head.writeUInt32LE(1 + payload.length, 0);
        head.writeUInt8(kind, 4);
        this.socket.write(Buffer.concat([head, payload]));
    }

    /** OUTPUT, GET or SET. @returns {status, bytes} of its DONE. */
    async ask(kind, ...parts) {
        const id = Buffer.alloc(4), number = ++this.request;
        id.writeUInt32LE(number, 0);
        const answer = this.next((message) => message.kind === KIND.DONE &&
            message.payload.readUInt32LE(0) === number, `DONE ${number}`);
        this.send(kind, id, ...parts);
        const { payload } = await answer;
        return { status: payload[4], bytes: payload.subarray(5) };
    }

    get(id, length = 64) {
        return this.ask(KIND.GET, [id, length & 255, length >> 8]);
    }

    line(line, level, delayNs) {
        const delay = Buffer.alloc(8);
        delay.writeBigUInt64LE(BigInt(delayNs), 0);
        this.send(KIND.LINE, [line, level], delay);
    }
}

async function attachedClient(port) {
    const client = new Client(port);
    client.hello = await client.kind(KIND.ATTACHED);
    return client;
}

test('a host attaches, reads, arms, starts and sees the pulses that left', async () => {
    const { port, stop, stderr } = await server();
    const client = await attachedClient(port), { payload } = client.hello;
    assert.deepEqual([payload.readUInt16LE(0), payload.readUInt16LE(2)], [0x1209, 1]);
    const serial = payload.subarray(7, 7 + payload[6]).toString();
    assert.equal(serial, 'e6605838833a5f2c');
    assert.equal(payload.length, 8 + payload[6] + payload[7 + payload[6]]);
    const identity = await client.get(wire.ID.IDENTITY);
    assert.equal(identity.status, STATUS.DONE);
    assert.equal(Buffer.from(wire.readIdentity(identity.bytes).uniqueId).toString('hex'), serial);
    assert.equal((await client.get(wire.ID.STATUS)).status, STATUS.STALLED);
    assert.equal((await client.get(wire.ID.IDENTITY, 10)).bytes.length, 10);
    const settings = requests.settingsSet({ preambleMs: [], periodUs: 20000 });
    const stored = client.report(wire.ID.EVENT,
        (event) => event.kind === wire.EVENT.SETTINGS_STORED);
    assert.deepEqual(await client.ask(KIND.SET, settings),
        { status: STATUS.DONE, bytes: Buffer.alloc(0) });
    await stored;
    client.send(KIND.WATCH, [1]);
    const waiting = client.report(wire.ID.EVENT, (event) => event.kind === wire.EVENT.WAITING);
    const arm = requests.command(wire.OPCODE.ARM, 9);
    assert.equal((await client.ask(KIND.OUTPUT, arm)).status, STATUS.DONE);
    await waiting;
    const start = client.next(({ kind, payload: edge }) => kind === KIND.EDGE && edge[0] === 0 &&
        edge[1] === 1, 'the edge of START');
    const pulse = client.next(({ kind, payload: edge }) => kind === KIND.EDGE && edge[0] === 2 &&
        edge[1] === 1, 'the edge of TRIG');
    const trigger = client.report(wire.ID.TRIGGER);
    client.line(0, 1, 1000000);
    client.line(0, 0, 3000000);
    const time = ({ payload: edge }) => edge.readBigUInt64LE(2);
    assert.equal(time(await pulse) - time(await start), BigInt((125 + 4) * 8));
    assert.equal((await trigger).number, 1);
    client.socket.destroy();
    await stop();
    assert.equal(stderr(), '', 'the emulator found nothing wrong with the program');
});

test('unplugging tells DETACHED and ends what was open, plugging tells ATTACHED', async () => {
    const { port, stop } = await server();
    const client = await attachedClient(port);
    const before = wire.readIdentity((await client.get(wire.ID.IDENTITY)).bytes);
    const gone = client.kind(KIND.DETACHED);
    client.send(KIND.PLUG, [0]);
    const open = client.get(wire.ID.IDENTITY);
    await gone;
    assert.equal((await open).status, STATUS.GONE);
    assert.equal((await client.ask(KIND.OUTPUT, requests.command(1, 1))).status, STATUS.GONE);
    const back = client.kind(KIND.ATTACHED);
    client.send(KIND.PLUG, [1]);
    await back;
    const same = wire.readIdentity((await client.get(wire.ID.IDENTITY)).bytes);
    assert.equal(same.boot, before.boot, 'power stayed');
    const rebooted = client.kind(KIND.ATTACHED);
    client.send(KIND.POWER);
    await rebooted;
    const other = wire.readIdentity((await client.get(wire.ID.IDENTITY)).bytes);
    assert.notEqual(other.boot, before.boot, 'power did not');
    client.socket.destroy();
    await stop();
});

test('one host at a time: the next one waits for its turn', async () => {
    const { port, stop } = await server();
    const first = await attachedClient(port), second = new Client(port);
    await first.report(wire.ID.STATUS);
    assert.deepEqual(second.messages, []);
    const turn = second.kind(KIND.ATTACHED);
    first.socket.destroy();
    await turn;
    await second.report(wire.ID.STATUS);
    second.socket.destroy();
    await stop();
});

test('what is no message ends the connection with a word, and the box goes on', async () => {
    const { port, stop, stderr } = await server();
    const nonsense = [Buffer.from([1, 0, 0, 0, 99]), Buffer.from([2, 0, 0, 0, KIND.POWER, 0]),
        Buffer.from([255, 255, 255, 255, KIND.GET]), Buffer.from('GET / HTTP/1.1\r\n\r\n'),
        Buffer.from([11, 0, 0, 0, KIND.LINE, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0])];
    for (const bytes of nonsense) {
        const client = await attachedClient(port);
        client.socket.write(bytes);
        await within(client.closed, 'the connection to end');
    }
    assert.equal(stderr().match(/connection closed/g).length, nonsense.length);
    const client = await attachedClient(port);
    assert.equal((await client.get(wire.ID.IDENTITY)).status, STATUS.DONE);
    client.socket.destroy();
    await stop();
});

test('--flash keeps settings over the server\'s own end', async () => {
    const path = join(folder, 'flash.bin');
    const first = await server('--flash', path), client = await attachedClient(first.port);
    const stored = client.report(wire.ID.EVENT,
        (event) => event.kind === wire.EVENT.SETTINGS_STORED);
    await client.ask(KIND.SET, requests.settingsSet({ periodUs: 54321 }));
    await stored;
    client.socket.destroy();
    await first.stop();
    assert.equal(statSync(path).size, 2 * 1024 * 1024);
    const second = await server('--flash', path), again = await attachedClient(second.port);
    const { bytes } = await again.get(wire.ID.SETTINGS);
    assert.equal(wire.readSettings(bytes).settings.periodUs, 54321);
    again.socket.destroy();
    await second.stop();
});
