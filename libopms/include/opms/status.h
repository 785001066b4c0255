/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How every call of libopms reports failure.
 *
 * A fallible call returns an opms_status_t and takes a last `opms_error_t *err` (may be NULL)
 * that the caller owns. Absence is not an error: "no bar in this picture" is OPMS_OK with a state.
 * On failure the outputs of a call are untouched unless it says otherwise. */
#ifndef OPMS_STATUS_H
#define OPMS_STATUS_H

#include <stdint.h>

#include <opms/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/** 0 is success, failures are negative. Numbers are never reused or removed. */
typedef enum opms_status {
    OPMS_OK = 0,
    OPMS_ERR_ARG = -1,      /**< An argument is NULL, out of range or not finite. */
    OPMS_ERR_MEMORY = -2,   /**< An allocation failed (only `_create` allocates). */
    OPMS_ERR_CAPACITY = -3, /**< A caller's buffer is too small; the needed size is reported. */
    OPMS_ERR_DOMAIN = -4, /**< No solution exists, e.g. a pixel that no ray of the lens reaches. */
    OPMS_ERR_CONVERGE = -5, /**< An iteration did not converge. */
    OPMS_ERR_INTERNAL = -6, /**< A defect of the library; please report it. */
    OPMS_ERR_DEVICE = -8,   /**< No such device, several, gone, or no permission to open it. */
    OPMS_ERR_TIMEOUT = -9,  /**< The device did not answer before the deadline. */
    OPMS_ERR_VERSION = -10, /**< The device speaks another version of the protocol. */
    OPMS_ERR_REFUSED = -11  /**< The device refused; the message says why. */
} opms_status_t;

/** Details of a failure; plain, caller-owned, valid as long as the caller keeps it. */
typedef struct opms_error {
    opms_status_t code;
    int32_t index;     /**< Offending element of an array argument, or -1. */
    char stage[16];    /**< Part of the library that failed: "lens", "bar", "pose", ... */
    char message[224]; /**< What is wrong and with which argument, in English, NUL-terminated. */
} opms_error_t;

/** Name of a status, e.g. "OPMS_ERR_ARG"; "unknown status" for other numbers.
 *
 * @return A string with static storage. Any thread, any time.
 * @since 0.1 */
OPMS_API const char *opms_status_name(opms_status_t status);

#ifdef __cplusplus
}
#endif
#endif
