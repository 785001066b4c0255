// SPDX-License-Identifier: Apache-2.0
/** 10,000 periods to the cycle, at 10 Hz and at 100 Hz, whatever USB, host and CPU do meanwhile.
 * OPMS_EMULATOR_RATE_HZ picks one of the rates. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { LONG, MS, SECOND } from './box_bench.mjs';
import { lateReports, runCadence } from './box_cadence.mjs';
import { getDescriptor } from './usb_enumerate.mjs';
import { FLAG, ID } from './wire_reports.mjs';

const PERIODS = 10000;
const rates = process.env.OPMS_EMULATOR_RATE_HZ ? [Number(process.env.OPMS_EMULATOR_RATE_HZ)]
    : [10, 100];

/** Requests one after the other, as fast as the bus allows. */
function hammerOf() {
    const requests = [ID.IDENTITY, ID.SETTINGS, ID.HISTORY].map((id) =>
        ({ type: 0xa1, request: 1, value: (3 << 8) | id, length: 64 }));
    requests.push(getDescriptor(1, 0, 18), getDescriptor(2, 0, 255), getDescriptor(3, 3, 255),
        { type: 0x80, request: 0x55, length: 2 }); // the last one is stalled
    let next = 0;
    return () => requests[next++ % requests.length];
}

for (const rate of rates) {
    const periodUs = 1e6 / rate, plan = { periodUs, periods: PERIODS };
    const cycles = periodUs * 125;

    test(`${PERIODS} periods of exactly ${cycles} cycles at ${rate} Hz, each told in time`, () => {
        const { bench, missing, preamble, triggers } = runCadence({ ...plan,
            disturb: function* calm() {} });
        assert.equal(missing, 0, 'every pulse in a report');
        assert.deepEqual(lateReports(bench, preamble, bench.rises()), []);
        assert.ok(triggers.every(({ flags }) => !(flags & FLAG.DELAYED)));
        const last = preamble + bench.rises().length, oldest = last - 8191;
        const history = bench.readHistory(oldest - 2, oldest + 1);
        const held = [...history.values()].map(({ flags }) => !(flags & FLAG.NOT_HELD));
        assert.deepEqual(held, [false, false, true, true], 'the last 8192 are held');
    });

    test(`the same at ${rate} Hz while the host hammers control requests`, () => {
        const before = { controls: 0 };
        const { bench, missing } = runCadence({ ...plan, disturb: function* hammer({ host }) {
            before.controls = host.counts.controls;
            for (;;) { // all the time, or in bursts, because each request costs the emulator dear
                host.hammer = hammerOf();
                yield { run: LONG ? 10000 : 1000 };
                host.hammer = null;
                yield { run: LONG ? 1 : 900000 / rate };
            }
        } });
        assert.equal(missing, 0);
        assert.ok(bench.host.counts.controls - before.controls > 30000);
    });

    test(`the same at ${rate} Hz while the CPU is held for 6 s, again and again`, () => {
        const { missing, filled, status, bench } = runCadence({ ...plan,
            disturb: function* hold({ board }) {
                for (;;) {
                    yield { run: 3000 };
                    board.chip.holdCpu(6 * SECOND);
                    yield { run: 6000 + 3000 };
                    yield { run: rate >= 100 ? 100 : 100000 };
                }
            } });
        assert.equal(filled, missing, 'what no report told HISTORY holds');
        assert.equal(status.resetCause, 1);
        assert.equal(bench.board.boots, 1, 'the watchdog did not bite');
    });

    test(`the same at ${rate} Hz while the host stops reading for 6 s and comes back`, () => {
        const { missing, filled, triggers } = runCadence({ ...plan,
            disturb: function* silence({ host }) {
                for (;;) {
                    yield { run: 3000 };
                    host.polls = false;
                    yield { run: 6000 };
                    host.polls = true;
                    yield { run: rate >= 100 ? 9000 : 100000 };
                }
            } });
        assert.equal(filled, missing, 'what no report told HISTORY holds');
        assert.ok(triggers.some(({ flags }) => flags & FLAG.DELAYED), 'late ones say so');
    });

    test(`the same at ${rate} Hz while the cable is out for 6 s and the bus is suspended`, () => {
        const { missing, filled, bench } = runCadence({ ...plan, periods: 20 * rate,
            disturb: function* unplug({ host }) {
                yield { run: 2000 };
                host.plug(false);
                yield { run: 6000 };
                host.plug(true);
                yield { run: 2000 };
                host.suspend();
                yield { run: 4000 };
                host.resume();
            } });
        assert.equal(filled, missing);
        assert.ok(bench.host.counts.attaches >= 2);
        assert.ok(bench.now > 10 * SECOND + MS);
    });
}
