/* SPDX-License-Identifier: Apache-2.0 */
#include "sensor_feed.hpp"

#include <nlohmann/json.hpp>

namespace opms_host {

std::string sensor_option_problem(const std::string &text, std::string &name, std::string &path)
{
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size()) {
        return "'" + text + "' is not NAME=FILE";
    }
    name = text.substr(0, equals);
    path = text.substr(equals + 1);
    return is_sensor_name(name)
               ? std::string()
               : "'" + name + "' is no sensor's name: 1 to 64 letters, digits, '-', '_' or '.'";
}

SensorFeed::SensorFeed(const std::string &name, const std::string &path,
                       std::int64_t begun_wall_ns)
    : name_(name), path_(path), begun_wall_ns_(begun_wall_ns), csv_(name),
      file_(path, std::ios::binary)
{
    if (!file_) {
        refuse("cannot be opened");
    }
}

void SensorFeed::refuse(const std::string &why)
{
    ++refused_;
    problem_ = "sensor " + name_ + ", " + path_ + ": " + why;
}

/** A whole line; what is written of the last one waits for its end. */
bool SensorFeed::next_line(std::string &line)
{
    file_.clear(); /* the file may have grown since its end was met */
    for (int c = file_.get(); c != std::char_traits<char>::eof(); c = file_.get()) {
        if (c != '\n') {
            skipping_ = skipping_ || partial_.size() > SENSOR_LINE_BYTES_MAX;
            if (!skipping_) {
                partial_.push_back(static_cast<char>(c));
            }
            continue;
        }
        line.swap(partial_); /* too long by one byte, if need be: the parser says so */
        partial_.clear();
        skipping_ = false;
        return true;
    }
    return false;
}

bool SensorFeed::take_line(const std::string &line, const HostClock &clock, const Take &take)
{
    SensorSample sample;
    std::string error;
    switch (csv_.take(line, sample, error)) {
    case CsvLine::nothing: return false;
    case CsvLine::error: refuse(error); return false;
    case CsvLine::sample: break;
    }
    if (sample.time == SampleTime::unix_utc && sample.t_unix_ns < begun_wall_ns_) {
        ++too_old_;
        return false;
    }
    if (taken_ == 0) { /* once is enough for a reader of the recording */
        sample.record.data_json =
            nlohmann::json{{"columns", csv_.value_names()}}.dump(
                -1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
    if (!take(place_sample(sample, clock), error)) {
        refuse(error);
        return false;
    }
    ++taken_;
    return true;
}

std::size_t SensorFeed::poll(const HostClock &clock, std::size_t most, const Take &take)
{
    std::size_t handed_over = 0;
    std::string line;
    while (file_.is_open() && handed_over < most && next_line(line)) {
        handed_over += take_line(line, clock, take) ? 1 : 0;
    }
    return handed_over;
}

}  // namespace opms_host
