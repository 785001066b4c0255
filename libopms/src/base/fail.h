/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Filling in opms_error_t, and passing failures up. */
#ifndef OPMS_BASE_FAIL_H
#define OPMS_BASE_FAIL_H

#include <opms/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Record a failure in err (may be NULL) and return its code. `format` is printf's. */
#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
opms_status_t opms_fail(opms_error_t *err, opms_status_t code, const char *stage, int32_t index,
                        const char *format, ...);

#define OPMS_TRY(expression)                            \
    do {                                                \
        const opms_status_t opms_try_status = (expression); \
        if (opms_try_status != OPMS_OK) {               \
            return opms_try_status;                     \
        }                                               \
    } while (0)

#ifdef __cplusplus
}
#endif
#endif
