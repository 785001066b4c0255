/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Sensor samples as JSON (docs/interface.md): one object, or a list of them. */
#ifndef OPMS_SENSORS_SENSOR_JSON_HPP
#define OPMS_SENSORS_SENSOR_JSON_HPP

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sensor_sample.hpp"

namespace opms_host {

constexpr std::size_t SENSOR_SAMPLES_MAX = 4096;

/** All of them or none. @return false with @p error, which names the sample. */
bool sensor_samples_from_json(const nlohmann::json &json, std::vector<SensorSample> &samples,
                              std::string &error);

}  // namespace opms_host
#endif
