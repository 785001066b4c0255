/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What all reports have in common: id, protocol version, CRC, and zeros where nothing is.
 *
 * A writer calls wire_begin(), puts its fields and ends with wire_seal(). A reader calls
 * wire_open(), gets its fields, checks their ranges, and asks wire_same() whether writing them
 * gives the same bytes: that finds each reserved byte and bit that is not 0 without a list of
 * them. */
#ifndef OPMS_WIRE_FRAME_H
#define OPMS_WIRE_FRAME_H

#include <opms/wire.h>

/** All 0 but id and version. */
void wire_begin(uint8_t *bytes, opms_report_id_t id);

/** Put the CRC. */
void wire_seal(uint8_t *bytes);

/** Are these `size` bytes a whole report of this id and version? */
opms_wire_result_t wire_open(const uint8_t *bytes, size_t size, opms_report_id_t id);

/** Are both reports the same? */
bool wire_same(const uint8_t *a, const uint8_t *b);

#endif
