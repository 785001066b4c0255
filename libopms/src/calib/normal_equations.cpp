// SPDX-License-Identifier: Apache-2.0
#include "calib/normal_equations.h"

#include <cmath>

#include "lens/lens_fast.h"

namespace opms::calib
{

namespace
{

/* x^i y^j of the cockle, lowest degree first: a plane's own terms belong to the pose. */
constexpr int POWERS[OPMS_CALIB_COCKLE_TERMS][2] = {{2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2},
                                                    {0, 3}, {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

void cockle_terms(double cockle_scale_m, double X, double Y, double *terms)
{
    double x[5] = {1.0}, y[5] = {1.0};
    for (int i = 1; i < 5; ++i) {
        x[i] = x[i - 1] * X / cockle_scale_m;
        y[i] = y[i - 1] * Y / cockle_scale_m;
    }
    for (int k = 0; k < OPMS_CALIB_COCKLE_TERMS; ++k) {
        terms[k] = x[POWERS[k][0]] * y[POWERS[k][1]];
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

/* d(u, v)/d(shared), each row with its zeros. */
template <int S>
void shared_rows(const View &view, const opms_calib_point_t &point, const Seen &seen,
                 const double to_camera[2][3], Eigen::Matrix<double, 2, S> &rows)
{
    const double r2 = seen.x * seen.x + seen.y * seen.y;
    const double fx = view.shape.lens.fx_px, fy = view.shape.lens.fy_px;
    rows.template leftCols<LENS>() << seen.bend.xd, 0.0, 1.0, 0.0, fx * seen.x * r2,
        fx * seen.x * r2 * r2, fx * 2.0 * seen.x * seen.y, fx * (r2 + 2.0 * seen.x * seen.x), //
        0.0, seen.bend.yd, 0.0, 1.0, fy * seen.y * r2, fy * seen.y * r2 * r2,
        fy * (r2 + 2.0 * seen.y * seen.y), fy * 2.0 * seen.x * seen.y;
    if constexpr (S > LENS) {
        double terms[OPMS_CALIB_COCKLE_TERMS];
        cockle_terms(view.cockle_scale_m, point.target_m[0], point.target_m[1], terms);
        const Vec3 up = view.camera_from_target.col(2);
        for (int row = 0; row < 2; ++row) {
            const double slope = to_camera[row][0] * up.x() + to_camera[row][1] * up.y() +
                                 to_camera[row][2] * up.z();
            for (int k = 0; k < OPMS_CALIB_COCKLE_TERMS; ++k) {
                rows(row, LENS + k) = slope * terms[k];
            }
        }
    }
}

/* d(u, v)/d(camera coordinates). */
void camera_gradient(const View &view, const Seen &seen, double jac[2][3])
{
    const double fx = view.shape.lens.fx_px / seen.camera.z();
    const double fy = view.shape.lens.fy_px / seen.camera.z();
    jac[0][0] = fx * seen.bend.xx;
    jac[0][1] = fx * seen.bend.xy;
    jac[0][2] = -(jac[0][0] * seen.x + jac[0][1] * seen.y);
    jac[1][0] = fy * seen.bend.xy;
    jac[1][1] = fy * seen.bend.yy;
    jac[1][2] = -(jac[1][0] * seen.x + jac[1][1] * seen.y);
}

/* d(u, v)/d(w, d): the camera point moves by p x w and by -R_camera_target d. */
void pose_rows(const View &view, const Seen &seen, const double jac[2][3],
               Eigen::Matrix<double, 2, 6> &rows)
{
    for (int row = 0; row < 2; ++row) {
        const Vec3 g(jac[row][0], jac[row][1], jac[row][2]);
        rows.row(row).head<3>() = g.cross(seen.camera);
        rows.row(row).tail<3>() = -(view.camera_from_target.transpose() * g);
    }
}

/* The same sums with their sizes known, for the loop over the points. */
template <int S>
struct Sums {
    Eigen::Matrix<double, S, S> shared = Eigen::Matrix<double, S, S>::Zero();
    Eigen::Matrix<double, 6, S> coupling = Eigen::Matrix<double, 6, S>::Zero();
    Mat6 pose = Mat6::Zero();
    Eigen::Matrix<double, S, 1> shared_gradient = Eigen::Matrix<double, S, 1>::Zero();
    Vec6 pose_gradient = Vec6::Zero();
};

template <int S>
void add_point(const View &view, const opms_calib_point_t &point, const Seen &seen, double weight,
               Sums<S> &sums)
{
    double jac[2][3];
    camera_gradient(view, seen, jac);
    Eigen::Matrix<double, 2, S> shared;
    Eigen::Matrix<double, 2, 6> pose;
    shared_rows<S>(view, point, seen, jac, shared);
    pose_rows(view, seen, jac, pose);
    const double information = weight / (point.sigma_px * point.sigma_px);
    const Eigen::Vector2d pull(information * seen.residual[0], information * seen.residual[1]);
    const Eigen::Matrix<double, 2, 6> weighted = information * pose;
    sums.shared.noalias() += (information * shared).transpose().lazyProduct(shared);
    sums.coupling.noalias() += weighted.transpose().lazyProduct(shared);
    sums.pose.noalias() += weighted.transpose().lazyProduct(pose);
    sums.shared_gradient.noalias() -= shared.transpose() * pull;
    sums.pose_gradient.noalias() -= pose.transpose() * pull;
}

template <int S>
void sum_points(const Picture &picture, const View &view, double scale, uint32_t stride,
                Weights weights, PictureEquations &equations)
{
    Sums<S> sums;
    for (uint32_t i = 0; i < picture.count; i += stride) {
        const opms_calib_point_t &point = picture.points[i];
        const Seen seen = view.look(point);
        const Pull pull = tukey(squared_sigmas(seen, point.sigma_px), scale);
        equations.in_front = equations.in_front && seen.in_front;
        equations.cost += pull.cost;
        const double weight =
            weights == Weights::Robust ? pull.weight : (pull.weight >= INLIER_WEIGHT ? 1.0 : 0.0);
        if (weight > 0.0) {
            add_point<S>(view, point, seen, weight, sums);
        }
    }
    Eigen::Map<Eigen::Matrix<double, S, S>>(equations.shared) = sums.shared;
    Eigen::Map<Eigen::Matrix<double, 6, S>>(equations.coupling) = sums.coupling;
    Eigen::Map<Eigen::Matrix<double, S, 1>>(equations.shared_gradient) = sums.shared_gradient;
    equations.pose = sums.pose;
    equations.pose_gradient = sums.pose_gradient;
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
    const View view(shape, pose, cockle_scale_m);
    equations.cost = 0.0;
    equations.in_front = true;
    if (equations.size == LENS) {
        sum_points<LENS>(picture, view, scale, stride, weights, equations);
    } else {
        sum_points<SHARED>(picture, view, scale, stride, weights, equations);
    }
    equations.in_front = equations.in_front && std::isfinite(equations.cost);
}

double picture_cost(const Picture &picture, const Shape &shape, const Rigid &pose, double scale,
                    double cockle_scale_m, uint32_t stride)
{
    const View view(shape, pose, cockle_scale_m);
    double cost = 0.0;
    for (uint32_t i = 0; i < picture.count; i += stride) {
        const Seen seen = view.look(picture.points[i]);
        if (!seen.in_front) {
            return HUGE_VAL;
        }
        cost += tukey(squared_sigmas(seen, picture.points[i].sigma_px), scale).cost;
    }
    return std::isfinite(cost) ? cost : HUGE_VAL;
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
