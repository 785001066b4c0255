/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What happens in a scan, as values: the engine makes them, the recording keeps them, the console
 * and the terminal show them. Plain data; each is complete by itself.
 *
 * Times: `_host_ns` of the host's monotonic clock, `_box_ns` of the box, `_scan_ns` since the edge
 * of the hardware start, `_wall_ns` since 1970 UTC. */
#ifndef OPMS_LIVE_SCAN_RECORDS_HPP
#define OPMS_LIVE_SCAN_RECORDS_HPP

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <opms/clock.h>
#include <opms/exposure.h>
#include <opms/grid.h>
#include <opms/locate.h>
#include <opms/pair.h>
#include <opms/wire.h>

#include "frame_source.hpp"

namespace opms_host {

/** What is fixed when a scan begins. */
struct ScanHeader {
    std::string name;            /**< of its folder: date and time, or the Master's file name */
    std::int64_t begun_wall_ns = 0, begun_host_ns = 0;
    std::string mode;            /**< "position", "capture", "calibration" */
    std::string camera_file_text; /**< the whole file; empty: none */
    std::string camera_file_name;
    std::string box_name, source_name, source_model;
    bool has_box = false;
    opms_identity_report_t box_identity{};
    opms_settings_t box_settings{};
    opms_camera_profile_t camera_profile{};
    std::uint32_t boot_id = 0, session_id = 0;
    std::int32_t width_px = 0, height_px = 0;
    double bar_tilt_rad = 0;
    std::string bar;             /**< "hope33" or "apriltag33" */
    std::string versions_json;   /**< {"opms":"0.3.0","git":"...","sqlite":...} */
    std::string settings_json;   /**< all other settings of the session, for people and replays */
};

/** A pulse, by its own report, by HISTORY, or by both (two records). */
struct TriggerRecord {
    opms_trigger_report_t report{}; /**< of HISTORY: number, flags, time and strobe alone */
    bool from_history = false;
    std::int64_t arrival_host_ns = 0;
};

/** A picture that came. `number` counts the pictures of a scan from 1 and is the frame's tag in
 * opms_frame_t. */
struct FrameRecord {
    std::uint64_t number = 0;
    std::uint64_t frame_id = 0, camera_time_ticks = 0;
    std::int64_t arrival_host_ns = 0;
    std::uint32_t flags = 0;
    double exposure_us = NOT_KNOWN, gain_db = NOT_KNOWN;
    std::uint16_t white_level = 0; /**< of the picture, as in opms_image_t; so it is located anew */
};

/** A decision of the pairer. */
struct PairRecord {
    opms_pair_result_t result{};
    std::int64_t t_host_ns = 0; /**< when it was made */
};

/** A verdict on sharpness for people: see opms/blur.h where it is measured. */
enum class BlurVerdict { unknown, sharp, focus, motion, aperture };

/** What one picture gave. A pose has a time on the scan's axis only where its pair is certain. */
struct PoseRecord {
    std::uint64_t number = 0;    /**< of the frame */
    opms_frame_state_t frame_state = OPMS_FRAME_NONE; /**< as paired; NONE: without a box */
    std::uint32_t known = 0;     /**< OPMS_PAIR_HAS_... of the pair */
    std::uint64_t trigger_number = 0; /**< unwrapped; 0 where frame_state is not PAIRED */
    bool has_time = false;       /**< PAIRED, with start edge and trigger time known */
    bool is_mid_exposure = false; /**< false: t_scan_ns lacks terms that are not known */
    std::int64_t t_scan_ns = 0;  /**< mid-exposure since the start edge; before it: negative */
    std::int64_t t_host_ns = 0;  /**< the same instant on the host's clock; 0: not known */
    bool has_hint = false;       /**< the locator was given a hint: a replay gives the same one */
    opms_transform_t hint{};     /**< ... camera to bar; bit by bit */
    opms_location_t location{};
    std::vector<opms_square_t> squares;
    std::vector<opms_edge_t> edges;    /**< enough to solve again without the picture */
    std::vector<double> residuals_px;  /**< of each edge; empty where not located */
    opms_exposure_light_t light{};
    opms_exposure_command_t exposure{}; /**< what the control asked for after this picture */
    BlurVerdict blur = BlurVerdict::unknown;
    std::array<double, 2> blur_px{};   /**< across the sides along Y and along X */
    std::int64_t arrival_host_ns = 0;
    std::int64_t located_host_ns = 0;  /**< when the pose was there */
    std::int64_t published_host_ns = 0; /**< when pose and pair were there */
};

/** The calibration grid in one picture (mode calibration), for a live display. */
struct GridRecord {
    std::uint64_t number = 0; /**< of the frame; 0: no scan is going on */
    opms_grid_summary_t summary{};
    std::vector<opms_node_t> nodes;
};

enum class Severity { info, warning, error };

/** Something that a person or a program should know. `code` is stable, for programs:
 * "box.lost", "recording.full", ... (docs/live.md lists them). */
struct EventRecord {
    std::int64_t t_host_ns = 0;
    Severity severity = Severity::info;
    std::string code, text;
    std::string data_json; /**< an object, or empty */
};

/** A ping and its pong, so that a clock fit can be done again. */
struct ClockRecord {
    opms_round_trip_t trip{};
    std::int64_t wall_ns = 0; /**< at arrived_host_ns */
};

/** Status and event reports as the box sent them. */
struct BoxReportRecord {
    std::array<std::uint8_t, OPMS_WIRE_SIZE> bytes{}; /**< as opms_wire_write_...() gives them */
    std::int64_t arrival_host_ns = 0;
};

/** A sample of another sensor (metal detector, radar, radiometer), placed on the scan's axis. */
struct SensorRecord {
    std::string sensor;          /**< its name, 1 to 64 characters */
    std::uint64_t number = 0;    /**< as the sensor counts; 0: it does not */
    bool has_time = false;
    std::int64_t t_scan_ns = 0;  /**< valid where has_time */
    std::int64_t t_bound_ns = 0; /**< the time is off by no more; 0: not known */
    std::int64_t arrival_host_ns = 0;
    std::vector<double> values;
    std::string data_json;       /**< an object for all that is not a row of numbers, or empty */
};

/** How a scan ended. */
struct ScanEnd {
    std::int64_t ended_wall_ns = 0, ended_host_ns = 0;
    std::string reason;          /**< "stop", "box.rebooted", "recording.full", ... */
    bool has_summary = false;
    opms_pair_summary_t summary{}; /**< with both sums */
    SourceCounters source{};
};

}  // namespace opms_host
#endif
