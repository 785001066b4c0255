/* SPDX-License-Identifier: Apache-2.0 */
/* The camera swings about the point of the grid that it looks at, so that the grid stays in view:
 * to four sides, nearer and farther. Each such picture is foreseen, roughly; the most promising are
 * then judged by what matters, the position error over the working volume. */
#include "calibrate_advice.hpp"

#include <algorithm>
#include <cmath>

#include <opms/grid.h>
#include <opms/lens.h>

#include "expected_volume.hpp"
#include "text_table.hpp"

namespace {

constexpr double RAD = 3.14159265358979323846 / 180, CM_PER_M = 100, MM_PER_M = 1e3;
constexpr double TILTS_RAD[] = {15 * RAD, 30 * RAD, 45 * RAD};
constexpr double DISTANCES[] = {0.75, 1.0, 1.4}; /* of the first picture's */
constexpr double MIDDLE_X_M = 0.2, MIDDLE_Y_M = 0.3; /* of the grid: looked at is a point in it */
constexpr double STEEPEST_RAD = 45 * RAD, HEIGHT_LEAST_M = 0.1;
constexpr double PITCH_LEAST_PX = 15; /* the grid's lines, 2 of 25 mm, are then 1.2 px wide */
constexpr double MARKER_PITCH_LEAST_PX = 26; /* there, so that the marker itself is seen */
constexpr double BORDER_PX = 40;             /* that the marker keeps away from */
constexpr double MARKER_M = 0.006; /* its middle, in X and in Y */
constexpr int LINES_X = 16, LINES_Y = 22; /* of the grid, to either side */
constexpr int COARSE = 2;                 /* every second line is enough to rank */
constexpr uint32_t NODES_LEAST = 30;      /* of the coarse ones */
constexpr std::size_t JUDGED = 5;
constexpr double WORTH_IT = 0.9; /* of the error before, or less */
constexpr double SMALL = 0.25;   /* of the whole error: 3 % of it, for squares add */

struct Vec {
    double x, y, z;
};

Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(double s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(Vec a, Vec b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec unit(Vec a) { return 1 / std::sqrt(dot(a, a)) * a; }

/** Turned about the unit vector @p axis (Rodrigues). */
Vec turned(Vec v, Vec axis, double angle_rad)
{
    return std::cos(angle_rad) * v + std::sin(angle_rad) * cross(axis, v) +
           ((1 - std::cos(angle_rad)) * dot(axis, v)) * axis;
}

Vec column(const double *R, int i) { return {R[i], R[3 + i], R[6 + i]}; }

struct Direction {
    const char *name, *words;
    Vec side; /* of the grid's frame: where the camera goes */
};

struct Candidate {
    const Direction *direction; /* null where it leans no further */
    double tilt_rad, distance_m;
    opms_calib_foresight_t foresight;
    opms_transform_t pose;
};

class Advisor {
public:
    Advisor(const opms_calibrator_t *calibrator, uint32_t first,
            const std::vector<opms_footprint_t> &footprints)
        : calibrator_(calibrator), footprints_(footprints)
    {
        opms_calib_picture_t picture;
        opms_calibrator_picture(calibrator, first, &picture, nullptr);
        base_ = picture.target_camera.transform;
        look_from_base();
        fill_nodes(coarse_, COARSE);
        fill_nodes(all_, 1);
    }

    std::optional<CalibrateAdvice> best()
    {
        std::vector<Candidate> candidates = all_candidates();
        if (candidates.empty()) {
            return std::nullopt;
        }
        std::stable_sort(candidates.begin(), candidates.end(),
                         [](const Candidate &a, const Candidate &b) {
                             return a.foresight.gain > b.foresight.gain;
                         });
        candidates.resize(std::min(candidates.size(), JUDGED));
        const Candidate *best = nullptr;
        double least = HUGE_VAL;
        for (Candidate &candidate : candidates) {
            foresee(candidate, all_);
            const double error = error_of(candidate.foresight);
            if (error < least) {
                least = error;
                best = &candidate;
            }
        }
        return best ? std::optional<CalibrateAdvice>(advice_of(*best)) : std::nullopt;
    }

private:
    void fill_nodes(std::vector<double> &nodes, int step)
    {
        for (int i = -LINES_X; i <= LINES_X; i += step) {
            for (int j = -LINES_Y; j <= LINES_Y; j += step) {
                nodes.push_back(i * OPMS_GRID_PITCH_M);
                nodes.push_back(j * OPMS_GRID_PITCH_M);
            }
        }
    }

    /** Point looked at, distance, and the four sides. */
    void look_from_base()
    {
        const Vec eye = {base_.t_m[0], base_.t_m[1], base_.t_m[2]}, axis = column(base_.R, 2);
        const Vec hit = eye - (eye.z / axis.z) * axis;
        target_ = {std::clamp(hit.x, -MIDDLE_X_M, MIDDLE_X_M),
                   std::clamp(hit.y, -MIDDLE_Y_M, MIDDLE_Y_M), 0};
        distance_m_ = std::sqrt(dot(eye - target_, eye - target_));
        opms_camera_t camera = {};
        on_detector_ = !footprints_.empty() &&
                       opms_calibrator_camera(calibrator_, footprints_.data(),
                                              static_cast<uint32_t>(footprints_.size()), &camera,
                                              nullptr) == OPMS_OK;
        if (on_detector_) {
            set_detector_sides(camera.detector_camera.R);
        } else {
            const Vec right = column(base_.R, 0), down = column(base_.R, 1);
            sides_ = {{"left", "to the left of the picture", -1 * right},
                      {"right", "to the right of the picture", right},
                      {"up", "to the top of the picture", -1 * down},
                      {"down", "to the bottom of the picture", down}};
        }
        now_ = view_nothing();
    }

    /** The detector's X and Y in the grid: the rotation's columns are R_gc R_dc^T. */
    void set_detector_sides(const double *R_dc)
    {
        const auto axis = [&](int row) {
            return R_dc[3 * row] * column(base_.R, 0) + R_dc[3 * row + 1] * column(base_.R, 1) +
                   R_dc[3 * row + 2] * column(base_.R, 2);
        };
        const Vec operator_side = axis(0), right = axis(1);
        sides_ = {{"left", "to the left", -1 * right},
                  {"right", "to the right", right},
                  {"back", "back towards you", operator_side},
                  {"ahead", "forward, away from you", -1 * operator_side}};
    }

    /** The camera as it is known now. */
    opms_calib_foresight_t view_nothing() const
    {
        const double nowhere[2] = {1e5, 1e5};
        opms_calib_foresight_t foresight = {};
        opms_calib_view_t view = view_of(base_, nowhere, 1);
        opms_calibrator_foresee(calibrator_, &view, &foresight, nullptr);
        return foresight;
    }

    opms_calib_view_t view_of(const opms_transform_t &pose, const double *nodes,
                              std::size_t count) const
    {
        opms_calib_view_t view = {};
        view.target_camera = pose;
        view.target_m = nodes;
        view.count = static_cast<uint32_t>(count);
        view.footprints = footprints_.data();
        view.footprint_count = on_detector_ ? static_cast<uint32_t>(footprints_.size()) : 0;
        return view;
    }

    opms_transform_t swung(const Direction *direction, double tilt_rad, double distance_m) const
    {
        const Vec eye = {base_.t_m[0], base_.t_m[1], base_.t_m[2]};
        const Vec out = unit(eye - target_);
        Vec axes[3] = {column(base_.R, 0), column(base_.R, 1), column(base_.R, 2)};
        Vec away = out;
        if (direction) {
            const Vec about = unit(cross(out, direction->side));
            away = turned(out, about, tilt_rad);
            for (Vec &axis : axes) {
                axis = turned(axis, about, tilt_rad);
            }
        }
        const Vec t = target_ + distance_m * away;
        return {{axes[0].x, axes[1].x, axes[2].x, axes[0].y, axes[1].y, axes[2].y, axes[0].z,
                 axes[1].z, axes[2].z},
                {t.x, t.y, t.z}};
    }

    bool is_possible(const opms_transform_t &pose) const
    {
        double px[2];
        const opms_lens_t &lens = now_.camera.lens;
        return pose.t_m[2] >= HEIGHT_LEAST_M && -pose.R[8] >= std::cos(STEEPEST_RAD) &&
               look(pose, MARKER_M, MARKER_M, px) && px[0] > BORDER_PX && px[1] > BORDER_PX &&
               px[0] < lens.width_px - BORDER_PX && px[1] < lens.height_px - BORDER_PX &&
               least_pitch_px(pose, MARKER_M, MARKER_M) >= MARKER_PITCH_LEAST_PX;
    }

    /** From a place of the grid to the next line, the shorter way; 0 where it is not seen. */
    double least_pitch_px(const opms_transform_t &pose, double x, double y) const
    {
        double at[2], along_x[2], along_y[2];
        const bool seen = look(pose, x, y, at) && look(pose, x + OPMS_GRID_PITCH_M, y, along_x) &&
                          look(pose, x, y + OPMS_GRID_PITCH_M, along_y);
        return seen ? std::min(std::hypot(along_x[0] - at[0], along_x[1] - at[1]),
                               std::hypot(along_y[0] - at[0], along_y[1] - at[1]))
                    : 0;
    }

    bool look(const opms_transform_t &pose, double x_m, double y_m, double *px) const
    {
        const Vec offset = Vec{x_m, y_m, 0} - Vec{pose.t_m[0], pose.t_m[1], pose.t_m[2]};
        const double point[3] = {dot(offset, column(pose.R, 0)), dot(offset, column(pose.R, 1)),
                                 dot(offset, column(pose.R, 2))};
        return opms_lens_project(&now_.camera.lens, point, px, nullptr, nullptr, nullptr) ==
               OPMS_OK;
    }

    /** Those at which the lines are wide enough to be found. */
    std::vector<double> readable(const opms_transform_t &pose,
                                 const std::vector<double> &nodes) const
    {
        std::vector<double> kept;
        for (std::size_t i = 0; i < nodes.size(); i += 2) {
            const double x = nodes[i], y = nodes[i + 1];
            if (least_pitch_px(pose, x, y) >= PITCH_LEAST_PX) {
                kept.insert(kept.end(), {x, y});
            }
        }
        return kept;
    }

    bool foresee(Candidate &candidate, const std::vector<double> &all) const
    {
        const std::vector<double> nodes = readable(candidate.pose, all);
        if (nodes.empty()) {
            return false;
        }
        const opms_calib_view_t view = view_of(candidate.pose, nodes.data(), nodes.size() / 2);
        return opms_calibrator_foresee(calibrator_, &view, &candidate.foresight, nullptr) ==
                   OPMS_OK &&
               candidate.foresight.points >= NODES_LEAST;
    }

    std::vector<Candidate> all_candidates() const
    {
        std::vector<Candidate> candidates;
        const auto consider = [&](const Direction *direction, double tilt_rad, double distance_m) {
            Candidate candidate{direction, tilt_rad, distance_m, {},
                                swung(direction, tilt_rad, distance_m)};
            if (is_possible(candidate.pose) && foresee(candidate, coarse_)) {
                candidates.push_back(candidate);
            }
        };
        for (const double part : DISTANCES) {
            consider(nullptr, 0, part * distance_m_);
            for (const Direction &direction : sides_) {
                for (const double tilt_rad : TILTS_RAD) {
                    consider(&direction, tilt_rad, part * distance_m_);
                }
            }
        }
        return candidates;
    }

    /** Of positions, in m; without a footprint what is left of the lens's variances. */
    double error_of(const opms_calib_foresight_t &foresight) const
    {
        if (!on_detector_) {
            return -foresight.gain;
        }
        ExpectedBox box = expected_working_volume();
        box.steps[0] = box.steps[1] = 3;
        box.steps[2] = 1;
        const ExpectedError error = expected_over(foresight.camera, foresight.camera, box);
        return error.places_seen > 0 ? error.lens.position_rms_m() : HUGE_VAL;
    }

    CalibrateAdvice advice_of(const Candidate &best) const
    {
        CalibrateAdvice advice;
        advice.towards = best.direction ? best.direction->name : "";
        advice.tilt_rad = best.tilt_rad;
        advice.distance_m = best.distance_m;
        advice.grid_camera = best.pose;
        advice.nodes = best.foresight.points;
        advice.gain = best.foresight.gain;
        if (on_detector_) {
            advice.now_m = error_of(now_);
            advice.then_m = error_of(best.foresight);
        }
        advice.how = how(best);
        return advice;
    }

    std::string how(const Candidate &best) const
    {
        const double tilt_deg = best.tilt_rad / RAD;
        const std::string lean =
            !best.direction ? "held as in the first picture"
                            : text_format(on_detector_ ? "leaning %s by %.0f degrees"
                                                       : "swung %s by %.0f degrees",
                                          best.direction->words, tilt_deg);
        return std::string(on_detector_ ? "the detector " : "the camera ") + lean +
               text_format(", the camera about %.0f cm from the middle of the grid and looking at "
                           "it", CM_PER_M * best.distance_m);
    }

    const opms_calibrator_t *calibrator_;
    const std::vector<opms_footprint_t> &footprints_;
    opms_transform_t base_ = {};
    Vec target_ = {0, 0, 0};
    double distance_m_ = 0;
    bool on_detector_ = false;
    std::vector<Direction> sides_;
    std::vector<double> coarse_, all_;
    opms_calib_foresight_t now_ = {};
};

}  // namespace

std::optional<CalibrateAdvice> calibrate_advice(const opms_calibrator_t *calibrator,
                                                uint32_t first,
                                                const std::vector<opms_footprint_t> &footprints)
{
    return Advisor(calibrator, first, footprints).best();
}

std::string calibrate_advice_words(const CalibrateAdvice &advice, std::optional<double> total_m)
{
    if (!advice.now_m || !advice.then_m) {
        return "take another picture with " + advice.how + ".";
    }
    if (total_m && *advice.now_m < SMALL * *total_m) {
        return text_format("no further picture is needed: the lens's part of the position error, "
                           "%.2f mm, is small beside the %.2f mm of all together.",
                           MM_PER_M * *advice.now_m, MM_PER_M * *total_m);
    }
    const std::string effect =
        text_format("the lens's part of the position error from %.3f to %.3f mm.",
                    MM_PER_M * *advice.now_m, MM_PER_M * *advice.then_m);
    return *advice.then_m <= WORTH_IT * *advice.now_m
               ? "take another picture with " + advice.how + ": it would lower " + effect
               : "more pictures would hardly help. The best one, with " + advice.how +
                     ", would lower " + effect;
}
