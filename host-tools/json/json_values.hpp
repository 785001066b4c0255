/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Numbers of libopms as JSON, in the form of every schema of the program. */
#ifndef OPMS_JSON_VALUES_HPP
#define OPMS_JSON_VALUES_HPP

#include <vector>

#include <nlohmann/json.hpp>
#include <opms/types.h>

inline nlohmann::ordered_json json_vector(const double *values, int count)
{
    return nlohmann::ordered_json(std::vector<double>(values, values + count));
}

/** A list of rows, from row-major values. */
inline nlohmann::ordered_json json_matrix(const double *values, int rows, int cols)
{
    auto matrix = nlohmann::ordered_json::array();
    for (int r = 0; r < rows; r++) {
        matrix.push_back(json_vector(values + r * cols, cols));
    }
    return matrix;
}

inline nlohmann::ordered_json json_lens(const opms_lens_t &lens)
{
    return {{"fx_px", lens.fx_px}, {"fy_px", lens.fy_px}, {"cx_px", lens.cx_px},
            {"cy_px", lens.cy_px}, {"k1", lens.k1},       {"k2", lens.k2},
            {"p1", lens.p1},       {"p2", lens.p2}};
}

#endif
