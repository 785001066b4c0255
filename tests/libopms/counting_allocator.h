/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * An allocator that counts, and fails when told to. */
#ifndef COUNTING_ALLOCATOR_H
#define COUNTING_ALLOCATOR_H

#include <stdlib.h>

#include <unity.h>

typedef struct {
    int calls, live, fail_at;
} count_t;

static void *counting_alloc(void *user, size_t size)
{
    count_t *count = user;
    if (++count->calls == count->fail_at) {
        return NULL;
    }
    ++count->live;
    return malloc(size);
}

static void counting_free(void *user, void *memory)
{
    count_t *count = user;
    TEST_ASSERT_NOT_NULL(memory);
    --count->live;
    free(memory);
}

#endif
