/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A file of sensor samples that is read while it grows: `--sensor NAME=FILE.csv`.
 *
 * The owner calls poll() now and then during a scan, and makes a new feed for the next scan, which
 * reads the file from its beginning. Samples that carry the time of the world and are older than
 * the scan are passed over: a logger's file may cover a whole day. */
#ifndef OPMS_SENSORS_SENSOR_FEED_HPP
#define OPMS_SENSORS_SENSOR_FEED_HPP

#include <cstdint>
#include <fstream>
#include <functional>
#include <string>

#include "host_clock.hpp"
#include "sensor_csv.hpp"

namespace opms_host {

/** NAME=FILE of a command line. @return Empty, or what is wrong with it. */
std::string sensor_option_problem(const std::string &text, std::string &name, std::string &path);

class SensorFeed {
public:
    SensorFeed(const std::string &name, const std::string &path, std::int64_t begun_wall_ns);

    using Take = std::function<bool(SensorRecord record, std::string &error)>;
    /** Hand over what has come since the last call, at most @p most samples.
     * @return How many were handed over. */
    std::size_t poll(const HostClock &clock, std::size_t most, const Take &take);

    std::uint64_t taken() const { return taken_; }
    std::uint64_t refused() const { return refused_; } /**< lines that are wrong, samples refused */
    std::uint64_t too_old() const { return too_old_; }
    /** The newest trouble, for people; empty: none. */
    const std::string &problem() const { return problem_; }

private:
    bool next_line(std::string &line);
    bool take_line(const std::string &line, const HostClock &clock, const Take &take);
    void refuse(const std::string &why);

    std::string name_, path_;
    std::int64_t begun_wall_ns_;
    SensorCsv csv_;
    std::ifstream file_;
    std::string partial_; /* of a line whose end is not written yet */
    bool skipping_ = false; /* the rest of a line that is too long */
    std::uint64_t taken_ = 0, refused_ = 0, too_old_ = 0;
    std::string problem_;
};

}  // namespace opms_host
#endif
