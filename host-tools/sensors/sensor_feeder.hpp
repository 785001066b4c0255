/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All files of `--sensor` of a command, fed into one scan after the other. */
#ifndef OPMS_SENSORS_SENSOR_FEEDER_HPP
#define OPMS_SENSORS_SENSOR_FEEDER_HPP

#include <mutex>
#include <string>
#include <vector>

#include "sensor_feed.hpp"

namespace opms_host {

struct SensorFile {
    std::string name, path;
};

/** Calls from any thread. */
class SensorFeeder {
public:
    explicit SensorFeeder(std::vector<SensorFile> files) : files_(std::move(files)) {}

    /** Hand over what the files have got since the last call; now and then during a scan, and just
     * before it is stopped.
     * @param scan  Its name; another one than before begins the files anew, empty ends the feeding.
     * @return Troubles that have not been told yet, for people. */
    std::vector<std::string> step(const std::string &scan, const HostClock &clock,
                                  const SensorFeed::Take &take);

private:
    std::mutex mutex_;
    std::vector<SensorFile> files_;
    std::string scan_;
    std::vector<SensorFeed> feeds_;
    std::vector<std::string> told_;
};

}  // namespace opms_host
#endif
