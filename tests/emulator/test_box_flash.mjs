// SPDX-License-Identifier: Apache-2.0
/** Settings in flash, through power cuts at any byte of their write; unique id; BOOTSEL. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Bench, LONG, shippedFirmware } from './box_bench.mjs';
import { FlashChip, PowerCut, SECTOR } from './flash_chip.mjs';
import { randomGenerator } from './small_blocks.mjs';
import { CAUSE, EVENT, REFUSAL } from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

const OLD = { periodUs: 50000, debounceCycles: 1000, preambleMs: [100, 300] };
const NEW = { periodUs: 200000, debounceCycles: 7777, trigActiveLow: true, preambleMs: [70] };

function copyOf(flash) {
    const copy = new FlashChip({ uniqueId: flash.uniqueId });
    copy.bytes.set(flash.bytes);
    copy.status2 = flash.status2;
    return copy;
}

/** A box that was switched off with these settings in flash, stored so many times before. */
function flashWith(settings, times = 1) {
    const bench = new Bench();
    for (let count = 0; count < times; count++) {
        bench.applySettings({ ...settings, waitTimeoutS: times - 1 - count });
    }
    bench.board.powerOff();
    bench.assertClean();
    return bench.board.flash;
}

const periodOf = (flash) => {
    const bench = new Bench({ flash });
    const { settings, stored } = bench.readSettings();
    return { bench, stored, period: settings.periodUs, debounce: settings.debounceCycles };
};

/** SET, and the power fails after `bytes` of flash work. @returns false if it did not fail. */
function cutWhileSetting(flash, bytes, seed) {
    const bench = new Bench({ flash });
    flash.cutPowerAfter(bytes, seed);
    bench.setFeature(requests.settingsSet(NEW));
    bench.run(1000);
    const failed = !bench.board.isOn;
    assert.deepEqual(bench.board.allFaults(), []);
    return failed;
}

/** How many bytes of flash work a SET takes. */
function workOfSet(flash) {
    const copy = copyOf(flash), before = copy.work, bench = new Bench({ flash: copy });
    bench.applySettings(NEW);
    return copy.work - before;
}

/** Cuts to try: all of them, or each byte of a programmed page and a sample of an erase. */
function cutsOf(work, every = 1) {
    const all = Array.from({ length: work + 1 }, (_, index) => index);
    if (LONG) {
        return all;
    }
    const random = randomGenerator(99), pageFrom = work - (work % SECTOR || SECTOR);
    const isBorder = (at) => [0, SECTOR, work].some((border) => Math.abs(at - border) <= 2);
    const isSampled = (at) => (at >= pageFrom && work - pageFrom <= 512
        ? at % every === 0 : random() % 60 === 0);
    return all.filter((at) => isBorder(at) || isSampled(at));
}

test('settings outlive the power', () => {
    const flash = flashWith(OLD);
    const { bench, stored, period, debounce } = periodOf(flash);
    assert.deepEqual([stored, period, debounce], [true, OLD.periodUs, OLD.debounceCycles]);
    assert.equal(bench.status().resetCause, CAUSE.POWER);
    bench.assertClean();
});

for (const [name, times] of [['once', 1], ['twice', 2], ['many times', 7]]) {
    test(`a power cut at any byte leaves old settings or new ones (stored ${name} before)`, () => {
        const flash = flashWith(OLD, times), work = workOfSet(flash);
        const cuts = cutsOf(work, times === 1 ? 2 : 16);
        let failures = 0, renewed = 0;
        for (const bytes of cuts) {
            const copy = copyOf(flash);
            const failed = cutWhileSetting(copy, bytes, bytes % 2 ? bytes : null);
            assert.equal(failed, bytes < work, `cut after ${bytes} of ${work}`);
            const { bench, stored, period, debounce } = periodOf(copy);
            const isOld = period === OLD.periodUs && debounce === OLD.debounceCycles;
            const isNew = period === NEW.periodUs && debounce === NEW.debounceCycles;
            assert.ok(stored && (isOld || isNew), `cut after ${bytes}: ${period} ${debounce}`);
            failures += failed ? 1 : 0;
            renewed += isNew ? 1 : 0;
            bench.applySettings({ periodUs: 77000 }); // and the store still works
            bench.board.powerOff();
            assert.equal(periodOf(copy).period, 77000, `after the cut at ${bytes}`);
        }
        assert.ok(failures >= 5 && renewed >= 1, `${failures} cuts, ${renewed} new`);
    });
}

test('a power cut in the very first write leaves the defaults or the new settings', () => {
    const flash = new FlashChip();
    flash.load(shippedFirmware().image);
    const work = workOfSet(flash);
    for (const bytes of cutsOf(work, 16)) {
        const copy = copyOf(flash);
        cutWhileSetting(copy, bytes, bytes);
        const { stored, period } = periodOf(copy);
        assert.equal(period, stored ? NEW.periodUs : requests.DEFAULTS.periodUs, `at ${bytes}`);
        assert.ok(stored || bytes < work);
    }
});

test('settings that rotted in flash are not taken for settings', () => {
    const flash = flashWith(OLD, 3), random = randomGenerator(5);
    const image = shippedFirmware().image.length;
    for (let count = 0; count < (LONG ? 100 : 10); count++) {
        const copy = copyOf(flash);
        for (let at = image; at < copy.bytes.length; at++) { // some bits of each record drop
            if (copy.bytes[at] !== 0xff && random() % 8 === 0) {
                copy.bytes[at] &= ~(1 << (random() % 8));
            }
        }
        const { bench, stored, period } = periodOf(copy);
        assert.ok(period === OLD.periodUs || (!stored && period === requests.DEFAULTS.periodUs),
            `${stored} ${period}`);
        bench.applySettings(NEW);
        bench.assertClean();
    }
});

test('SET answers at once, tells SETTINGS_STORED later, and refuses another as busy', () => {
    const bench = new Bench(), from = bench.reports.length;
    const results = [];
    for (const settings of [NEW, OLD]) { // the second one comes before the first is written
        bench.host.submit({ type: 0x21, request: 9, value: 0x321, length: 64,
            data: requests.settingsSet(settings) }, (result) => results.push(result));
    }
    bench.run(1500);
    assert.deepEqual(results, ['OK', 'OK']);
    const refused = bench.events(EVENT.REFUSED), stored = bench.events(EVENT.SETTINGS_STORED);
    if (refused.length) { // else the first one was done with in time
        assert.equal(refused[0].detail, REFUSAL.BUSY);
    }
    assert.equal(stored.length + refused.length, 2);
    const { crc, stored: kept } = bench.readSettings();
    assert.ok(kept && stored[stored.length - 1].argument === crc);
    assert.equal(bench.status().settingsCrc, crc);
    assert.ok(bench.reports.length > from);
    bench.assertClean();
});

test('the same settings again are a success', () => {
    const bench = new Bench();
    bench.applySettings(OLD);
    bench.applySettings(OLD);
    assert.equal(bench.readSettings().settings.periodUs, OLD.periodUs);
    bench.assertClean();
});

test('the emulated flash only clears bits, and is cut off where it is told', () => {
    const flash = new FlashChip();
    flash.programRange(0, new Uint8Array(256).fill(0x0f));
    flash.programRange(0, new Uint8Array(256).fill(0xf1));
    assert.equal(flash.bytes[0], 0x01);
    flash.eraseRange(0, SECTOR);
    assert.equal(flash.bytes[0], 0xff);
    flash.cutPowerAfter(10);
    assert.throws(() => flash.programRange(0, new Uint8Array(256)), PowerCut);
    assert.deepEqual([flash.bytes[9], flash.bytes[10]], [0, 0xff]);
    assert.throws(() => flash.eraseRange(100, SECTOR));
});

test('another board has another serial number', () => {
    const flash = new FlashChip({ uniqueId: [1, 2, 3, 4, 5, 6, 7, 0xff] });
    flash.load(shippedFirmware().image);
    const bench = new Bench({ flash });
    assert.equal(bench.host.device.strings.serial, '01020304050607ff');
    assert.deepEqual([...bench.readIdentity().uniqueId], [1, 2, 3, 4, 5, 6, 7, 0xff]);
});

test('BOOTLOADER leaves for the ROM\'s bootloader, with TRIG low and settings kept', () => {
    const bench = new Bench();
    bench.applySettings(OLD);
    bench.setFeature(requests.bootloader());
    bench.until(() => bench.board.chip.bootloader !== null, 1000, 'the bootloader');
    bench.run(100);
    assert.equal(bench.host.device, null, 'off the bus as a box');
    assert.equal(bench.board.chip.bootloader.disabled, 0, 'drive and PICOBOOT both offered');
    assert.deepEqual(bench.trig, []);
    assert.deepEqual(bench.board.allFaults(), []);
    bench.board.flash.load(shippedFirmware().image); // what flashing does
    bench.board.powerOff();
    assert.equal(periodOf(bench.board.flash).period, OLD.periodUs);
});
