/* SPDX-License-Identifier: Apache-2.0 */
/* Projection is the model as written. Its inverse has no closed form: plain Newton settles in three
 * or four steps for ordinary lenses; where it does not, damped Newton from the optical axis
 * follows the straight line to the pixel in the picture, which keeps it on the branch that
 * belongs to the picture and stops it at the fold. */
#include <opms/lens.h>

#include <math.h>

#include "base/fail.h"
#include "lens/lens_fast.h"
#include "lens/lens_fold.h"

#define STAGE "lens"
#define SIDE_MAX_PX 16384
#define BORDER_STEPS 64 /* places on each border where opms_lens_check() looks */

/* d(u, v)/d(fx fy cx cy k1 k2 p1 p2), row-major 2 x 8. */
static void intrinsics_gradient(const opms_lens_t *lens, double x, double y, lens_bend_t bend,
                                double *jac)
{
    const double r2 = x * x + y * y;
    const double u[8] = {bend.xd,
                         0.0,
                         1.0,
                         0.0,
                         lens->fx_px * x * r2,
                         lens->fx_px * x * r2 * r2,
                         lens->fx_px * 2.0 * x * y,
                         lens->fx_px * (r2 + 2.0 * x * x)};
    const double v[8] = {0.0,
                         bend.yd,
                         0.0,
                         1.0,
                         lens->fy_px * y * r2,
                         lens->fy_px * y * r2 * r2,
                         lens->fy_px * (r2 + 2.0 * y * y),
                         lens->fy_px * 2.0 * x * y};
    for (int i = 0; i < 8; ++i) {
        jac[i] = u[i];
        jac[8 + i] = v[i];
    }
}

opms_status_t opms_lens_project(const opms_lens_t *lens, const double point_m[3], double px[2],
                                double *jac, double *jac_intrinsics, opms_error_t *err)
{
    if (!lens || !point_m || !px) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !lens      ? "lens"
                         : !point_m ? "point_m"
                                    : "px");
    }
    if (!(point_m[2] > 0.0)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "point_m is not in front of the camera: Z = %g", point_m[2]);
    }
    const double x = point_m[0] / point_m[2];
    const double y = point_m[1] / point_m[2];
    const lens_bend_t bend = lens_bend(lens, x, y);
    const double u = lens->fx_px * bend.xd + lens->cx_px;
    const double v = lens->fy_px * bend.yd + lens->cy_px;
    if (!isfinite(u) || !isfinite(v)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "point_m or lens is not finite, or the pixel is too far away to hold");
    }
    if (!lens_inside_fold(lens, x, y)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "the ray (%g, %g) lies beyond the fold of the distortion", x, y);
    }
    px[0] = u;
    px[1] = v;
    if (jac) {
        const double fx = lens->fx_px / point_m[2];
        const double fy = lens->fy_px / point_m[2];
        jac[0] = fx * bend.xx;
        jac[1] = fx * bend.xy;
        jac[2] = -(jac[0] * x + jac[1] * y);
        jac[3] = fy * bend.xy;
        jac[4] = fy * bend.yy;
        jac[5] = -(jac[3] * x + jac[4] * y);
    }
    if (jac_intrinsics) {
        intrinsics_gradient(lens, x, y, bend, jac_intrinsics);
    }
    return OPMS_OK;
}

/* Damped Newton from the axis to the distorted ray (xt, yt). A step must reduce the distance and
 * stay inside the fold; where only vanishing steps do, no ray reaches the target. */
static int unproject_guarded(const opms_lens_t *lens, double xt, double yt, double ray[2])
{
    const double good = 1e-12 * (0.01 + hypot(xt, yt));
    double x = 0.0, y = 0.0;
    double distance = hypot(xt, yt);
    for (int i = 0; i < 200 && distance > 0.0; ++i) {
        const lens_bend_t bend = lens_bend(lens, x, y);
        const double det = bend.xx * bend.yy - bend.xy * bend.xy;
        const double ex = xt - bend.xd;
        const double ey = yt - bend.yd;
        const double dx = (bend.yy * ex - bend.xy * ey) / det;
        const double dy = (bend.xx * ey - bend.xy * ex) / det;
        double part = 1.0;
        double nearer = distance;
        for (; part > 1e-9; part *= 0.5) {
            const double xn = x + part * dx;
            const double yn = y + part * dy;
            const lens_bend_t next = lens_bend(lens, xn, yn);
            nearer = hypot(xt - next.xd, yt - next.yd);
            if (nearer < distance * (1.0 - 0.1 * part) && lens_inside_fold(lens, xn, yn)) {
                x = xn;
                y = yn;
                break;
            }
        }
        if (part <= 1e-9) {
            break; /* stuck: at the fold, or at the last bit */
        }
        distance = nearer;
    }
    ray[0] = x;
    ray[1] = y;
    return distance <= good;
}

static int unproject(const opms_lens_t *lens, double u, double v, double ray[2])
{
    if (lens_unproject_fast(lens, u, v, &ray[0], &ray[1]) &&
        lens_inside_fold(lens, ray[0], ray[1])) {
        return 1;
    }
    return unproject_guarded(lens, (u - lens->cx_px) / lens->fx_px, (v - lens->cy_px) / lens->fy_px,
                             ray);
}

opms_status_t opms_lens_unproject(const opms_lens_t *lens, const double px[2], double ray[2],
                                  double *jac, opms_error_t *err)
{
    if (!lens || !px || !ray) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "%s is NULL",
                         !lens ? "lens"
                         : !px ? "px"
                               : "ray");
    }
    const double half_width = 0.5 * lens->width_px;
    const double half_height = 0.5 * lens->height_px;
    if (!(fabs(px[0] + 0.5 - half_width) <= 2.0 * half_width) ||
        !(fabs(px[1] + 0.5 - half_height) <= 2.0 * half_height)) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1,
                         "px (%g, %g) is not finite or more than half a picture outside", px[0],
                         px[1]);
    }
    double found[2];
    if (!unproject(lens, px[0], px[1], found)) {
        return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                         "no ray reaches the pixel (%g, %g): the distortion folds before it", px[0],
                         px[1]);
    }
    ray[0] = found[0];
    ray[1] = found[1];
    if (jac) {
        const lens_bend_t bend = lens_bend(lens, found[0], found[1]);
        const double det = bend.xx * bend.yy - bend.xy * bend.xy;
        jac[0] = bend.yy / (det * lens->fx_px);
        jac[1] = -bend.xy / (det * lens->fy_px);
        jac[2] = -bend.xy / (det * lens->fx_px);
        jac[3] = bend.xx / (det * lens->fy_px);
    }
    return OPMS_OK;
}

static opms_status_t check_numbers(const opms_lens_t *lens, opms_error_t *err)
{
    const struct {
        const char *name;
        double value;
    } numbers[8] = {{"fx_px", lens->fx_px}, {"fy_px", lens->fy_px}, {"cx_px", lens->cx_px},
                    {"cy_px", lens->cy_px}, {"k1", lens->k1},       {"k2", lens->k2},
                    {"p1", lens->p1},       {"p2", lens->p2}};
    for (int i = 0; i < 8; ++i) {
        if (!isfinite(numbers[i].value)) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, i, "lens->%s is not finite",
                             numbers[i].name);
        }
    }
    const int32_t sides[2] = {lens->width_px, lens->height_px};
    for (int i = 0; i < 2; ++i) {
        if (sides[i] < 1 || sides[i] > SIDE_MAX_PX) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "lens->%s is %ld, not 1 to %d",
                             i ? "height_px" : "width_px", (long)sides[i], SIDE_MAX_PX);
        }
    }
    const double longer = sides[0] > sides[1] ? sides[0] : sides[1];
    for (int i = 0; i < 2; ++i) {
        const double focal = numbers[i].value;
        const double centre = numbers[2 + i].value;
        if (!(focal >= 0.05 * longer && focal <= 100.0 * longer)) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, i,
                             "lens->%s is %g, not 0.05 to 100 times the longer side of %g px",
                             numbers[i].name, focal, longer);
        }
        if (!(centre >= -sides[i] && centre <= 2.0 * sides[i])) {
            return opms_fail(err, OPMS_ERR_ARG, STAGE, 2 + i,
                             "lens->%s is %g, more than one picture outside 0 to %ld",
                             numbers[2 + i].name, centre, (long)sides[i]);
        }
    }
    return OPMS_OK;
}

/* Every pixel lies on the way from the principal point to a border, so the borders decide. */
static opms_status_t check_borders(const opms_lens_t *lens, opms_error_t *err)
{
    const double corners[5][2] = {{-0.5, -0.5},
                                  {lens->width_px - 0.5, -0.5},
                                  {lens->width_px - 0.5, lens->height_px - 0.5},
                                  {-0.5, lens->height_px - 0.5},
                                  {-0.5, -0.5}};
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < BORDER_STEPS; ++i) {
            const double part = (double)i / BORDER_STEPS;
            const double u = corners[side][0] + part * (corners[side + 1][0] - corners[side][0]);
            const double v = corners[side][1] + part * (corners[side + 1][1] - corners[side][1]);
            double ray[2];
            if (!unproject(lens, u, v, ray)) {
                return opms_fail(err, OPMS_ERR_DOMAIN, STAGE, -1,
                                 "the distortion folds inside the picture, before (%.1f, %.1f)", u,
                                 v);
            }
        }
    }
    return OPMS_OK;
}

opms_status_t opms_lens_check(const opms_lens_t *lens, opms_error_t *err)
{
    if (!lens) {
        return opms_fail(err, OPMS_ERR_ARG, STAGE, -1, "lens is NULL");
    }
    OPMS_TRY(check_numbers(lens, err));
    return check_borders(lens, err);
}
