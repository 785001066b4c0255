// SPDX-License-Identifier: Apache-2.0
/** The tests' own reader and writer of reports against the golden vectors of tests/data/wire. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { repository } from './firmware_file.mjs';
import * as wire from './wire_reports.mjs';
import * as requests from './wire_requests.mjs';

const load = (name) =>
    JSON.parse(readFileSync(join(repository, 'tests', 'data', 'wire', `${name}.json`), 'utf8'));
const bytesOf = (hex) => Uint8Array.from(Buffer.from(hex, 'hex'));
const time = ({ us, cycles }) => BigInt(us) * 125n + BigInt(cycles);

const READERS = { trigger: wire.readTrigger, pong: wire.readPong, status: wire.readStatus,
    event: wire.readEvent, command: wire.readCommand, identity: wire.readIdentity,
    settings: wire.readSettings, settings_set: wire.readSettingsSet,
    history_request: wire.readHistoryRequest, history: wire.readHistory,
    bootloader: wire.readBootloader };

function settingsOf(f) {
    const end = f.preamble_gap_ms.indexOf(0);
    return { periodUs: f.period_us, widthUs: f.width_us, debounceCycles: f.debounce_cycles,
        trigActiveLow: f.trig_active_low, startFallingEdge: f.start_falling_edge,
        strobeEnabled: f.strobe_enabled, strobeActiveLow: f.strobe_active_low, sync: f.sync,
        waitTimeoutS: f.wait_timeout_s,
        preambleMs: f.preamble_gap_ms.slice(0, end < 0 ? 8 : end) };
}

const entryOf = (f) => ({ number: f.number, time: time(f.time), flags: f.flags,
    strobeDelay: f.strobe_delay_cycles, strobeLength: f.strobe_length_cycles });

/** The vectors' field names and the reader's, which were chosen apart from each other. */
const FIELDS = {
    trigger: (f) => ({ flags: f.flags, boot: f.boot_id, session: f.session_id,
        reportNumber: f.report_number, number: f.trigger_number, time: time(f.time),
        startEdge: time(f.start_edge), firstRunNumber: f.first_run_number,
        strobeFor: f.strobe_for_trigger, strobeDelay: f.strobe_delay_cycles,
        strobeLength: f.strobe_length_cycles, gapsUs: f.gap_us, dropped: f.dropped }),
    pong: (f) => ({ boot: f.boot_id, reportNumber: f.report_number, pingId: f.ping_id,
        received: time(f.received), sent: time(f.sent) }),
    status: (f) => ({ state: f.state, resetCause: f.reset_cause, boot: f.boot_id,
        session: f.session_id, reportNumber: f.report_number, uptimeUs: BigInt(f.uptime_us),
        number: f.trigger_number, firstRunNumber: f.first_run_number, glitches: f.glitches,
        startsRefused: f.starts_refused, strobesMissing: f.strobes_missing, dropped: f.dropped,
        commandsRefused: f.commands_refused, reenumerations: f.reenumerations,
        settingsCrc: f.settings_crc }),
    event: (f) => ({ kind: f.kind, state: f.state, boot: f.boot_id, session: f.session_id,
        reportNumber: f.report_number, eventNumber: f.event_number, time: time(f.time),
        argument: f.argument, detail: f.detail }),
    command: (f) => f,
    identity: (f) => ({ hardware: f.hardware_version, firmware: f.firmware_version,
        modified: f.firmware_modified, capabilities: f.capabilities, magic: 'OPMS',
        uniqueId: Uint8Array.from(f.unique_id), gitHash: f.git_hash, boot: f.boot_id,
        clockHz: f.clock_hz, startCycles: f.start_cycles, ringEntries: f.ring_entries,
        historyEntries: f.history_entries }),
    settings: (f) => ({ settings: settingsOf(f.settings), lastSet: f.last_set,
        pending: f.pending, stored: f.stored, crc: f.settings_crc }),
    settings_set: settingsOf,
    history_request: (f) => ({ token: f.token, session: f.session_id, first: f.first_number,
        count: f.count }),
    history: (f) => ({ token: f.token, boot: f.boot_id, session: f.session_id,
        remaining: f.remaining, count: f.count, first: f.count ? f.entries[0].number : 0,
        entries: f.entries.map(entryOf) }),
    bootloader: () => ({ magic: wire.BOOTLOADER_MAGIC }),
};

const WRITERS = {
    command: (f) => requests.command(f.opcode, f.argument),
    settings_set: (f) => requests.settingsSet(settingsOf(f)),
    history_request: (f) => requests.historyRequest({ token: f.token, session: f.session_id,
        first: f.first_number, count: f.count }),
    bootloader: () => requests.bootloader(),
};

/** Times and counters as BigInt wherever one of both is, so that they compare. */
function alike(actual, expected) {
    if (typeof actual === 'number' && typeof expected === 'bigint') {
        return BigInt(actual);
    }
    if (actual && typeof actual === 'object' && !(actual instanceof Uint8Array)) {
        const copy = Array.isArray(actual) ? [] : {};
        Object.keys(actual).forEach((key) => {
            copy[key] = alike(actual[key], expected?.[key]);
        });
        return copy;
    }
    return actual;
}

for (const name of Object.keys(READERS)) {
    test(`the golden vectors of ${name} read as their fields`, () => {
        const { vectors } = load(name);
        assert.ok(vectors.length > 0);
        for (const { name: title, fields, hex } of vectors) {
            const report = READERS[name](bytesOf(hex)), expected = FIELDS[name](fields);
            assert.deepEqual(alike(report, expected), expected, title);
        }
    });
}

for (const [name, write] of Object.entries(WRITERS)) {
    test(`what the tests send as ${name} is the golden bytes`, () => {
        for (const { name: title, fields, hex } of load(name).vectors) {
            assert.equal(Buffer.from(write(fields)).toString('hex'), hex, title);
        }
    });
}

test('every report that must be refused is refused', () => {
    const { vectors } = load('refused');
    assert.ok(vectors.length > 20);
    for (const { name, report, hex } of vectors) {
        assert.throws(() => READERS[report](bytesOf(hex)), wire.WireError, `${report}: ${name}`);
    }
});

test('every reserved byte that is not 0 is refused', () => {
    for (const name of Object.keys(READERS)) {
        const { reserved, vectors } = load(name);
        for (const at of reserved) {
            const bytes = bytesOf(vectors[0].hex);
            bytes[at] = 1;
            assert.throws(() => READERS[name](requests.seal(bytes)), wire.WireError,
                `${name} byte ${at}`);
        }
    }
});
