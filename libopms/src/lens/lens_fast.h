/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera model without argument checks, for inner loops.
 *
 * The lens must have passed opms_lens_check() and the rays must lie inside its fold (every ray of
 * a pixel in the picture does). Elsewhere the public opms_lens_project() is the one to call.
 *
 * The distortion is the gradient of a potential,
 *   r^2/2 + k1 r^4/4 + k2 r^6/6 + (p2 x + p1 y) r^2,
 * so its Jacobian is symmetric; `lens_bend_t` keeps the three different entries. */
#ifndef OPMS_LENS_LENS_FAST_H
#define OPMS_LENS_LENS_FAST_H

#include <math.h>

#include <opms/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A distorted ray and the derivative of the distortion, in normalised coordinates. */
typedef struct lens_bent_ray {
    double xd, yd;
    double xx, xy, yy; /**< d(xd)/dx, d(xd)/dy = d(yd)/dx, d(yd)/dy */
} lens_bend_t;

/** Defines `name`, which distorts the ray (x, y): written once for one ray and for several. */
#define LENS_BEND(name, bend_type, real)                                                           \
    static inline bend_type name(const opms_lens_t *lens, real x, real y)                          \
    {                                                                                              \
        const real r2 = x * x + y * y;                                                             \
        const real gain = 1.0 + r2 * (lens->k1 + r2 * lens->k2);                                   \
        const real slope2 = 2.0 * lens->k1 + 4.0 * lens->k2 * r2;                                  \
        const real tilt = 2.0 * (lens->p1 * y + lens->p2 * x);                                     \
        bend_type bend;                                                                            \
        bend.xd = x * (gain + tilt) + lens->p2 * r2;                                               \
        bend.yd = y * (gain + tilt) + lens->p1 * r2;                                               \
        bend.xx = gain + slope2 * x * x + tilt + 4.0 * lens->p2 * x;                               \
        bend.xy = slope2 * x * y + 2.0 * (lens->p1 * x + lens->p2 * y);                            \
        bend.yy = gain + slope2 * y * y + tilt + 4.0 * lens->p1 * y;                               \
        return bend;                                                                               \
    }

LENS_BEND(lens_bend, lens_bend_t, double)

/** Pixel of the ray (x, y). Always returns 1, so that it can stand where a checked call does. */
static inline int lens_project_ray(const opms_lens_t *lens, double x, double y, double *u,
                                   double *v)
{
    const double r2 = x * x + y * y;
    const double gain = 1.0 + r2 * (lens->k1 + r2 * lens->k2) + 2.0 * (lens->p1 * y + lens->p2 * x);
    *u = lens->fx_px * (x * gain + lens->p2 * r2) + lens->cx_px;
    *v = lens->fy_px * (y * gain + lens->p1 * r2) + lens->cy_px;
    return 1;
}

/** Pixel of the ray (x, y) and the row-major 2 x 2 derivative d(u, v)/d(x, y). Returns 1. */
static inline int lens_project_ray_jac(const opms_lens_t *lens, double x, double y, double *u,
                                       double *v, double jac[4])
{
    const lens_bend_t bend = lens_bend(lens, x, y);
    *u = lens->fx_px * bend.xd + lens->cx_px;
    *v = lens->fy_px * bend.yd + lens->cy_px;
    jac[0] = lens->fx_px * bend.xx;
    jac[1] = lens->fx_px * bend.xy;
    jac[2] = lens->fy_px * bend.xy;
    jac[3] = lens->fy_px * bend.yy;
    return 1;
}

/** Ray of the pixel (u, v) by plain Newton from the ray of a distortion-free lens.
 *
 * @return 1, or 0 where it does not settle; (x, y) are then unusable. */
static inline int lens_unproject_fast(const opms_lens_t *lens, double u, double v, double *x,
                                      double *y)
{
    const double xt = (u - lens->cx_px) / lens->fx_px;
    const double yt = (v - lens->cy_px) / lens->fy_px;
    const double settled = 1e-30 * (1e-2 + xt * xt + yt * yt);
    double xn = xt, yn = yt;
    for (int i = 0; i < 12; ++i) {
        const lens_bend_t bend = lens_bend(lens, xn, yn);
        const double det = bend.xx * bend.yy - bend.xy * bend.xy;
        if (!(det > 1e-6)) {
            return 0;
        }
        const double ex = xt - bend.xd;
        const double ey = yt - bend.yd;
        const double dx = (bend.yy * ex - bend.xy * ey) / det;
        const double dy = (bend.xx * ey - bend.xy * ex) / det;
        xn += dx;
        yn += dy;
        /* Newton squares the error: after a step this small the next one would be rounding. */
        const double step2 = dx * dx + dy * dy;
        if (step2 * step2 < settled) {
            *x = xn;
            *y = yn;
            return 1;
        }
    }
    return 0;
}

#ifdef __cplusplus
}
#endif
#endif
