/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What really happened, for judges: in memory, and as JSON lines for those outside of the
 * process (docs/simulated.md). One thread at a time. */
#ifndef OPMS_SIMULATED_WORLD_TRUTH_HPP
#define OPMS_SIMULATED_WORLD_TRUTH_HPP

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "simulate/simulate.hpp"

namespace opms_host {

/** A pulse that left the box. */
struct TrueTrigger {
    std::uint32_t boot_id = 0, session_id = 0, number = 0;
    bool is_run = false;
    std::int64_t box_ns = 0, host_ns = 0;
};

/** A frame that reached the host. Frames are told apart by their arrival, which no two share. */
struct TrueFrame {
    std::uint64_t arrival_index = 0;   /**< from 0 */
    std::int64_t arrival_host_ns = 0;
    std::uint64_t frame_id = 0, camera_time_ticks = 0; /**< raw */
    std::uint64_t exposure_number = 0; /**< of the camera, from 1; the same for a repeated frame */
    bool is_copy = false;              /**< it came before */
    bool is_damaged = false, is_hidden = false;
    std::uint32_t boot_id = 0, session_id = 0;
    std::uint32_t trigger_number = 0;  /**< 0: no trigger exposed it */
    std::int64_t mid_host_ns = 0, mid_box_ns = 0; /**< middle of the exposure */
    std::uint32_t picture = 0;         /**< along the path */
    double exposure_us = 0, gain_db = 0, light = 1;
};

/** A run's zero of time. */
struct TrueRun {
    std::uint32_t boot_id = 0, session_id = 0, first_run_number = 0;
    std::int64_t start_edge_box_ns = 0, start_edge_host_ns = 0;
};

/** Where the camera and the detector were at the middle of an exposure. */
struct TruePose {
    opms::simulate::Pose ground_detector, bar_camera;
    cv::Vec3d velocity_m_s{0, 0, 0};
};

class WorldTruth {
public:
    /** @p file  JSON lines; empty: none. Throws std::runtime_error where it cannot be written.
     *  @p is_kept  In memory: some 200 bytes a pulse. */
    WorldTruth(const std::string &file, bool is_kept);

    void add(const TrueTrigger &trigger);
    void add(const TrueRun &run);
    void add(TrueFrame frame, const TruePose &pose);
    /** Anything that went wrong on purpose. */
    void add_mishap(const char *what, std::int64_t host_ns, std::int64_t length_ns);

    const std::vector<TrueTrigger> &triggers() const { return triggers_; }
    const std::vector<TrueFrame> &frames() const { return frames_; }
    const std::vector<TrueRun> &runs() const { return runs_; }
    /** The run of a session; NULL before its START. */
    const TrueRun *run(std::uint32_t boot_id, std::uint32_t session_id) const;

private:
    void write(const std::string &line);

    const bool is_kept_;
    std::uint64_t arrivals_ = 0;
    std::vector<TrueTrigger> triggers_;
    std::vector<TrueFrame> frames_;
    std::vector<TrueRun> runs_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> run_of_;
    std::vector<bool> came_; /**< by exposure number */
    std::ofstream file_;
};

}  // namespace opms_host
#endif
