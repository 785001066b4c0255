// SPDX-License-Identifier: Apache-2.0
// From edges to a pose: a linear start and both planar solutions on a sample of the edges, then the
// better one on all of them; the other one too, where the sample does not settle it.
#include <opms/pose.h>

#include <algorithm>
#include <cstring>

#include "algebra/spd.h"
#include "base/fail.h"
#include "pose/covariance.h"
#include "pose/planar.h"
#include "pose/refine.h"

namespace
{

using namespace opms::pose;

constexpr uint32_t EDGES_MIN = 8;
constexpr double SCALE_MAX_PX = 2.0;    // residuals beyond this agree with nothing
constexpr double CLEAR_EXCESS = 100.0;  // chi2 that settles it on the sample
constexpr double ALIKE_EXCESS = 16.0;   // chi2 within which both solutions stand
constexpr double APART = 16.0;          // squared distance in sigmas from which two poses differ
constexpr double SAMPLE_PLEASES = 0.7;  // part of all edges that a good start makes fit
constexpr double SCALE_PLEASES = 2.0;   // residuals over stated sigmas, likewise
constexpr double NO_OTHER = 1e12;       // chi2_other where there is no second solution
constexpr double ANGLE_SIGMA_MAX = 0.3; // rad; nothing is known beyond it
constexpr RefinePlan PLAN_START = {Steps::Careful, 15, 0.01, 0.6};
constexpr RefinePlan PLAN_OTHER = {Steps::Careful, 6, 0.5, 0.6};
constexpr RefinePlan PLAN_ALL = {Steps::Newton, 20, 1e-4, 0.8};

opms_status_t fail_arg(opms_error_t *err, int32_t index, const char *what)
{
    return opms_fail(err, OPMS_ERR_ARG, "pose", index, "%s", what);
}

opms_status_t check_lens(const opms_lens_t &lens, opms_error_t *err)
{
    const double sum =
        lens.fx_px + lens.fy_px + lens.cx_px + lens.cy_px + lens.k1 + lens.k2 + lens.p1 + lens.p2;
    if (!std::isfinite(sum) || !(lens.fx_px > 0.0) || !(lens.fy_px > 0.0)) {
        return fail_arg(err, -1,
                        "lens has a value that is not finite or a focal length not above 0");
    }
    return OPMS_OK;
}

opms_status_t check_edge(const opms_edge_t &edge, int32_t index, opms_error_t *err)
{
    if (edge.square < 0 || edge.square >= OPMS_BAR_SQUARES) {
        return fail_arg(err, index, "edges[].square is not 0 to 32");
    }
    if (edge.side < 0 || edge.side > 3) {
        return fail_arg(err, index, "edges[].side is not 0 to 3");
    }
    const double sum = edge.bar_m[0] + edge.bar_m[1] + edge.px[0] + edge.px[1];
    if (!std::isfinite(sum)) {
        return fail_arg(err, index, "edges[].bar_m or edges[].px is not finite");
    }
    const double length2 = edge.normal[0] * edge.normal[0] + edge.normal[1] * edge.normal[1];
    if (!(std::fabs(length2 - 1.0) < 1e-3)) {
        return fail_arg(err, index, "edges[].normal is not a unit vector");
    }
    if (!(edge.sigma_px > 0.0 && edge.sigma_px < 1e6)) {
        return fail_arg(err, index, "edges[].sigma_px is not above 0 and finite");
    }
    if (!(edge.shift_gain >= 0.0 && edge.shift_gain < 1e3)) {
        return fail_arg(err, index, "edges[].shift_gain is negative or not finite");
    }
    return OPMS_OK;
}

opms_status_t check_arguments(const opms_lens_t *lens, const opms_edge_t *edges, uint32_t count,
                              const opms_pose_result_t *result, opms_error_t *err)
{
    if (!lens) {
        return fail_arg(err, -1, "lens is NULL");
    }
    if (!result) {
        return fail_arg(err, -1, "result is NULL");
    }
    if (!edges && count > 0) {
        return fail_arg(err, -1, "edges is NULL");
    }
    if (count > OPMS_BAR_EDGES_MAX) {
        return fail_arg(err, -1, "count is above OPMS_BAR_EDGES_MAX");
    }
    OPMS_TRY(check_lens(*lens, err));
    for (uint32_t i = 0; i < count; ++i) {
        OPMS_TRY(check_edge(edges[i], static_cast<int32_t>(i), err));
    }
    return OPMS_OK;
}

bool enough_edges(const opms_edge_t *edges, uint32_t count)
{
    if (count < EDGES_MIN) {
        return false;
    }
    return std::any_of(edges, edges + count,
                       [&](const opms_edge_t &edge) { return edge.square != edges[0].square; });
}

/* The printed face is the one that is seen: the camera is on its +Z side. */
bool plausible(const Fit &fit)
{
    return fit.normal.in_front && fit.placement.t.z() > 0.0;
}

/* Best fit to the first n edges, from a linear start. */
bool start(const EdgeSet &set, uint32_t n, const opms_edge_t *edges, PlaneView &view, Fit &best)
{
    Placement poses[2];
    if (!homography_start(set, n, edges, view) || !planar_poses(view, poses)) {
        return false;
    }
    // Which of the two is nearer shows before any step; the other is looked at later, from the
    // refined one.
    Normal looks[2];
    double z[128];
    residuals(set, std::min<uint32_t>(n, 128), poses[0], z);
    const double scale = std::max(1.0, robust_scale(z, n));
    normal_equations(set, n, poses[0], scale, Steps::Careful, looks[0]);
    normal_equations(set, n, poses[1], scale, Steps::Careful, looks[1]);
    const bool second = looks[1].in_front && !(looks[0].in_front && looks[0].cost <= looks[1].cost);
    best.placement = poses[second ? 1 : 0];
    refine(set, n, PLAN_START, best);
    return plausible(best);
}

/* How much worse the other solution fits the first n edges, in chi2 at the best one's scale. */
double excess(const EdgeSet &set, uint32_t n, const Fit &best, const Fit &other)
{
    Normal at_best, at_other;
    normal_equations(set, n, best.placement, best.scale, Steps::Careful, at_best);
    normal_equations(set, n, other.placement, best.scale, Steps::Careful, at_other);
    return at_other.cost - at_best.cost;
}

/* Squared distance of two placements in sigmas of the covariance; without one they are far apart.
 */
double distance2(const Placement &from, const Placement &to, const Mat6 &covariance)
{
    Eigen::Matrix<double, 6, 1> step, solved;
    step << rotation_log(from.R.transpose() * to.R), to.t - from.t;
    Mat6 matrix = covariance;
    solved = step;
    return spd_solve_scaled(matrix.data(), 6, 0.0, SPD_PIVOT_LEAST, solved.data())
        ? step.dot(solved)
        : HUGE_VAL;
}

struct Solution {
    EdgeSet set;
    PlaneView view;
    Fit best, other;
    double chi2_other;
    bool close; /**< the other solution was refined on all edges, too */
    double z[EdgeSet::CAPACITY];
    FitQuality quality;
    Mat7 inverse;
    Mat6 covariance;
};

/* Refine the reflected pose on the sample; swap the two where it is the better one. */
void find_other(Solution &s)
{
    const uint32_t n = s.set.sample;
    s.other.placement = planar_mirror(s.best.placement, s.view.centre_m[0], s.view.centre_m[1]);
    refine(s.set, n, PLAN_OTHER, s.other);
    s.close = false;
    s.chi2_other = NO_OTHER;
    if (!plausible(s.other)) {
        return;
    }
    if (s.other.scale < s.best.scale ||
        (s.other.scale == s.best.scale && s.other.normal.cost < s.best.normal.cost)) {
        std::swap(s.best, s.other);
    }
    s.chi2_other = excess(s.set, n, s.best, s.other) * s.set.count / n;
    s.close = s.chi2_other < CLEAR_EXCESS;
}

/* The fit of all edges, and the other one too if it is close. */
bool refine_all(Solution &s)
{
    refine(s.set, s.set.count, PLAN_ALL, s.best);
    if (!plausible(s.best)) {
        return false;
    }
    if (s.close) {
        refine(s.set, s.set.count, PLAN_ALL, s.other);
        s.close = plausible(s.other);
        s.chi2_other = s.close ? excess(s.set, s.set.count, s.best, s.other) : NO_OTHER;
        if (s.chi2_other < 0.0) {
            std::swap(s.best, s.other);
            s.chi2_other = excess(s.set, s.set.count, s.best, s.other);
        }
    }
    residuals(s.set, s.set.count, s.best.placement, s.z);
    s.quality = fit_quality(s.set, s.best, s.z);
    return true;
}

/* A sample may be unlucky: what it leads to must please most edges, or all are looked at. */
bool find_best(const opms_lens_t &lens, const opms_edge_t *edges, uint32_t count, Solution &s)
{
    edge_set_init(s.set, count);
    edge_set_fill(s.set, lens, edges, 0, s.set.sample, nullptr);
    if (start(s.set, s.set.sample, edges, s.view, s.best)) {
        find_other(s);
        edge_set_fill(s.set, lens, edges, s.set.sample, count, &s.best.placement);
        const bool found = refine_all(s);
        if (s.set.sample == count || (found && s.best.converged && s.best.scale < SCALE_PLEASES &&
                                      s.quality.used >= SAMPLE_PLEASES * count)) {
            return found;
        }
    } else if (s.set.sample == count) {
        return false;
    }
    edge_set_fill(s.set, lens, edges, 0, count, nullptr);
    s.set.sample = count;
    if (!start(s.set, count, edges, s.view, s.best)) {
        return false;
    }
    find_other(s);
    return refine_all(s);
}

/* Figures of the best fit; false where too few edges agree or they leave the pose open. */
bool judge_best(Solution &s)
{
    if (s.quality.used < EDGES_MIN || 2 * s.quality.used < s.set.count ||
        !(s.quality.residual_px < SCALE_MAX_PX)) {
        return false;
    }
    if (!fit_covariance(s.best, s.quality.inflation, s.inverse, s.covariance)) {
        return false;
    }
    const double angle2 = s.covariance.diagonal().head<3>().maxCoeff();
    const double place2 = s.covariance.diagonal().tail<3>().maxCoeff();
    const double limit = ANGLE_SIGMA_MAX * ANGLE_SIGMA_MAX;
    return angle2 < limit && place2 < limit * s.best.placement.t.squaredNorm();
}

/* Whether both solutions stand. Where both starts have led to the same pose there is but one. */
bool is_ambiguous(Solution &s)
{
    if (!s.close) {
        return false;
    }
    if (!(distance2(s.best.placement, s.other.placement, s.covariance) > APART)) {
        s.chi2_other = NO_OTHER;
        return false;
    }
    s.chi2_other = std::max(0.0, s.chi2_other);
    return s.chi2_other < ALIKE_EXCESS;
}

void write_result(const opms_lens_t &lens, const Solution &s, opms_pose_result_t *result)
{
    const Placement &p = s.best.placement;
    Eigen::Map<RowMajor<3, 3>>(result->bar_camera.transform.R) = p.R;
    Eigen::Map<Vec3>(result->bar_camera.transform.t_m) = p.t;
    Eigen::Map<RowMajor<6, 6>>(result->bar_camera.covariance) = s.covariance;
    Eigen::Map<RowMajor<6, 8>>(result->intrinsics_jacobian) =
        fit_by_intrinsics(s.set, lens, s.best, s.inverse);
    result->edge_shift_px = p.shift_px;
}

void write_residuals(const Solution &s, const opms_edge_t *edges, double *residuals_px)
{
    for (uint32_t i = 0; i < s.set.count; ++i) {
        const uint32_t index = s.set.order[i];
        residuals_px[index] = s.z[i] * edges[index].sigma_px;
    }
}

} // namespace

opms_status_t opms_pose_solve(const opms_lens_t *lens, const opms_edge_t *edges, uint32_t count,
                              double *residuals_px, opms_pose_result_t *result, opms_error_t *err)
{
    OPMS_TRY(check_arguments(lens, edges, count, result, err));
    std::memset(result, 0, sizeof *result);
    result->state = OPMS_POSE_NONE;
    Solution s;
    if (!enough_edges(edges, count) || !find_best(*lens, edges, count, s) || !judge_best(s)) {
        return OPMS_OK;
    }
    result->edges_used = s.quality.used;
    result->residual_px = s.quality.residual_px;
    result->chi2_dof = s.quality.chi2_dof;
    const bool ambiguous = is_ambiguous(s);
    result->chi2_other = s.chi2_other;
    if (ambiguous) {
        result->state = OPMS_POSE_AMBIGUOUS;
        return OPMS_OK;
    }
    result->state = OPMS_POSE_FOUND;
    write_result(*lens, s, result);
    if (residuals_px) {
        write_residuals(s, edges, residuals_px);
    }
    return OPMS_OK;
}
