/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>

#include "algebra/wide_lanes.h"
#include "bar/bar_code.h"

/* grey = black + contrast w(s - offset), to first order in the offset, with w the white coverage
 * and g = dw/ds: linear in black, contrast and contrast times offset. Next to the bar's border the
 * ground begins, of unknown brightness: one more step, k, with a height of its own. One more
 * regressor, h, the derivative of w by the blur, is not solved for here: what it would explain of
 * the residual is handed on, and summed over the picture by the caller. So is what an error of the
 * blur, and of the place of the code cells, makes of the offset. Pictures that moved or whose white
 * saturates are left to stretch_shaped.c. */

#define PIXELS_LEAST 10

const stretch_kernel_t *stretch_kernel(int wide)
{
    static const stretch_kernel_t plain = {stretch_sum_plain, stretch_shaped_plain};
    static const stretch_kernel_t avx2 = {stretch_sum_avx2, stretch_shaped_avx2};
    return wide && wide_has_avx2() ? &avx2 : &plain;
}

void stretch_cell_ends(const side_model_t *model, float low, float high, cell_ends_t *ends)
{
    const float reach = STRETCH_REACH / model->along_scale;
    unsigned before = 0;
    ends->base = 0.f;
    ends->count = 0;
    for (int i = 0; i <= BAR_CELLS; ++i) {
        const unsigned black = i < BAR_CELLS ? model->cells >> i & 1u : 0;
        const float at = (float)BAR_CELL_X_MM * (float)(i - 3), sign = (float)black - (float)before;
        if (black == before || at > high + reach) {
            continue;
        }
        if (at < low - reach) {
            ends->base += sign;
        } else {
            ends->at_mm[ends->count] = at;
            ends->sign[ends->count++] = sign;
        }
        before = black;
    }
}

/** Second moments about the means, of the regressors and of the grey level. */
typedef struct fit_moments {
    double n, ii, iw, ww, ig, gw, gg, ih, hw, hg, hh, ik, kw, kg, kh, kk, cw, cg;
} fit_moments_t;

/** Of a stretch, with what the whole picture says of black and white as if seen by so many pixels
 * of it. */
static void moments_of(const grey_levels_t *levels, const stretch_t *stretch,
                       const fit_sums_t *sums, fit_moments_t *m)
{
    const float *of = sums->of;
    const double black = (double)levels->weight[0], white = (double)levels->weight[1];
    const double b = (double)levels->grey[0], l = (double)levels->grey[1];
    m->n = (double)sums->n + black + white;
    const double part = 1 / m->n;
    const double i = (double)of[SUM_I] + black * b + white * l, w = (double)of[SUM_W] + white;
    const double g = (double)of[SUM_G], h = (double)of[SUM_H];
    const double i_mean = i * part, w_mean = w * part, g_mean = g * part, h_mean = h * part;
    m->ii = (double)of[SUM_II] + black * b * b + white * l * l - i * i_mean;
    m->iw = (double)of[SUM_WI] + white * l - w * i_mean;
    m->ww = (double)of[SUM_WW] + white - w * w_mean;
    m->ig = (double)of[SUM_GI] - g * i_mean;
    m->gw = (double)of[SUM_GW] - g * w_mean;
    m->gg = (double)of[SUM_GG] - g * g_mean;
    m->ih = (double)of[SUM_HI] - h * i_mean;
    m->hw = (double)of[SUM_HW] - h * w_mean;
    m->hg = (double)of[SUM_HG] - h * g_mean;
    m->hh = (double)of[SUM_HH] - h * h_mean;
    m->cw = m->cg = m->kw = m->kk = 0;
    if (stretch->cells) {
        m->cw = (double)of[SUM_CW] - (double)of[SUM_C] * w_mean;
        m->cg = (double)of[SUM_CG] - (double)of[SUM_C] * g_mean;
    }
    if (stretch->ground) {
        const double k = (double)of[SUM_K];
        m->ik = (double)of[SUM_KI] - k * i_mean;
        m->kw = (double)of[SUM_KW] - k * w_mean;
        m->kg = (double)of[SUM_KG] - k * g_mean;
        m->kh = (double)of[SUM_KH] - k * h_mean;
        m->kk = (double)of[SUM_KK] - k * k * part;
    }
}

/** Take the white coverage out of all else; returns 1 / what it has of its own. */
static double sweep_white(int ground, fit_moments_t *m)
{
    const double per_ww = 1 / m->ww;
    const double i = m->iw * per_ww, g = m->gw * per_ww, h = m->hw * per_ww;
    m->ii -= i * m->iw;
    m->ig -= i * m->gw;
    m->ih -= i * m->hw;
    m->cg -= m->cw * g;
    m->gg -= g * m->gw;
    m->hg -= g * m->hw;
    m->hh -= h * m->hw;
    if (ground) {
        const double k = m->kw * per_ww;
        m->ik -= i * m->kw;
        m->kg -= g * m->kw;
        m->kh -= h * m->kw;
        m->kk -= k * m->kw;
    }
    return per_ww;
}

/** Take the ground out of what follows it. */
static double sweep_ground(fit_moments_t *m)
{
    const double per_kk = 1 / m->kk;
    const double i = m->ik * per_kk, g = m->kg * per_kk, h = m->kh * per_kk;
    m->ii -= i * m->ik;
    m->ig -= i * m->kg;
    m->ih -= i * m->kh;
    m->gg -= g * m->kg;
    m->hg -= g * m->kh;
    m->hh -= h * m->kh;
    return per_kk;
}

/** Variance of the grey level where the coverage is `white`, from the moments as they were swept,
 * for noise 1. */
static float level_variance(const fit_moments_t *m, const fit_sums_t *sums, double white,
                            double per_ww, double per_kk, double per_gg)
{
    const double part = 1 / m->n;
    const double from = (double)sums->of[SUM_W] * part - white;
    const double ground =
        per_kk > 0 ? (double)sums->of[SUM_K] * part - from * m->kw * per_ww : 0;
    const double along = (double)sums->of[SUM_G] * part - from * m->gw * per_ww -
                         (per_kk > 0 ? ground * m->kg * per_kk : 0);
    return (float)(part + from * from * per_ww + ground * ground * per_kk +
                   along * along * per_gg);
}

int stretch_solve(const grey_levels_t *levels, const fit_sums_t *sums, stretch_t *out)
{
    if (out->shaped) {
        return 1; /* solved at once, and no level of white is to be had */
    }
    const double pixels = (double)sums->n;
    if (pixels < PIXELS_LEAST) {
        return 0;
    }
    fit_moments_t m;
    moments_of(levels, out, sums, &m);
    const double whole_kk = m.kk, whole_gg = m.gg;
    if (!(m.ww > 0)) {
        return 0;
    }
    int ground = out->ground;
    const double per_ww = sweep_white(ground, &m);
    ground = ground && m.kk > 1e-4 * whole_kk; /* where the window reaches it */
    const double per_kk = ground ? sweep_ground(&m) : 0;
    if (!(m.gg > 1e-3 * whole_gg)) {
        return 0;
    }
    const double per_gg = 1 / m.gg;
    const double slope = m.ig * per_gg;
    const double height = ground ? (m.ik - m.kg * slope) * per_kk : 0;
    const double contrast = (m.iw - m.gw * slope - m.kw * height) * per_ww;
    if (!(contrast > 0)) {
        return 0;
    }
    const float *of = sums->of;
    const double black = (double)levels->weight[0], white = (double)levels->weight[1];
    const double grey = (double)of[SUM_I] + black * (double)levels->grey[0] +
                        white * (double)levels->grey[1];
    const double lit = contrast * ((double)of[SUM_W] + white) + slope * (double)of[SUM_G] +
                       (ground ? height * (double)of[SUM_K] : 0);
    const double per_contrast = 1 / contrast;
    out->pixels = (uint16_t)pixels;
    out->black = (float)((grey - lit) / m.n);
    out->contrast = (float)contrast;
    out->offset_px = out->expected_px + (float)(-slope * per_contrast);
    out->sigma_unit = (float)(sqrt(per_gg) * per_contrast);
    /* A level that is known beforehand costs no freedom. */
    const double third = pixels / 3.0;
    const double solved =
        1 + (ground ? 1 : 0) +
        (black + white > 0 ? third / (third + black) + third / (third + white) : 2);
    const double rss = m.ii - m.ig * slope;
    out->variance = (float)((rss > 0 ? rss : 0) / (pixels - solved));
    if (!(black + white > 0)) {
        for (int level = 0; level < 2; ++level) {
            out->level_variance[level] = level_variance(&m, sums, level, per_ww, per_kk, per_gg);
        }
    }
    /* What of the residual the blur would explain, once the rest is taken out of it. */
    const double hh = m.hh - m.hg * m.hg * per_gg;
    out->blur_weight = (float)(contrast * contrast * (hh > 0 ? hh : 0));
    out->blur_slope = (float)(contrast * (m.ih - slope * m.hg));
    out->by_blur = (float)(-m.hg * per_gg);
    out->by_cells = (float)(m.cg * per_gg);
    return 1;
}
