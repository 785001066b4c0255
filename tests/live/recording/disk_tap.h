/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sits between a program that is linked with it and the system's calls on files: writes down what
 * happens below one folder, and makes the disk full or broken where a test asks for it.
 *
 * The calls that it stands for (open, write, fsync, ...) are its own symbols in the program, so
 * that shared libraries (SQLite) come by here, too. Shared memory that is mapped is not seen:
 * nothing of it has to outlive the program.
 *
 * With OPMS_DISK_ROOT and OPMS_DISK_LOG in the environment each call that succeeded becomes a
 * record of the log: seven little-endian numbers (u32 kind, lengths of name, second name and data;
 * i64 time, offset or size, reserved), then name, second name, data. disk_state.py reads it. */
#ifndef OPMS_TESTS_DISK_TAP_H
#define OPMS_TESTS_DISK_TAP_H

#ifdef __cplusplus
extern "C" {
#endif

/** Put a line into the log. */
void disk_tap_mark(const char *line);

/** From now on: writes below @p root fail with @p error once @p bytes more have been written. */
void disk_tap_limit(const char *root, long long bytes, int error);
/** No limit. */
void disk_tap_free(void);

#ifdef __cplusplus
}
#endif
#endif
