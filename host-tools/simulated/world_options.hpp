/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How a simulated world is made and what goes wrong in it. docs/simulated.md explains each. */
#ifndef OPMS_SIMULATED_WORLD_OPTIONS_HPP
#define OPMS_SIMULATED_WORLD_OPTIONS_HPP

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace opms_host {

/** Kinds of faults that hit one of many like events, in bursts. */
enum class Fault {
    report_lost, report_late, report_repeated, report_overtaken, report_damaged, history_lost,
    strobe_unseen, trigger_ignored, frame_extra, id_skip, id_reset, frame_lost, frame_late,
    frame_repeated, frame_stale, frame_damaged, ping_held, COUNT
};
constexpr std::size_t FAULT_KINDS = static_cast<std::size_t>(Fault::COUNT);

/** "report_lost", ...: as the truth file has it. */
const char *fault_name(Fault fault);

/** Things that happen once in a while, to all of the world. */
enum class Mishap { box_unplug, box_reboot, camera_restart, host_stall, hide_bar, glitch, COUNT };
constexpr std::size_t MISHAP_KINDS = static_cast<std::size_t>(Mishap::COUNT);

const char *mishap_name(Mishap mishap);

struct FaultRates {
    std::array<double, FAULT_KINDS> share{};          /**< of its events, 0 to 0.5 */
    std::array<double, MISHAP_KINDS> mean_interval_s{}; /**< 0: never */
    bool extra_first_frame = false;  /**< one frame without a trigger whenever the stream starts */

    double &operator[](Fault fault) { return share[static_cast<std::size_t>(fault)]; }
    double operator[](Fault fault) const { return share[static_cast<std::size_t>(fault)]; }
    double &operator[](Mishap mishap) { return mean_interval_s[static_cast<std::size_t>(mishap)]; }
    double operator[](Mishap mishap) const
    {
        return mean_interval_s[static_cast<std::size_t>(mishap)];
    }
    static FaultRates none() { return {}; }
    /** What a bad day in the field brings. */
    static FaultRates some();
    /** Far more than that. */
    static FaultRates many();
};

/** A mishap at a known time of the run. */
struct PlannedMishap {
    Mishap what = Mishap::hide_bar;
    double at_s = 0, length_s = 1; /**< since START's edge, by the host's clock */
};

/** Light that changes at a known time of the run and stays so. */
struct LightStep {
    double at_s = 0, ev = 0; /**< EV of the light from then on; 0: as at the start */
};

/** A thing in the ground that the simulated metal detector finds; ground frame, z down is < 0. */
struct BuriedObject {
    double x_m = 0, y_m = 0, z_m = -0.05;
    double strength = 1; /**< response right above at the head's height of 0.05 m plus depth */
};

constexpr double EXPOSURE_MIN_US = 10, EXPOSURE_MAX_US = 20000, GAIN_MAX_DB = 24;

enum class PictureMode {
    rendered, /**< `frames` different ones, rendered beforehand */
    lazy,     /**< the same, but rendered while the scan goes on */
    blank     /**< one constant picture: for soaks of the pairing */
};

struct WorldOptions {
    double speed = 1;          /**< of time; 0: as fast as the consumers take */
    std::uint64_t seed = 1;
    // The box.
    double box_drift_ppm = 12;
    std::uint32_t ping_interval_ms = 500;
    double start_after_s = 0;  /**< press START this long after WAITING; 0: nobody does */
    std::uint32_t period_us = 0; /**< in the box's settings at the beginning; 0: its default */
    bool strobe = true;        /**< the camera's exposure output is wired and enabled */
    // The camera.
    std::string camera_file;   /**< empty: the default camera of the renderer */
    double camera_drift_ppm = -23;
    std::uint64_t camera_tick_hz = 1'000'000'000;
    bool camera_time = true;   /**< frames bring the camera's time */
    std::uint32_t frame_id_bits = 16; /**< 16: skips 0 at the wrap, as GigE Vision; or 64 */
    std::uint64_t first_frame_id = 1;
    double start_delay_us = 30, readout_ms = 12, transport_jitter_ms = 2;
    double exposure_us = 1000; /**< at the beginning; the look's levels are those of it */
    double gain_db = 0;
    std::uint32_t exposure_delay_frames = 2; /**< from set_exposure() to the first such frame */
    // Pictures.
    PictureMode pictures = PictureMode::rendered;
    std::uint32_t frames = 100; /**< different ones; the path repeats after so many pulses */
    std::string cache_folder;  /**< rendered light is kept there; empty: it is not */
    double path_period_s = 0;  /**< of one pulse along the path; 0: the box's period */
    double max_speed_m_s = 1;
    std::string bar = "hope33";
    double bar_tilt_deg = 0;
    double noise = 3;          /**< standard deviation in grey levels at 0 dB */
    double white = 190, black = 40;
    // Light.
    double clouds_ev = 0;      /**< the light wanders by about plus or minus this */
    std::vector<LightStep> light_steps;
    // What goes wrong.
    FaultRates faults;
    std::vector<PlannedMishap> planned;
    // Truth and ground.
    std::string truth_file;    /**< JSON lines; empty: none */
    bool keep_truth = true;    /**< in memory, too, for SimulatedWorld's calls */
    std::vector<BuriedObject> buried;
    std::string sensor_file;   /**< table of the metal detector over them; empty: none */
    double sensor_hz = 50, sensor_noise = 0.01;
};

/** @return Empty, or what is wrong with them, for people. */
std::string world_options_problem(const WorldOptions &options);

}  // namespace opms_host
#endif
