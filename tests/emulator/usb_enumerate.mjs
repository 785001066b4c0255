// SPDX-License-Identifier: Apache-2.0
/** Enumeration by the book (USB 2.0, chapter 9), in the order in which common hosts do it. */
const MS = 125000;
const GET = 0x80, STANDARD_INTERFACE = 0x81, CLASS_INTERFACE = 0x21;
const GET_DESCRIPTOR = 6, SET_ADDRESS = 5, SET_CONFIGURATION = 9, SET_IDLE = 0x0a;
const DEVICE = 1, CONFIGURATION = 2, STRING = 3, HID = 0x21, REPORT = 0x22;

export const getDescriptor = (kind, index, length, language = 0) => ({
    type: GET, request: GET_DESCRIPTOR, value: (kind << 8) | index, index: language, length });

export class EnumerationError extends Error {}

function expectBytes(result, least, what) {
    if (typeof result === 'string' || result.length < least) {
        throw new EnumerationError(`${what}: ${typeof result === 'string' ? result
            : `${result.length} bytes`}`);
    }
    return result;
}

/** Split a configuration into its descriptors. */
export function splitDescriptors(bytes) {
    const parts = [];
    for (let at = 0; at < bytes.length; at += bytes[at]) {
        if (bytes[at] < 2 || at + bytes[at] > bytes.length) {
            throw new EnumerationError(`descriptor of ${bytes[at]} bytes at ${at}`);
        }
        parts.push(bytes.subarray(at, at + bytes[at]));
    }
    return parts;
}

export const decodeString = (bytes) =>
    Buffer.from(bytes.subarray(2, bytes[0])).toString('utf16le');

function* readStrings(descriptor) {
    const languages = yield { control: getDescriptor(STRING, 0, 255) };
    if (typeof languages === 'string') {
        return {}; // a device may have none
    }
    const language = languages[2] | (languages[3] << 8);
    const strings = {};
    for (const [name, at] of [['manufacturer', 14], ['product', 15], ['serial', 16]]) {
        if (descriptor[at]) {
            const request = getDescriptor(STRING, descriptor[at], 255, language);
            strings[name] = decodeString(expectBytes(yield { control: request }, 2, name));
        }
    }
    return strings;
}

/** A script for UsbHost.run(); what it found out goes with {ready}. */
export function* enumerate(address = 7) {
    yield { wait: 100 * MS }; // debounce of the connection
    yield { reset: true };
    expectBytes(yield { control: getDescriptor(DEVICE, 0, 64) }, 8, 'device descriptor');
    yield { reset: true };
    const addressed = yield { control: { type: 0, request: SET_ADDRESS, value: address } };
    if (addressed !== 'OK') {
        throw new EnumerationError(`SET_ADDRESS: ${addressed}`);
    }
    yield { address };
    yield { wait: 2 * MS }; // the time a device may take for it
    const device = expectBytes(yield { control: getDescriptor(DEVICE, 0, 18) }, 18, 'device');
    const head = expectBytes(yield { control: getDescriptor(CONFIGURATION, 0, 9) }, 9, 'head');
    const total = head[2] | (head[3] << 8);
    const configuration = expectBytes(
        yield { control: getDescriptor(CONFIGURATION, 0, total) }, total, 'configuration');
    const strings = yield* readStrings(device);
    const set = yield { control: { type: 0, request: SET_CONFIGURATION, value: head[5] } };
    if (set !== 'OK') {
        throw new EnumerationError(`SET_CONFIGURATION: ${set}`);
    }
    const parts = splitDescriptors(configuration);
    yield { control: { type: CLASS_INTERFACE, request: SET_IDLE } }; // it may stall that
    const hid = parts.find((part) => part[1] === HID);
    let report = new Uint8Array(0);
    if (hid) {
        const length = hid[7] | (hid[8] << 8);
        report = expectBytes(yield { control: { type: STANDARD_INTERFACE, length,
            request: GET_DESCRIPTOR, value: REPORT << 8 } }, length, 'report descriptor');
    }
    const endpoints = parts.filter((part) => part[1] === 5);
    const numbers = (isIn) => endpoints.filter((part) => (part[2] >= 0x80) === isIn)
        .map((part) => part[2] & 0xf);
    yield { ready: { device, configuration, parts, strings, report, endpoints,
        inEndpoints: numbers(true), outEndpoints: numbers(false) } };
}
