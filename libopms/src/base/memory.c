/* SPDX-License-Identifier: Apache-2.0 */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#include "base/fail.h"

opms_status_t opms_check_allocator(const opms_allocator_t *allocator, const char *stage,
                                   opms_error_t *err)
{
    if (!allocator->alloc != !allocator->free) {
        return opms_fail(err, OPMS_ERR_ARG, stage, -1, "allocator needs both alloc and free");
    }
    return OPMS_OK;
}

void *opms_take(const opms_allocator_t *allocator, size_t size)
{
    if (!allocator->alloc) {
        return calloc(1, size); /* does not touch pages that are zero anyway */
    }
    void *memory = allocator->alloc(allocator->user, size);
    if (memory) {
        memset(memory, 0, size);
    }
    return memory;
}

void opms_give_back(const opms_allocator_t *allocator, void *memory)
{
    if (!memory) {
        return;
    }
    const opms_allocator_t kept = *allocator;
    if (kept.free) {
        kept.free(kept.user, memory);
    } else {
        free(memory);
    }
}
