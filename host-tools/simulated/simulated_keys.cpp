/* SPDX-License-Identifier: Apache-2.0 */
/* The keys of "simulated:key=value,...". */
#include "simulated_factory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <sstream>
#include <vector>

namespace opms_host {

namespace {

/** Sets what a key means. @return Empty, or what is wrong with the value. */
using Setter = std::function<std::string(WorldOptions &, const std::string &)>;

struct Key {
    std::string name, help;
    Setter set;
};

bool read_number(const std::string &text, double &value)
{
    char *end = nullptr;
    value = std::strtod(text.c_str(), &end);
    return !text.empty() && end == text.c_str() + text.size() && std::isfinite(value);
}

std::vector<std::string> split(const std::string &text, char by)
{
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, by);) {
        parts.push_back(part);
    }
    return parts;
}

Setter number(double WorldOptions::*field)
{
    return [field](WorldOptions &options, const std::string &text) -> std::string {
        return read_number(text, options.*field) ? "" : "is no number";
    };
}

template <typename Whole> Setter whole(Whole WorldOptions::*field)
{
    return [field](WorldOptions &options, const std::string &text) -> std::string {
        double value = 0;
        const double most = std::min(9e15, static_cast<double>(std::numeric_limits<Whole>::max()));
        if (!read_number(text, value) || value < 0 || value > most || value != std::floor(value)) {
            return "is no whole number of at least 0";
        }
        options.*field = static_cast<Whole>(value);
        return {};
    };
}

Setter words(std::string WorldOptions::*field)
{
    return [field](WorldOptions &options, const std::string &text) -> std::string {
        options.*field = text;
        return text.empty() ? "is empty" : "";
    };
}

Setter yes_or_no(bool WorldOptions::*field)
{
    return [field](WorldOptions &options, const std::string &text) -> std::string {
        options.*field = text == "1";
        return text == "0" || text == "1" ? "" : "must be 0 or 1";
    };
}

std::string set_rate(WorldOptions &options, const std::string &text)
{
    double hz = 0;
    if (!read_number(text, hz) || hz < 0.1 || hz > 100) {
        return "must be 0.1 to 100";
    }
    options.period_us = static_cast<std::uint32_t>(std::lround(1e6 / hz));
    return {};
}

std::string set_pictures(WorldOptions &options, const std::string &text)
{
    options.pictures = text == "blank"  ? PictureMode::blank
                       : text == "lazy" ? PictureMode::lazy
                                        : PictureMode::rendered;
    return text == "blank" || text == "lazy" || text == "rendered"
               ? ""
               : "must be rendered, lazy or blank";
}

std::string set_faults(WorldOptions &options, const std::string &text)
{
    options.faults = text == "many"   ? FaultRates::many()
                     : text == "some" ? FaultRates::some()
                                      : FaultRates::none();
    return text == "none" || text == "some" || text == "many" ? "" : "must be none, some or many";
}

std::string set_light(WorldOptions &options, const std::string &text)
{
    for (const std::string &part : split(text, '/')) {
        const std::vector<std::string> fields = split(part, ':');
        LightStep step;
        if (fields.size() != 2 || !read_number(fields[0], step.at_s) || step.at_s < 0 ||
            !read_number(fields[1], step.ev) || std::abs(step.ev) > 8) {
            return "must be SECONDS:EV[/SECONDS:EV...], EV within 8";
        }
        options.light_steps.push_back(step);
    }
    return {};
}

std::string set_buried(WorldOptions &options, const std::string &text)
{
    for (const std::string &part : split(text, '/')) {
        const std::vector<std::string> fields = split(part, ':');
        BuriedObject object;
        const bool reads = (fields.size() == 3 || fields.size() == 4) &&
                           read_number(fields[0], object.x_m) &&
                           read_number(fields[1], object.y_m) &&
                           read_number(fields[2], object.z_m) &&
                           (fields.size() < 4 || read_number(fields[3], object.strength));
        if (!reads || object.z_m > 0) {
            return "must be X:Y:Z[:STRENGTH][/...] in m, Z not above 0";
        }
        options.buried.push_back(object);
    }
    return {};
}

Setter mishap(Mishap what)
{
    return [what](WorldOptions &options, const std::string &text) -> std::string {
        for (const std::string &part : split(text, '/')) {
            const std::vector<std::string> fields = split(part, '+');
            PlannedMishap planned;
            planned.what = what;
            if (fields.empty() || fields.size() > 2 || !read_number(fields[0], planned.at_s) ||
                planned.at_s < 0 ||
                (fields.size() == 2 && !read_number(fields[1], planned.length_s)) ||
                planned.length_s < 0) {
                return "must be AT[+LENGTH][/...] in seconds of the run";
            }
            options.planned.push_back(planned);
        }
        return {};
    };
}

Setter fault_share(Fault fault)
{
    return [fault](WorldOptions &options, const std::string &text) -> std::string {
        return read_number(text, options.faults[fault]) ? "" : "is no number";
    };
}

std::vector<Key> plain_keys()
{
    using W = WorldOptions;
    return {
        {"speed", "of time: 1 real, N as fast, 0 as fast as the consumers take", number(&W::speed)},
        {"seed", "of all chance", whole(&W::seed)},
        {"hz", "pulse rate in the box's settings at the beginning", set_rate},
        {"start_after", "press START so many s after WAITING; 0: nobody does",
         number(&W::start_after_s)},
        {"box_drift_ppm", "of the box's quartz", number(&W::box_drift_ppm)},
        {"ping_ms", "from ping to ping", whole(&W::ping_interval_ms)},
        {"strobe", "0: the camera's exposure output is not wired", yes_or_no(&W::strobe)},
        {"camera", "camera file (docs/camera-file.md)", words(&W::camera_file)},
        {"camera_drift_ppm", "of the camera's quartz", number(&W::camera_drift_ppm)},
        {"camera_time", "0: frames bring no time", yes_or_no(&W::camera_time)},
        {"tick_hz", "of the camera's time", whole(&W::camera_tick_hz)},
        {"id_bits", "16 (skips 0) or 64", whole(&W::frame_id_bits)},
        {"first_id", "frame id at the start of the stream", whole(&W::first_frame_id)},
        {"start_delay_us", "trigger to exposure", number(&W::start_delay_us)},
        {"readout_ms", "end of the exposure to arrival, at least", number(&W::readout_ms)},
        {"jitter_ms", "... and at most so much more", number(&W::transport_jitter_ms)},
        {"exposure_us", "at the beginning", number(&W::exposure_us)},
        {"gain_db", "at the beginning", number(&W::gain_db)},
        {"exposure_delay", "frames until a command acts", whole(&W::exposure_delay_frames)},
        {"pictures", "rendered (beforehand), lazy or blank", set_pictures},
        {"frames", "different pictures; then the path repeats", whole(&W::frames)},
        {"cache", "folder that keeps what was rendered", words(&W::cache_folder)},
        {"path_period", "s of the path for each pulse; 0: the box's period",
         number(&W::path_period_s)},
        {"max_speed", "m/s of the detector", number(&W::max_speed_m_s)},
        {"bar", "hope33 or apriltag33", words(&W::bar)},
        {"tilt_deg", "of the bar", number(&W::bar_tilt_deg)},
        {"noise", "grey levels at 0 dB", number(&W::noise)},
        {"white", "grey level of the bar's paper", number(&W::white)},
        {"black", "grey level of its ink", number(&W::black)},
        {"clouds", "the light wanders by so many EV", number(&W::clouds_ev)},
        {"light", "SECONDS:EV[/...] of the run: steps of the light", set_light},
        {"buried", "X:Y:Z[:STRENGTH][/...] in m: what the metal detector finds", set_buried},
        {"sensor", "file for the metal detector's samples (opms scan --sensor NAME=FILE)",
         words(&W::sensor_file)},
        {"sensor_hz", "samples a second", number(&W::sensor_hz)},
        {"sensor_noise", "standard deviation of a sample", number(&W::sensor_noise)},
        {"faults", "none, some or many, at random", set_faults},
        {"truth", "file for what really happened, JSON lines", words(&W::truth_file)}};
}

const std::vector<Key> &keys()
{
    static const std::vector<Key> ALL = [] {
        std::vector<Key> all = plain_keys();
        for (std::size_t i = 0; i < MISHAP_KINDS; ++i) {
            const auto what = static_cast<Mishap>(i);
            all.push_back({mishap_name(what), "AT[+LENGTH][/...] in s of the run", mishap(what)});
        }
        for (std::size_t i = 0; i < FAULT_KINDS; ++i) {
            const auto fault = static_cast<Fault>(i);
            all.push_back({fault_name(fault), "share, 0 to 0.5; after `faults`",
                           fault_share(fault)});
        }
        return all;
    }();
    return ALL;
}

std::string set_key(const std::string &name, const std::string &value, WorldOptions &options)
{
    for (const Key &key : keys()) {
        if (key.name == name) {
            const std::string problem = key.set(options, value);
            return problem.empty() ? "" : "simulated: " + name + "=" + value + " " + problem;
        }
    }
    return "simulated: there is no key " + name + " (docs/simulated.md lists them)";
}

}  // namespace

std::string simulated_options_parse(const std::string &text, WorldOptions &options)
{
    for (const std::string &part : split(text, ',')) {
        const std::size_t equals = part.find('=');
        if (equals == std::string::npos) {
            return "simulated: \"" + part + "\" is not of the form key=value";
        }
        const std::string problem =
            set_key(part.substr(0, equals), part.substr(equals + 1), options);
        if (!problem.empty()) {
            return problem;
        }
    }
    return {};
}

std::string simulated_options_help()
{
    std::string help;
    for (const Key &key : keys()) {
        help += key.name + std::string(key.name.size() < 18 ? 18 - key.name.size() : 1, ' ') +
                key.help + "\n";
    }
    return help;
}

}  // namespace opms_host
