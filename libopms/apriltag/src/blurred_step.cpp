/* SPDX-License-Identifier: Apache-2.0 */
/* Gauss-Newton on the raw grey levels: erf along the normal for the border's outer edge, and the
 * same again, weighted by the known bits, for its inner edge, so that white bits behind a narrow
 * border do not pull the fit. */
#include "blurred_step.h"

#include <algorithm>
#include <cmath>

#include "tag_plane.h"

namespace opms_tag {
namespace {

constexpr int PARAMETERS = 5; /* offset, slope, blur, black, step */
constexpr int ITERATIONS = 20;
constexpr double CONVERGED_PX = 1e-5;
constexpr double BLUR_MIN_PX = 0.25, BLUR_MAX_PX = 4.0;
constexpr double START_BLUR_PX = 0.8;
constexpr double OFFSET_MAX_PX = 2.0, SLOPE_MAX = 0.2;
/** Grey levels are rounded: their noise is never less than that of the rounding. */
constexpr double ROUNDING_VARIANCE = 1.0 / 12.0;

struct Normal {
    double A[PARAMETERS][PARAMETERS] = {};
    double g[PARAMETERS][1] = {};
    double ssr = 0.0;
};

double cdf(double z) { return 0.5 * std::erfc(-z * 0.70710678118654752); }
double pdf(double z) { return 0.39894228040143268 * std::exp(-0.5 * z * z); }

/** Model level of one sample and its gradient. */
double model(const StepSample &s, const double p[PARAMETERS], double border_px,
             double gradient[PARAMETERS])
{
    const double blur = p[2];
    const double outer = (s.out_px - p[0] - p[1] * s.along_px) / blur;
    const double inner = outer + border_px / blur;
    const double shape = cdf(outer) + s.inner * cdf(-inner);
    const double by_outer = p[4] * pdf(outer) / blur;
    const double by_inner = p[4] * s.inner * pdf(inner) / blur;
    gradient[0] = by_inner - by_outer;
    gradient[1] = gradient[0] * s.along_px;
    gradient[2] = by_inner * inner - by_outer * outer;
    gradient[3] = 1.0;
    gradient[4] = shape;
    return p[3] + p[4] * shape;
}

Normal normal_equations(const std::vector<StepSample> &samples, const double p[PARAMETERS],
                        double border_px)
{
    Normal n;
    for (const StepSample &s : samples) {
        double gradient[PARAMETERS];
        const double residual = s.level - model(s, p, border_px, gradient);
        n.ssr += residual * residual;
        for (int i = 0; i < PARAMETERS; i++) {
            n.g[i][0] += gradient[i] * residual;
            for (int j = 0; j < PARAMETERS; j++) {
                n.A[i][j] += gradient[i] * gradient[j];
            }
        }
    }
    return n;
}

/** Black and step by linear regression on the shape of the expected edge. */
bool start(const std::vector<StepSample> &samples, double border_px, double p[PARAMETERS])
{
    const double unit[PARAMETERS] = {0.0, 0.0, START_BLUR_PX, 0.0, 1.0};
    double A[2][2] = {}, b[2][1] = {};
    for (const StepSample &s : samples) {
        double gradient[PARAMETERS];
        const double shape = model(s, unit, border_px, gradient);
        A[0][0] += 1.0;
        A[0][1] += shape;
        A[1][1] += shape * shape;
        b[0][0] += s.level;
        b[1][0] += shape * s.level;
    }
    A[1][0] = A[0][1];
    if (!solve(A, b)) {
        return false;
    }
    std::copy(unit, unit + 3, p);
    p[3] = b[0][0];
    p[4] = b[1][0];
    return p[4] > 0.0;
}

/** Take one step, shortened so that the shape stays in range. @return Its size in px. */
double advance(Normal n, double p[PARAMETERS], bool &solved)
{
    for (int i = 0; i < PARAMETERS; i++) {
        n.A[i][i] *= 1.0 + 1e-9;
    }
    solved = solve(n.A, n.g);
    if (!solved) {
        return 0.0;
    }
    const double largest = std::max(std::fabs(n.g[0][0]), std::fabs(n.g[2][0]));
    const double part = largest > 0.5 ? 0.5 / largest : 1.0;
    for (int i = 0; i < PARAMETERS; i++) {
        p[i] += part * n.g[i][0];
    }
    p[2] = std::clamp(p[2], BLUR_MIN_PX, BLUR_MAX_PX);
    return part * largest;
}

} // namespace

bool fit_blurred_step(const std::vector<StepSample> &samples, double border_px, BlurredStep &fit)
{
    double p[PARAMETERS];
    if (samples.size() < 4 * PARAMETERS || !start(samples, border_px, p)) {
        return false;
    }
    bool solved = true;
    double moved_px = 1.0;
    for (int i = 0; i < ITERATIONS && moved_px > CONVERGED_PX; i++) {
        moved_px = advance(normal_equations(samples, p, border_px), p, solved);
        if (!solved || !(std::fabs(p[0]) < OFFSET_MAX_PX) || !(std::fabs(p[1]) < SLOPE_MAX)) {
            return false;
        }
    }
    const bool at_limit = p[2] <= BLUR_MIN_PX || p[2] >= BLUR_MAX_PX;
    if ((moved_px > CONVERGED_PX && !at_limit) || !(p[4] > 0.0)) {
        return false;
    }
    Normal n = normal_equations(samples, p, border_px);
    double inverse[PARAMETERS][PARAMETERS] = {};
    for (int i = 0; i < PARAMETERS; i++) {
        inverse[i][i] = 1.0;
    }
    if (!solve(n.A, inverse)) {
        return false;
    }
    const double freedom = static_cast<double>(samples.size() - PARAMETERS);
    const double variance = std::max(n.ssr / freedom, ROUNDING_VARIANCE);
    fit = {p[0], p[1], p[2], p[3], p[4], std::sqrt(variance),
           std::sqrt(variance * inverse[0][0]), std::sqrt(variance * inverse[1][1])};
    return true;
}

} // namespace opms_tag
