// SPDX-License-Identifier: Apache-2.0
/** What must not happen, happens: a wedged endpoint, a hung program, resets; and what a program
 * may forget that the emulator would hide. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, MS, SECOND, START_CYCLES, pins, shippedFirmware } from './box_bench.mjs';
import { loadFirmware, firmwareBeside } from './firmware_file.mjs';
import { CAUSE, EVENT, FLAG, ID, OPCODE, STATE } from './wire_reports.mjs';
import { command } from './wire_requests.mjs';

function running(settings = {}) {
    const bench = new Bench();
    bench.applySettings({ periodUs: 20000, ...settings });
    bench.armAndWait();
    bench.trig.length = 0;
    const preamble = bench.triggers().length;
    const edge = bench.start();
    bench.run(500);
    return { bench, edge, preamble };
}

function assertEvenPulses(rises, edge, periodMs) {
    assert.equal(rises[0] - edge, 125 + START_CYCLES);
    rises.slice(1).forEach((cycle, index) => assert.equal(cycle - rises[index], periodMs * MS));
}

test('UF2 and plain binary are the same program', (context) => {
    const { image, sha256, path } = shippedFirmware();
    context.diagnostic(`the program under test is ${path}, SHA-256 ${sha256}`);
    const other = loadFirmware(firmwareBeside(path));
    assert.ok(Math.abs(image.length - other.image.length) < 256, 'but for the last page');
    const shared = Math.min(image.length, other.image.length);
    assert.deepEqual(image.slice(0, shared), other.image.slice(0, shared));
    assert.match(sha256, /^[0-9a-f]{64}$/);
});

test('RESETS, PADS and the watchdog\'s tick are written before what needs them is used', () => {
    const bench = new Bench({ boots: false }), enabled = [];
    bench.board.powerOn();
    const { chip } = bench.board;
    chip.onPioEnabled = (block) => enabled.push({ block, pads: new Map(chip.nets.padWrites),
        inputs: [pins.START, pins.STROBE].map((pin) => chip.mcu.gpio[pin].inputEnable) });
    bench.until(() => bench.host.device, 3000, 'enumeration');
    bench.armAndWait();
    for (const name of ['IO_BANK0', 'PADS_BANK0', 'PIO0', 'PIO1', 'DMA', 'TIMER', 'USBCTRL',
        'PLL_SYS', 'PLL_USB', 'BUSCTRL', 'SYSINFO']) {
        assert.ok(chip.resets.released.has(name), `${name} is released`);
    }
    assert.equal(chip.watchdog.tickPeriod, 125, 'a tick is one microsecond');
    assert.equal(enabled.length, 2, 'both PIO blocks run');
    for (const { block, pads, inputs } of enabled) {
        for (const name of ['START', 'STROBE', 'TRIG', 'SYNC']) {
            assert.ok(pads.has(pins[name]), `pad of ${name} before ${block.name}`);
        }
        assert.deepEqual(inputs, [true, true], 'inputs are enabled');
    }
    assert.ok(chip.watchdog.enabled);
    assert.notEqual(chip.psm.selection, 0, 'a bite resets something');
    bench.assertClean(); // every use of a block in reset would be a fault
});

test('nothing comes out of TRIG and SYNC from power-on until the box is armed', () => {
    const bench = new Bench();
    bench.run(3000);
    assert.deepEqual(bench.trig, []);
    assert.deepEqual(bench.lines, []);
    bench.assertClean();
});

test('a box that nobody reads stays on the bus', () => {
    const bench = new Bench();
    bench.host.polls = false;
    bench.run(10000);
    assert.equal(bench.host.counts.attaches, 1);
    bench.host.polls = true;
    assert.equal(bench.status().reenumerations, 0);
    bench.assertClean();
});

test('a wedged endpoint heals, and no pulse is missed', () => {
    const { bench, edge, preamble } = running();
    let pings = 0;
    bench.board.chip.usb.wedge(bench.host.device.inEndpoints[0]);
    const before = bench.host.counts.attaches;
    for (let tenth = 0; tenth < 100 && bench.host.counts.attaches === before; tenth++) {
        bench.host.send(1, command(OPCODE.PING, 5000 + pings++)); // as a host does
        bench.run(100);
    }
    assert.equal(bench.host.counts.attaches, before + 1, 'it showed itself anew');
    bench.until(() => bench.host.device, 2000, 'the box to be back');
    bench.run(2000);
    const [healed] = bench.events(EVENT.ENDPOINT_HEALED);
    assert.equal(healed.argument, 1);
    assert.equal(bench.status().reenumerations, 1);
    bench.disarm();
    bench.run(1000);
    const rises = bench.rises();
    assertEvenPulses(rises, edge, 20);
    const told = new Map(bench.triggers().map(({ number, time }) => [number, time]));
    const offset = bench.timeOffset(told.get(preamble + 1), rises[0]);
    const missing = rises.map((_, index) => preamble + 1 + index).filter((n) => !told.has(n));
    assert.ok(missing.length <= 1, 'what lay in the wedged buffer at most');
    const entries = missing.length ? bench.readHistory(missing[0], missing[0]) : new Map();
    rises.forEach((cycle, index) => {
        const number = preamble + 1 + index;
        assert.equal((told.get(number) ?? entries.get(number).time) - cycle, offset);
    });
    assert.equal(bench.status().dropped, 0);
    bench.assertClean();
});

test('a hung program: TRIG goes on until the watchdog bites, then it is low, and the box says so',
    () => {
        for (const phaseMs of [0, 10.5]) { // the second bite comes within a pulse
            const { bench, edge } = running({ widthUs: 15000, preambleMs: [] });
            const boot = bench.status().boot, { board } = bench;
            board.chip.watchdog.write(4, 16000000, 16000000); // a feed, so that the bite is known
            board.chip.holdCpu(60 * SECOND);
            const hangs = bench.now;
            bench.run(phaseMs);
            bench.until(() => board.boots === 2, 9000, 'the watchdog to bite');
            const bitten = board.chip.startedAt;
            assert.ok(Math.abs(bitten - hangs - 8 * SECOND) <= 2 * MS, `${(bitten - hangs) / MS}`);
            const rises = bench.rises().filter((cycle) => cycle < bitten);
            assertEvenPulses(rises, edge, 20);
            assert.ok(rises[rises.length - 1] > bitten - 20 * MS, 'pulses until the bite');
            bench.until(() => bench.host.device, 3000, 'the box to be back');
            bench.run(1000);
            const status = bench.status();
            assert.equal(board.level(pins.TRIG), 0);
            assert.ok(bench.trig.every(({ cycle }) => cycle <= bitten), 'nothing after the bite');
            assert.deepEqual([status.resetCause, status.state], [CAUSE.WATCHDOG, STATE.IDLE]);
            assert.notEqual(status.boot, boot);
            assert.equal(status.reportNumber < 10, true, 'numbers begin anew');
            assert.equal(bench.readSettings().settings.widthUs, 15000);
            bench.armAndWait();
            bench.assertClean();
        }
    });

test('each way to start up has its own cause and boot id', () => {
    const bench = new Bench(), boots = [bench.readIdentity().boot];
    const again = (restart, cause) => {
        restart();
        assert.equal(bench.host.device, null, 'gone from the bus');
        bench.until(() => bench.host.device, 3000, 'the box to be back');
        const from = bench.reports.length;
        bench.run(1200);
        const status = bench.reports.slice(from).find(({ id }) => id === ID.STATUS);
        assert.equal(status.resetCause, cause);
        assert.equal(status.reportNumber <= 3, true);
        boots.push(status.boot);
    };
    again(() => {
        bench.board.powerOff();
        bench.run(100);
        bench.board.powerOn();
    }, CAUSE.POWER);
    again(() => {
        bench.board.pulseRunPin();
    }, CAUSE.PIN);
    again(() => {
        bench.board.chip.holdCpu(60 * SECOND);
        bench.until(() => bench.board.boots === 4, 9000, 'the bite');
    }, CAUSE.WATCHDOG);
    again(() => {
        bench.board.powerOff();
        bench.run(100);
        bench.board.powerOn();
    }, CAUSE.POWER);
    assert.equal(new Set(boots).size, boots.length);
    assert.ok(boots.every((boot) => boot !== 0));
    bench.assertClean();
});

test('a reset in the middle of a run ends it with TRIG low; another boot, another seed', () => {
    const { bench } = running();
    const before = bench.rises().length;
    bench.board.pulseRunPin();
    bench.run(2000);
    assert.equal(bench.rises().length, before);
    assert.equal(bench.board.level(pins.TRIG), 0);
    const ids = [1, 2, 3, 4].map((seed) => new Bench({ seed }).readIdentity().boot);
    assert.equal(new Set(ids).size, ids.length);
});

test('a lost report shows as gaps that tell the lost pulses\' times', () => {
    const { bench, preamble } = running();
    bench.run(1000);
    const triggers = bench.triggers().filter(({ number }) => number > preamble + 2);
    triggers.slice(2).forEach((trigger, index) => {
        const [before, one] = [triggers[index], triggers[index + 1]];
        const us = ({ time }) => Math.floor(time / 125);
        assert.deepEqual(trigger.gapsUs, [us(trigger) - us(one), us(one) - us(before)]);
        assert.equal(trigger.reportNumber > one.reportNumber, true);
        assert.equal(trigger.flags, FLAG.RUN);
    });
    bench.assertClean();
});
