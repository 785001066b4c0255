/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The box behind the mocked devices: enough of one to see that every kind of transfer gets through
 * hidapi. What it says is written by libopms; tests/hid/fake_box.py is the independent one. */
#ifndef OPMS_TESTS_MOCK_BOX_H
#define OPMS_TESTS_MOCK_BOX_H

#include <stdbool.h>
#include <stdint.h>

#include <opms/wire.h>

#define MOCK_SERIAL "e66178c1a3551e2b"
#define MOCK_INPUTS_MAX 256

/** Not locked: its mock does that. */
typedef struct mock_box {
    opms_settings_report_t settings;
    opms_history_request_t selection;
    uint32_t session_id, report_number, event_number, boot_id;
    uint8_t inputs[MOCK_INPUTS_MAX][OPMS_WIRE_SIZE]; /* to be sent, a queue */
    uint32_t first_input, input_count;
} mock_box_t;

void mock_box_init(mock_box_t *box, uint32_t boot_id);

/** A feature report is asked for. @return Bytes written; 0: stall. */
uint32_t mock_box_get(mock_box_t *box, uint8_t id, uint8_t *bytes);
/** A feature report comes. @return Whether it reads. */
bool mock_box_set(mock_box_t *box, const uint8_t *bytes, uint32_t size);
/** An output report comes. ARM is answered by its event and 20 pulses, of which the reports of 5,
 * 6 and 13 get lost. @return Whether it reads. */
bool mock_box_output(mock_box_t *box, const uint8_t *bytes, uint32_t size);
/** The next input report. @return Whether there was one. */
bool mock_box_next_input(mock_box_t *box, uint8_t *bytes);

/** The box's HID report descriptor. @param[out] size its bytes. */
const uint8_t *mock_box_descriptor(uint32_t *size);

#endif
