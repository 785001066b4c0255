/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Four doubles at a time: one register where there is AVX2, two of any other vector unit, with the
 * same result to the last bit. For functions as algebra/wide_lanes.h describes them. */
#ifndef OPMS_ALGEBRA_QUAD_LANES_H
#define OPMS_ALGEBRA_QUAD_LANES_H

#include "algebra/wide_lanes.h"

#define QUAD 4

typedef double quad_t __attribute__((vector_size(QUAD * sizeof(double))));
typedef int64_t quad_int_t __attribute__((vector_size(QUAD * sizeof(double))));

WIDE_INLINE void quad_load(const double *from, quad_t *to)
{
    memcpy(to, from, sizeof *to);
}

WIDE_INLINE void quad_store(double *to, const quad_t *from)
{
    memcpy(to, from, sizeof *from);
}

WIDE_INLINE double quad_sum(const quad_t *v)
{
    return ((*v)[0] + (*v)[1]) + ((*v)[2] + (*v)[3]);
}

/** 0 where the mask is not set. */
WIDE_INLINE void quad_keep_where(const quad_int_t *mask, quad_t *v)
{
    *v = (quad_t)(*mask & (quad_int_t)*v);
}

#endif
