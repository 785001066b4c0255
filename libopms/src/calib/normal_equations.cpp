// SPDX-License-Identifier: Apache-2.0
#include "calib/normal_equations.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "calib/cockle_powers.h"
#include "calib/point_rows.h"
#include "lens/lens_fast.h"

namespace opms::calib
{

namespace
{

void cockle_terms(double cockle_scale_m, double X, double Y, double *terms)
{
    double x[COCKLE_DEGREE + 1] = {1.0}, y[COCKLE_DEGREE + 1] = {1.0};
    for (int i = 1; i <= COCKLE_DEGREE; ++i) {
        x[i] = x[i - 1] * X / cockle_scale_m;
        y[i] = y[i - 1] * Y / cockle_scale_m;
    }
    for (int k = 0; k < OPMS_CALIB_COCKLE_TERMS; ++k) {
        terms[k] = x[COCKLE_POWERS[k][0]] * y[COCKLE_POWERS[k][1]];
    }
}

/* A point as the model has it. */
struct Seen {
    Vec3 camera; // in the camera frame
    double x, y; // its ray
    lens_bend_t bend;
    double residual[2]; // measured less model, px
    bool in_front;
};

struct View {
    const Shape &shape;
    Mat3 camera_from_target;
    Vec3 origin; // of the target, in the camera
    double cockle_scale_m;

    View(const Shape &shape_, const Rigid &pose, double cockle_scale)
        : shape(shape_), camera_from_target(pose.R.transpose()),
          origin(-(camera_from_target * pose.t)), cockle_scale_m(cockle_scale)
    {
    }

    Seen look(const opms_calib_point_t &point) const
    {
        Seen seen;
        const double X = point.target_m[0], Y = point.target_m[1];
        seen.camera =
            camera_from_target.col(0) * X + camera_from_target.col(1) * Y + origin;
        if (cockle_scale_m > 0.0) {
            seen.camera += camera_from_target.col(2) *
                           target_height(shape, cockle_scale_m, X, Y);
        }
        seen.in_front = seen.camera.z() > 0.0;
        seen.x = seen.camera.x() / seen.camera.z();
        seen.y = seen.camera.y() / seen.camera.z();
        seen.bend = lens_bend(&shape.lens, seen.x, seen.y);
        seen.residual[0] =
            point.px[0] - (shape.lens.fx_px * seen.bend.xd + shape.lens.cx_px);
        seen.residual[1] =
            point.px[1] - (shape.lens.fy_px * seen.bend.yd + shape.lens.cy_px);
        return seen;
    }
};

/* Tukey's weight and cost at z^2 sigmas squared of the window's scale. */
struct Pull {
    double weight, cost;
};

Pull tukey(double z2, double scale)
{
    const double window2 = TUKEY * TUKEY * scale * scale;
    const double rest = 1.0 - z2 / window2;
    if (!(rest > 0.0)) {
        return {0.0, window2 / 3.0};
    }
    return {rest * rest, window2 / 3.0 * (1.0 - rest * rest * rest)};
}

double squared_sigmas(const Seen &seen, double sigma_px)
{
    return (seen.residual[0] * seen.residual[0] + seen.residual[1] * seen.residual[1]) /
           (sigma_px * sigma_px);
}

point_view_t point_view(const Shape &shape, const Rigid &pose, double scale,
                        double cockle_scale_m, Weights weights)
{
    point_view_t view = {};
    const Mat3 camera_from_target = pose.R.transpose();
    Eigen::Map<algebra::RowMajor<3, 3>>(view.R) = camera_from_target;
    Eigen::Map<Vec3>(view.origin) = -(camera_from_target * pose.t);
    view.lens = shape.lens;
    view.cockle = shape.cockle;
    view.cockle_scale_m = cockle_scale_m;
    view.window2 = TUKEY * TUKEY * scale * scale;
    view.inliers_only = weights == Weights::Inliers;
    view.inlier_rest = std::sqrt(INLIER_WEIGHT);
    return view;
}

/* Call with each block of a picture's points in turn: first, and how many. */
template <typename Each>
void each_block(const Picture &picture, uint32_t stride, const Each &each)
{
    const uint32_t count = (picture.count + stride - 1) / stride;
    for (uint32_t i = 0; i < count; i += GRAM_ROWS) {
        each(picture.points + i * stride, (int)std::min<uint32_t>(GRAM_ROWS, count - i));
    }
}

/* The columns of a block of points, and what is summed up of them, for u and v. */
template <int S>
struct Columns {
    static constexpr int POSE = LENS_COLUMNS + S - LENS, RESIDUAL = POSE + 6;
    static constexpr int COUNT = (RESIDUAL + 2) / 2 * 2; // even: the last one may stay empty
    double at[2][COUNT][GRAM_ROWS] = {};
    double gram[2][COUNT * COUNT] = {};
};

/* Which of the shared unknowns a column belongs to. */
int shared_of(int axis, int column)
{
    return column < 2 ? 2 * column + axis : column + 2;
}

template <int S>
void write_equations(const Columns<S> &columns, PictureEquations &equations)
{
    using C = Columns<S>;
    std::memset(equations.shared, 0, sizeof equations.shared);
    std::memset(equations.coupling, 0, sizeof equations.coupling);
    std::memset(equations.shared_gradient, 0, sizeof equations.shared_gradient);
    equations.pose.setZero();
    equations.pose_gradient.setZero();
    for (int axis = 0; axis < 2; ++axis) {
        const auto sum = [&](int a, int b) {
            return columns.gram[axis][std::min(a, b) * C::COUNT + std::max(a, b)];
        };
        for (int a = 0; a < C::POSE; ++a) {
            const int i = shared_of(axis, a);
            for (int b = 0; b < C::POSE; ++b) {
                equations.shared[i * S + shared_of(axis, b)] += sum(a, b);
            }
            for (int k = 0; k < 6; ++k) {
                equations.coupling[i * 6 + k] += sum(a, C::POSE + k);
            }
            equations.shared_gradient[i] -= sum(a, C::RESIDUAL);
        }
        for (int k = 0; k < 6; ++k) {
            for (int l = 0; l < 6; ++l) {
                equations.pose(k, l) += sum(C::POSE + k, C::POSE + l);
            }
            equations.pose_gradient[k] -= sum(C::POSE + k, C::RESIDUAL);
        }
    }
}

template <int S>
void sum_points(const Picture &picture, const point_view_t &view, uint32_t stride,
                PictureEquations &equations)
{
    using C = Columns<S>;
    C columns;
    int in_front = 1;
    equations.cost = 0.0;
    each_block(picture, stride, [&](const opms_calib_point_t *points, int n) {
        equations.cost += point_rows(&view, points, stride, n, columns.at[0][0],
                                     C::COUNT * GRAM_ROWS, &in_front);
        gram_add(columns.at[0][0], C::COUNT, columns.gram[0]);
        gram_add(columns.at[1][0], C::COUNT, columns.gram[1]);
    });
    equations.in_front = in_front && std::isfinite(equations.cost);
    write_equations(columns, equations);
}

} // namespace

double target_height(const Shape &shape, double cockle_scale_m, double X, double Y)
{
    if (!(cockle_scale_m > 0.0)) {
        return 0.0;
    }
    double terms[OPMS_CALIB_COCKLE_TERMS], height = 0.0;
    cockle_terms(cockle_scale_m, X, Y, terms);
    for (int k = 0; k < OPMS_CALIB_COCKLE_TERMS; ++k) {
        height += shape.cockle[k] * terms[k];
    }
    return height;
}

void sum_equations(const Picture &picture, const Shape &shape, const Rigid &pose, double scale,
                   double cockle_scale_m, uint32_t stride, Weights weights,
                   PictureEquations &equations)
{
    point_view_t view = point_view(shape, pose, scale, cockle_scale_m, weights);
    if (equations.size == LENS) {
        sum_points<LENS>(picture, view, stride, equations);
    } else {
        view.cockle_columns = OPMS_CALIB_COCKLE_TERMS;
        sum_points<SHARED>(picture, view, stride, equations);
    }
}

double picture_cost(const Picture &picture, const Shape &shape, const Rigid &pose, double scale,
                    double cockle_scale_m, uint32_t stride)
{
    const point_view_t view = point_view(shape, pose, scale, cockle_scale_m, Weights::Robust);
    double cost = 0.0;
    int in_front = 1;
    each_block(picture, stride, [&](const opms_calib_point_t *points, int n) {
        cost += point_costs(&view, points, stride, n, &in_front);
    });
    return in_front && std::isfinite(cost) ? cost : HUGE_VAL;
}

void picture_residuals(const Picture &picture, const Shape &shape, double scale,
                       double cockle_scale_m, double *residuals, double *weights)
{
    const View view(shape, picture.pose, cockle_scale_m);
    for (uint32_t i = 0; i < picture.count; ++i) {
        const Seen seen = view.look(picture.points[i]);
        residuals[2 * i] = seen.residual[0];
        residuals[2 * i + 1] = seen.residual[1];
        weights[i] = tukey(squared_sigmas(seen, picture.points[i].sigma_px), scale).weight;
    }
}

uint32_t residual_lengths(const Picture &picture, const Shape &shape, double cockle_scale_m,
                          uint32_t first, uint32_t each, double *lengths, uint32_t room)
{
    const View view(shape, picture.pose, cockle_scale_m);
    uint32_t n = 0;
    for (uint32_t i = first; i < picture.count && n < room; i += each) {
        const Seen seen = view.look(picture.points[i]);
        const double length = std::sqrt(squared_sigmas(seen, picture.points[i].sigma_px));
        lengths[n++] = seen.in_front && std::isfinite(length) ? length : 1e300;
    }
    return n;
}

} // namespace opms::calib
