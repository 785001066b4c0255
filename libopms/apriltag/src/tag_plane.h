/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The plane of the bar as a homography to normalised coordinates, and small linear systems. */
#ifndef OPMS_TAG_PLANE_H
#define OPMS_TAG_PLANE_H

#include <cmath>
#include <utility>

namespace opms_tag {

/** A point of the bar plane (m), of the rays (x, y) or of the picture (u, v). */
struct Point {
    double x, y;
};

inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
inline double length(Point a) { return std::hypot(a.x, a.y); }

/** Corner i of tag k in the bar plane, in the order of opms_square_t. */
Point tag_corner_m(int k, int i);

/** Takes points of the bar plane to rays. */
struct Plane {
    double h[9];
    Point map(Point bar_m) const;
};

/** The homography through four points. @return False where they are degenerate. */
bool plane_through(const Point bar_m[4], const Point ray[4], Plane &plane);

/** Solve A X = B in place by Gauss with pivoting; X replaces B. @return False where singular. */
template <int N, int M> bool solve(double (&A)[N][N], double (&B)[N][M])
{
    for (int k = 0; k < N; k++) {
        int pivot = k;
        for (int i = k + 1; i < N; i++) {
            pivot = std::fabs(A[i][k]) > std::fabs(A[pivot][k]) ? i : pivot;
        }
        if (!(std::fabs(A[pivot][k]) > 1e-14)) {
            return false;
        }
        std::swap(A[k], A[pivot]);
        std::swap(B[k], B[pivot]);
        for (int i = 0; i < N; i++) {
            const double f = i == k ? 0.0 : A[i][k] / A[k][k];
            if (f == 0.0) {
                continue;
            }
            for (int j = k; j < N; j++) {
                A[i][j] -= f * A[k][j];
            }
            for (int j = 0; j < M; j++) {
                B[i][j] -= f * B[k][j];
            }
        }
    }
    for (int k = 0; k < N; k++) {
        for (int j = 0; j < M; j++) {
            B[k][j] /= A[k][k];
        }
    }
    return true;
}

} // namespace opms_tag

#endif
