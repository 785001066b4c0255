/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/stretch_fit.h"

#include <math.h>
#include <string.h>

/* grey = black + contrast w(s - offset), to first order in the offset, with w the white coverage and
 * g = dw/ds: linear in black, contrast and contrast times offset. Where white saturates, the coverage
 * is cut at the part `clip` of the true contrast, and w is what is left, scaled to 1. Two more
 * regressors, the derivatives of w by the blur and by the clip, are not solved for here: what they
 * would explain of the residual is handed on, and summed over the picture by the caller. */

#define PIXELS_LEAST 10
#define SATURATED_PART 0.12f /* of a stretch's pixels, from which on its white counts as saturated */

enum { W, G, H, J, REGRESSORS };

typedef struct fit_sums {
    float n, i, ii;
    float x[REGRESSORS];                  /* sums of the regressors */
    float xi[REGRESSORS];                 /* and of their products with the grey level */
    float xx[REGRESSORS][REGRESSORS];     /* and with one another, lower triangle */
} fit_sums_t;

static inline void add_pixel(fit_sums_t *sums, float i, const float x[REGRESSORS], int regressors)
{
    sums->n += 1.f;
    sums->i += i;
    sums->ii += i * i;
    for (int a = 0; a < regressors; ++a) {
        sums->x[a] += x[a];
        sums->xi[a] += x[a] * i;
        for (int b = 0; b <= a; ++b) {
            sums->xx[a][b] += x[a] * x[b];
        }
    }
}

static inline float coverage(const fit_line_t *line, const edge_blur_t *blur, float s, float *slope)
{
    const edge_profile_t edge = edge_profile_blurred(blur, s);
    float w = 1.f - (1.f - edge.step) * line->corner;
    if (line->cells > 0.f) {
        w -= line->cells * (edge_profile_blurred(blur, s - line->cell_near).step -
                            edge_profile_blurred(blur, s - line->cell_far).step);
    }
    *slope = edge.pulse * line->corner;
    return w;
}

static void add_line(fit_sums_t *sums, const fit_line_t *line, const edge_blur_t *blur, float per_sigma)
{
    for (int k = 0; k < line->count; ++k) {
        const float s = line->s_first + (float)k * line->s_step;
        float x[REGRESSORS];
        x[W] = coverage(line, blur, s, &x[G]);
        x[H] = -s * per_sigma * x[G];
        add_pixel(sums, line->grey[k], x, J);
    }
}

static void add_line_clipped(fit_sums_t *sums, const fit_line_t *line, const edge_blur_t *blur,
                             float per_sigma, float clip)
{
    const float scale = 1.f / clip;
    for (int k = 0; k < line->count; ++k) {
        const float s = line->s_first + (float)k * line->s_step;
        float slope, x[REGRESSORS] = {1.f, 0.f, 0.f, 0.f};
        const float w = coverage(line, blur, s, &slope);
        if (w < clip) {
            x[W] = w * scale;
            x[G] = slope * scale;
            x[H] = -s * per_sigma * x[G];
            x[J] = -x[W] * scale;
        }
        add_pixel(sums, line->grey[k], x, REGRESSORS);
    }
}

/** What the blur and the clip would explain once the three unknowns are taken off. */
static void shape_information(double xx[REGRESSORS][REGRESSORS], const double xi[REGRESSORS],
                              double det, double contrast, stretch_t *out)
{
    double on[2][2]; /* h and j by w and g */
    for (int a = 0; a < 2; ++a) {
        const double *row = xx[H + a];
        on[a][0] = (xx[G][G] * row[W] - xx[G][W] * row[G]) / det;
        on[a][1] = (xx[W][W] * row[G] - xx[G][W] * row[W]) / det;
    }
    const double cc = contrast * contrast;
    out->blur_weight = (float)(cc * (xx[H][H] - on[0][0] * xx[H][W] - on[0][1] * xx[H][G]));
    out->blur_slope = (float)(contrast * (xi[H] - on[0][0] * xi[W] - on[0][1] * xi[G]));
    out->clip_weight = (float)(cc * (xx[J][J] - on[1][0] * xx[J][W] - on[1][1] * xx[J][G]));
    out->clip_slope = (float)(contrast * (xi[J] - on[1][0] * xi[W] - on[1][1] * xi[G]));
    out->clip_blur = (float)(cc * (xx[J][H] - on[1][0] * xx[H][W] - on[1][1] * xx[H][G]));
}

static int solve(const fit_sums_t *sums, stretch_t *out)
{
    const double n = (double)sums->n;
    if (n < PIXELS_LEAST) {
        return 0;
    }
    double xx[REGRESSORS][REGRESSORS], xi[REGRESSORS];
    for (int a = 0; a < REGRESSORS; ++a) {
        xi[a] = (double)sums->xi[a] - (double)sums->x[a] * (double)sums->i / n;
        for (int b = 0; b <= a; ++b) {
            xx[a][b] = (double)sums->xx[a][b] - (double)sums->x[a] * (double)sums->x[b] / n;
        }
    }
    const double ii = (double)sums->ii - (double)sums->i * (double)sums->i / n;
    const double det = xx[W][W] * xx[G][G] - xx[G][W] * xx[G][W];
    if (!(det > 1e-3 * xx[W][W] * xx[G][G])) {
        return 0;
    }
    const double contrast = (xx[G][G] * xi[W] - xx[G][W] * xi[G]) / det;
    const double slope = (xx[W][W] * xi[G] - xx[G][W] * xi[W]) / det;
    if (!(contrast > 0)) {
        return 0;
    }
    const double rss = ii - contrast * xi[W] - slope * xi[G];
    out->pixels = (uint16_t)(n < 65535 ? n : 65535);
    out->contrast = (float)contrast;
    out->offset_px = (float)(-slope / contrast);
    out->sigma_unit = (float)(sqrt(xx[W][W] / det) / contrast);
    out->variance = (float)((rss > 0 ? rss : 0) / (n - 3));
    shape_information(xx, xi, det, contrast, out);
    return 1;
}

int stretch_fit(const fit_line_t *lines, int count, const edge_blur_t *blur, double sigma, double clip,
                int white_level, stretch_t *out)
{
    int pixels = 0, saturated = 0;
    const float white = (float)white_level - 0.5f;
    for (int i = 0; i < count; ++i) {
        pixels += lines[i].count;
        for (int k = 0; k < lines[i].count; ++k) {
            saturated += lines[i].grey[k] >= white;
        }
    }
    fit_sums_t sums;
    memset(&sums, 0, sizeof sums);
    const float per_sigma = (float)(1 / sigma);
    const int clipped = clip < 1 && (float)saturated > SATURATED_PART * (float)pixels;
    for (int i = 0; i < count; ++i) {
        if (clipped) {
            add_line_clipped(&sums, &lines[i], blur, per_sigma, (float)clip);
        } else {
            add_line(&sums, &lines[i], blur, per_sigma);
        }
    }
    out->saturated = (uint16_t)saturated;
    return solve(&sums, out);
}
