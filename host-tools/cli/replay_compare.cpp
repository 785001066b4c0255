/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pose_values.hpp"

using namespace opms_host;

namespace {

/** To the last bit, so that a NaN is itself and 0 is not -0. */
bool same_bits(const double *a, const double *b, std::size_t count)
{
    return std::memcmp(a, b, count * sizeof *a) == 0;
}

bool same_transform(const opms_pose_t &a, const opms_pose_t &b)
{
    return same_bits(a.transform.R, b.transform.R, 9) &&
           same_bits(a.transform.t_m, b.transform.t_m, 3);
}

bool same_squares(const std::vector<opms_square_t> &a, const std::vector<opms_square_t> &b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const opms_square_t &x, const opms_square_t &y) {
                          return x.index == y.index && x.edges == y.edges &&
                                 same_bits(x.corners_px[0], y.corners_px[0], 8);
                      });
}

bool same_edges(const std::vector<opms_edge_t> &a, const std::vector<opms_edge_t> &b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const opms_edge_t &x, const opms_edge_t &y) {
                          return x.square == y.square && x.side == y.side &&
                                 same_bits(x.bar_m, y.bar_m, 2) && same_bits(x.px, y.px, 2) &&
                                 same_bits(x.normal, y.normal, 2) &&
                                 same_bits(&x.sigma_px, &y.sigma_px, 1) &&
                                 same_bits(&x.shift_gain, &y.shift_gain, 1);
                      });
}

bool same_summary(const opms_bar_summary_t &a, const opms_bar_summary_t &b)
{
    return a.state == b.state && a.square_count == b.square_count &&
           a.edge_count == b.edge_count && same_bits(&a.label_margin, &b.label_margin, 1) &&
           same_bits(a.blur_px, b.blur_px, 2) && same_bits(&a.noise, &b.noise, 1) &&
           same_bits(&a.contrast, &b.contrast, 1) &&
           same_bits(&a.white_fraction_saturated, &b.white_fraction_saturated, 1);
}

void compare_solution(const opms_location_t &a, const opms_location_t &b, PoseChange &change)
{
    const auto note = [&change](bool same, const char *name) {
        if (!same) {
            change.differs.emplace_back(name);
        }
    };
    note(same_transform(a.pose.bar_camera, b.pose.bar_camera), "pose");
    note(same_bits(a.pose.bar_camera.covariance, b.pose.bar_camera.covariance, 36), "covariance");
    note(same_bits(&a.pose.edge_shift_px, &b.pose.edge_shift_px, 1), "edge_shift");
    note(same_bits(&a.pose.residual_px, &b.pose.residual_px, 1), "residual");
    note(a.has_ground_detector == b.has_ground_detector &&
             (!a.has_ground_detector ||
              (same_transform(a.ground_detector, b.ground_detector) &&
               same_bits(a.ground_detector.covariance, b.ground_detector.covariance, 36))),
         "detector");
}

/** Both of the detector, or, where one camera file does not know where it sits, of the camera. */
void measure(const opms_location_t &a, const opms_location_t &b, PoseChange &change)
{
    const bool of_detector = a.has_ground_detector && b.has_ground_detector;
    const opms_transform_t &from =
        of_detector ? a.ground_detector.transform : a.pose.bar_camera.transform;
    const opms_transform_t &to =
        of_detector ? b.ground_detector.transform : b.pose.bar_camera.transform;
    change.both_located = true;
    change.position_mm = distance_mm(from.t_m, to.t_m);
    change.angle_deg = angle_between_deg(from.R, to.R);
}

}  // namespace

PoseChange compare_poses(const PoseRecord &recorded, const PoseRecord &again, ReplayFrom from)
{
    PoseChange change;
    change.number = recorded.number;
    change.recorded = recorded.location.state;
    change.again = again.location.state;
    if (change.recorded != change.again) {
        change.differs.emplace_back("state");
    } else if (change.recorded == OPMS_BAR_LOCATED) {
        compare_solution(recorded.location, again.location, change);
        measure(recorded.location, again.location, change);
    }
    if (from == ReplayFrom::pictures) {
        if (!same_summary(recorded.location.bar, again.location.bar)) {
            change.differs.emplace_back("bar");
        }
        if (!same_squares(recorded.squares, again.squares)) {
            change.differs.emplace_back("squares");
        }
        /* A recording may have left them out. */
        if (!recorded.edges.empty() && !same_edges(recorded.edges, again.edges)) {
            change.differs.emplace_back("edges");
        }
    }
    return change;
}

void ReplaySums::add(const PoseChange &change)
{
    so_far_.compared++;
    so_far_.identical += change.identical() ? 1 : 0;
    so_far_.states_changed += change.recorded != change.again ? 1 : 0;
    if (change.both_located) {
        so_far_.both_located++;
        position_sum_mm2_ += change.position_mm * change.position_mm;
        angle_sum_deg2_ += change.angle_deg * change.angle_deg;
        so_far_.position_most_mm = std::max(so_far_.position_most_mm, change.position_mm);
        so_far_.angle_most_deg = std::max(so_far_.angle_most_deg, change.angle_deg);
    }
}

ReplayFigures ReplaySums::figures() const
{
    ReplayFigures figures = so_far_;
    if (figures.both_located > 0) {
        const auto count = static_cast<double>(figures.both_located);
        figures.position_rms_mm = std::sqrt(position_sum_mm2_ / count);
        figures.angle_rms_deg = std::sqrt(angle_sum_deg2_ / count);
    }
    return figures;
}
