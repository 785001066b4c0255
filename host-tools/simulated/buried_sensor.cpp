/* SPDX-License-Identifier: Apache-2.0 */
#include "buried_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace opms_host {

namespace {

constexpr double COIL_RADIUS_M = 0.1, NEAR_M = 0.05;
constexpr double BOUND_S = 0.0005;

}  // namespace

double buried_response(const std::vector<BuriedObject> &objects,
                       const opms::simulate::Pose &ground_detector)
{
    double sum = 0;
    for (const BuriedObject &object : objects) {
        const cv::Vec3d to =
            cv::Vec3d(object.x_m, object.y_m, object.z_m) - ground_detector.t;
        const double above = NEAR_M - object.z_m, coil = COIL_RADIUS_M * COIL_RADIUS_M;
        sum += object.strength * std::pow((coil + above * above) / (coil + to.dot(to)), 3);
    }
    return sum;
}

BuriedSensor::BuriedSensor(const WorldOptions &options, const DetectorPath &path,
                           double path_s_of_run, double delay_s)
    : options_(options), path_(path), path_s_of_run_(path_s_of_run), delay_s_(delay_s),
      random_(options.seed, Chance::sensor)
{
    if (!options_.sensor_file.empty()) {
        write_head();
    }
}

void BuriedSensor::write_head()
{
    file_ = std::ofstream(options_.sensor_file, std::ios::trunc);
    file_ << "t_scan_s,t_bound_s,number,response\n" << std::flush;
    if (!file_) {
        throw std::runtime_error(options_.sensor_file + ": cannot be written");
    }
}

void BuriedSensor::run_began()
{
    if (samples_ > 0) {
        write_head();
    }
    samples_ = 0;
}

void BuriedSensor::advance_to(double run_s)
{
    if (!file_.is_open()) {
        return;
    }
    for (; static_cast<double>(samples_) / options_.sensor_hz < run_s; ++samples_) {
        const double t_s = static_cast<double>(samples_) / options_.sensor_hz;
        const double path_s = std::max(0.0, t_s - delay_s_) * path_s_of_run_;
        const double response = buried_response(options_.buried, path_.at(path_s).ground_detector) +
                                options_.sensor_noise * random_.normal();
        char line[96];
        std::snprintf(line, sizeof line, "%.6f,%.4f,%llu,%.6f\n", t_s, BOUND_S,
                      static_cast<unsigned long long>(samples_ + 1), response);
        file_ << line;
    }
    file_ << std::flush;
}

}  // namespace opms_host
