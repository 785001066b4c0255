/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_json.hpp"

namespace opms_host {

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t NUMBER_MAX = std::uint64_t(1) << 53; /* what any JSON reader counts to */
constexpr std::size_t DATA_BYTES_MAX = 65536;

bool read_name(const Json &value, SensorSample &sample, std::string &error)
{
    if (!value.is_string() || !is_sensor_name(value.get_ref<const std::string &>())) {
        error = "\"sensor\" must be 1 to 64 letters, digits, '-', '_' or '.'";
        return false;
    }
    sample.record.sensor = value.get<std::string>();
    return true;
}

bool read_time(const Json &value, SampleTime time, SensorSample &sample, std::string &error)
{
    const bool is_unix = time == SampleTime::unix_utc;
    if (sample.time != SampleTime::arrival) {
        error = "\"t_scan_s\" and \"t_unix_s\" exclude each other";
        return false;
    }
    sample.time = time;
    std::int64_t &ns = is_unix ? sample.t_unix_ns : sample.record.t_scan_ns;
    if (!value.is_number() || !sample_time_ns(value.get<double>(), is_unix, ns)) {
        error = is_unix ? "\"t_unix_s\" must be seconds since 1970"
                        : "\"t_scan_s\" must be seconds since the start, within 1e7";
        return false;
    }
    return true;
}

bool read_bound(const Json &value, SensorSample &sample, std::string &error)
{
    if (!value.is_number() || value.get<double>() < 0 ||
        !sample_time_ns(value.get<double>(), false, sample.record.t_bound_ns)) {
        error = "\"t_bound_s\" must be seconds, not negative";
        return false;
    }
    return true;
}

bool read_number(const Json &value, SensorSample &sample, std::string &error)
{
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > NUMBER_MAX) {
        error = "\"number\" must be a whole number from 0 to 2^53";
        return false;
    }
    sample.record.number = value.get<std::uint64_t>();
    return true;
}

bool read_values(const Json &value, SensorSample &sample, std::string &error)
{
    if (!value.is_array() || value.size() > SENSOR_VALUES_MAX) {
        error = "\"values\" must be a list of at most 4096 numbers";
        return false;
    }
    for (const Json &item : value) {
        if (!item.is_number()) {
            error = "\"values\" may hold numbers only";
            return false;
        }
        sample.record.values.push_back(item.get<double>());
    }
    return true;
}

bool read_data(const Json &value, SensorSample &sample, std::string &error)
{
    if (!value.is_object()) {
        error = "\"data\" must be an object";
        return false;
    }
    sample.record.data_json = value.dump();
    if (sample.record.data_json.size() > DATA_BYTES_MAX) {
        error = "\"data\" is longer than 65536 bytes";
        return false;
    }
    return true;
}

bool read_field(const std::string &key, const Json &value, SensorSample &sample,
                std::string &error)
{
    if (key == "sensor") {
        return read_name(value, sample, error);
    }
    if (key == "t_scan_s") {
        return read_time(value, SampleTime::scan, sample, error);
    }
    if (key == "t_unix_s") {
        return read_time(value, SampleTime::unix_utc, sample, error);
    }
    if (key == "t_bound_s") {
        return read_bound(value, sample, error);
    }
    if (key == "number") {
        return read_number(value, sample, error);
    }
    if (key == "values") {
        return read_values(value, sample, error);
    }
    if (key == "data") {
        return read_data(value, sample, error);
    }
    error = "there is no field \"" + key.substr(0, 40) + "\"";
    return false;
}

bool read_sample(const Json &json, SensorSample &sample, std::string &error)
{
    if (!json.is_object()) {
        error = "is not an object";
        return false;
    }
    for (const auto &[key, value] : json.items()) {
        if (!read_field(key, value, sample, error)) {
            return false;
        }
    }
    if (sample.record.sensor.empty()) {
        error = "\"sensor\" is missing";
        return false;
    }
    if (sample.record.values.empty() && sample.record.data_json.empty()) {
        error = "has neither \"values\" nor \"data\"";
        return false;
    }
    return true;
}

}  // namespace

bool sensor_samples_from_json(const Json &json, std::vector<SensorSample> &samples,
                              std::string &error)
{
    samples.clear();
    if (!json.is_object() && !json.is_array()) {
        error = "a sample (an object) or a list of samples is needed";
        return false;
    }
    if (json.is_array() && (json.empty() || json.size() > SENSOR_SAMPLES_MAX)) {
        error = "a list holds 1 to " + std::to_string(SENSOR_SAMPLES_MAX) + " samples";
        return false;
    }
    const std::size_t count = json.is_array() ? json.size() : 1;
    std::vector<SensorSample> all(count);
    for (std::size_t i = 0; i < count; i++) {
        std::string problem;
        if (!read_sample(json.is_array() ? json[i] : json, all[i], problem)) {
            error = "sample " + std::to_string(i) + ": " + problem;
            return false;
        }
    }
    samples = std::move(all);
    return true;
}

}  // namespace opms_host
