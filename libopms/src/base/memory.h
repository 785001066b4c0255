/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A handle's memory: from the caller's allocator, or from malloc where there is none. */
#ifndef OPMS_BASE_MEMORY_H
#define OPMS_BASE_MEMORY_H

#include <stddef.h>

#include <opms/status.h>
#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** OPMS_ERR_ARG where only one of the two functions is given. */
opms_status_t opms_check_allocator(const opms_allocator_t *allocator, const char *stage,
                                   opms_error_t *err);

/** `size` zeroed bytes, or NULL. */
void *opms_take(const opms_allocator_t *allocator, size_t size);

/** Give back what opms_take() gave; NULL is allowed. `allocator` may lie in `memory`. */
void opms_give_back(const opms_allocator_t *allocator, void *memory);

#ifdef __cplusplus
}
#endif
#endif
