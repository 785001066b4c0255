/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Four doubles at a time: one register where there is AVX2, two of any other vector unit, with the
 * same result to the last bit; and what compiles functions for either. */
#ifndef OPMS_ALGEBRA_WIDE_DOUBLES_H
#define OPMS_ALGEBRA_WIDE_DOUBLES_H

#include <stdint.h>
#include <string.h>

/** What lanes are handed to has to be inlined, whatever the level of optimisation. */
#define WIDE_ALWAYS __attribute__((always_inline))
#define WIDE_INLINE static inline WIDE_ALWAYS

#if defined(__x86_64__) && defined(__GNUC__)
/** Compiles a function for the wider registers; it may be called where wide_has_avx2() says so. */
#define WIDE_AVX2 __attribute__((target("avx2")))
static inline int wide_has_avx2(void)
{
    return __builtin_cpu_supports("avx2") != 0;
}
#else
#define WIDE_AVX2
static inline int wide_has_avx2(void)
{
    return 0;
}
#endif

/** Defines `name`, of the same parameters as the inlined `name##_lanes`, which gives no result:
 * that function as compiled for the wider registers where there are such, for all others elsewhere.
 */
#define WIDE_EITHER(name, parameters, arguments)                                                   \
    WIDE_AVX2 static void name##_avx2 parameters                                                   \
    {                                                                                              \
        name##_lanes arguments;                                                                    \
    }                                                                                              \
    static void name parameters                                                                    \
    {                                                                                              \
        if (wide_has_avx2()) {                                                                     \
            name##_avx2 arguments;                                                                 \
        } else {                                                                                   \
            name##_lanes arguments;                                                                \
        }                                                                                          \
    }

#define WIDE_DOUBLES 4
typedef double wide_double_t __attribute__((vector_size(WIDE_DOUBLES * sizeof(double))));
typedef int64_t wide_long_t __attribute__((vector_size(WIDE_DOUBLES * sizeof(double))));

WIDE_INLINE wide_double_t wide_double_load(const double *from)
{
    wide_double_t v;
    memcpy(&v, from, sizeof v);
    return v;
}

WIDE_INLINE void wide_double_store(double *to, wide_double_t v)
{
    memcpy(to, &v, sizeof v);
}

/** v where it is positive, 0 elsewhere. */
WIDE_INLINE wide_double_t wide_double_positive(wide_double_t v)
{
    return 0.5 * (v + (wide_double_t)((wide_long_t)v & INT64_MAX)); /* the sign taken off */
}

/** v where `set`, 0 elsewhere. */
WIDE_INLINE wide_double_t wide_double_where(wide_long_t set, wide_double_t v)
{
    return (wide_double_t)(set & (wide_long_t)v);
}

WIDE_INLINE double wide_double_sum(wide_double_t v)
{
    return (v[0] + v[2]) + (v[1] + v[3]);
}

#endif
