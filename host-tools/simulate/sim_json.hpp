/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Poses in JSON: "R_a_b" as three rows, "t_a_b_m" as three numbers. */
#ifndef OPMS_SIMULATE_SIM_JSON_HPP
#define OPMS_SIMULATE_SIM_JSON_HPP

#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "simulate/simulate.hpp"

namespace opms::simulate
{

inline nlohmann::ordered_json to_json(const cv::Matx33d &R)
{
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (int i = 0; i < 3; ++i) {
        rows.push_back({R(i, 0), R(i, 1), R(i, 2)});
    }
    return rows;
}

inline nlohmann::ordered_json to_json(const cv::Vec3d &t)
{
    return {t[0], t[1], t[2]};
}

/** Throws std::runtime_error or nlohmann's own errors where something is missing or no rotation. */
inline Pose pose_from_json(const nlohmann::json &item, const std::string &frames)
{
    Pose pose;
    const nlohmann::json &R = item.at("R_" + frames), &t = item.at("t_" + frames + "_m");
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            pose.R(static_cast<int>(i), static_cast<int>(j)) = R.at(i).at(j).get<double>();
        }
        pose.t[static_cast<int>(i)] = t.at(i).get<double>();
    }
    if (!(cv::norm(pose.R * pose.R.t() - cv::Matx33d::eye()) < 1e-6) ||
        cv::determinant(pose.R) < 0) {
        throw std::runtime_error("R_" + frames + " is no rotation");
    }
    return pose;
}

} // namespace opms::simulate
#endif
