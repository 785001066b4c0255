/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What one picture gave, as the fields of opms.locate/1 and opms.pose/1. */
#ifndef OPMS_JSON_LOCATION_JSON_HPP
#define OPMS_JSON_LOCATION_JSON_HPP

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>
#include <opms/locate.h>

/** "located", "absent" or "ambiguous". */
const char *json_bar_state(opms_bar_state_t state);

/** The list `squares`: index and corners. */
nlohmann::ordered_json json_squares(const opms_square_t *squares, std::size_t count);

/** Add the poses with their covariances to @p row; of a location whose state is LOCATED. */
void json_add_pose(nlohmann::ordered_json &row, const opms_location_t &location);

/** One line of JSON. Text of any bytes: what is no UTF-8 is replaced. */
std::string json_line(const nlohmann::ordered_json &row);

#endif
