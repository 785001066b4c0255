/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera model of lens_fast.h for four rays at a time. */
#ifndef OPMS_LENS_LENS_WIDE_H
#define OPMS_LENS_LENS_WIDE_H

#include "algebra/wide_doubles.h"
#include "lens/lens_fast.h"

/** lens_bend_t of four rays. */
typedef struct lens_wide_bend {
    wide_double_t xd, yd;
    wide_double_t xx, xy, yy;
} lens_wide_bend_t;

WIDE_ALWAYS LENS_BEND(lens_bend_wide, lens_wide_bend_t, wide_double_t)

/** Pixels of the rays (x, y), and the gradient there, d(n.(u, v))/d(x, y), of n = (nu, nv). */
typedef struct lens_wide_line {
    wide_double_t u, v;
    wide_double_t mx, my;
} lens_wide_line_t;

WIDE_INLINE lens_wide_line_t lens_line_wide(const opms_lens_t *lens, wide_double_t x,
                                            wide_double_t y, wide_double_t nu, wide_double_t nv)
{
    const lens_wide_bend_t bend = lens_bend_wide(lens, x, y);
    const wide_double_t fu = lens->fx_px * nu, fv = lens->fy_px * nv;
    lens_wide_line_t line;
    line.u = lens->fx_px * bend.xd + lens->cx_px;
    line.v = lens->fy_px * bend.yd + lens->cy_px;
    line.mx = bend.xx * fu + bend.xy * fv;
    line.my = bend.xy * fu + bend.yy * fv;
    return line;
}

#endif
