/* SPDX-License-Identifier: Apache-2.0 */
#include "world_truth.hpp"

#include <algorithm>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace opms_host {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const opms::simulate::Pose &pose)
{
    ordered_json R = ordered_json::array(), t = ordered_json::array();
    for (int i = 0; i < 9; ++i) {
        R.push_back(pose.R.val[i]);
    }
    for (int i = 0; i < 3; ++i) {
        t.push_back(pose.t[i]);
    }
    return {{"R", R}, {"t_m", t}};
}

}  // namespace

WorldTruth::WorldTruth(const std::string &file, bool is_kept) : is_kept_(is_kept)
{
    if (!file.empty()) {
        file_.open(file, std::ios::trunc);
        if (!file_) {
            throw std::runtime_error(file + ": cannot be written");
        }
    }
}

/** Whole lines at once: whoever reads along, or after a kill, finds no half ones. */
void WorldTruth::write(const std::string &line)
{
    file_ << line + "\n" << std::flush;
}

void WorldTruth::add(const TrueTrigger &trigger)
{
    if (is_kept_) {
        triggers_.push_back(trigger);
    }
    if (file_.is_open()) {
        write(ordered_json{{"kind", "trigger"},
                           {"boot", trigger.boot_id},
                           {"session", trigger.session_id},
                           {"trigger", trigger.number},
                           {"run", trigger.is_run},
                           {"box_ns", trigger.box_ns},
                           {"host_ns", trigger.host_ns}}
                  .dump());
    }
}

void WorldTruth::add(const TrueRun &run)
{
    run_of_[{run.boot_id, run.session_id}] = runs_.size();
    runs_.push_back(run);
    if (file_.is_open()) {
        write(ordered_json{{"kind", "run"},
                           {"boot", run.boot_id},
                           {"session", run.session_id},
                           {"first_run_number", run.first_run_number},
                           {"start_edge_box_ns", run.start_edge_box_ns},
                           {"start_edge_host_ns", run.start_edge_host_ns}}
                  .dump());
    }
}

void WorldTruth::add(TrueFrame frame, const TruePose &pose)
{
    frame.arrival_index = arrivals_++;
    came_.resize(std::max<std::size_t>(came_.size(), frame.exposure_number + 1), false);
    frame.is_copy = came_[frame.exposure_number];
    came_[frame.exposure_number] = true;
    if (is_kept_) {
        frames_.push_back(frame);
    }
    if (!file_.is_open()) {
        return;
    }
    const TrueRun *const of = run(frame.boot_id, frame.session_id);
    ordered_json j = {{"kind", "frame"},
                      {"arrival", frame.arrival_index},
                      {"arrival_host_ns", frame.arrival_host_ns},
                      {"frame_id", frame.frame_id},
                      {"camera_time_ticks", frame.camera_time_ticks},
                      {"exposure", frame.exposure_number},
                      {"copy", frame.is_copy},
                      {"damaged", frame.is_damaged},
                      {"hidden", frame.is_hidden},
                      {"boot", frame.boot_id},
                      {"session", frame.session_id},
                      {"trigger", nullptr},
                      {"mid_host_ns", frame.mid_host_ns},
                      {"mid_box_ns", frame.mid_box_ns},
                      {"mid_scan_ns", nullptr},
                      {"picture", frame.picture},
                      {"exposure_us", frame.exposure_us},
                      {"gain_db", frame.gain_db},
                      {"light", frame.light},
                      {"ground_detector", json_of(pose.ground_detector)},
                      {"bar_camera", json_of(pose.bar_camera)},
                      {"velocity_m_s",
                       {pose.velocity_m_s[0], pose.velocity_m_s[1], pose.velocity_m_s[2]}}};
    if (frame.trigger_number != 0) {
        j["trigger"] = frame.trigger_number;
    }
    if (of) {
        j["mid_scan_ns"] = frame.mid_box_ns - of->start_edge_box_ns;
    }
    write(j.dump());
}

void WorldTruth::add_mishap(const char *what, std::int64_t host_ns, std::int64_t length_ns)
{
    if (file_.is_open()) {
        write(ordered_json{
            {"kind", "mishap"}, {"what", what}, {"host_ns", host_ns}, {"length_ns", length_ns}}
                  .dump());
    }
}

const TrueRun *WorldTruth::run(std::uint32_t boot_id, std::uint32_t session_id) const
{
    const auto found = run_of_.find({boot_id, session_id});
    return found == run_of_.end() ? nullptr : &runs_[found->second];
}

}  // namespace opms_host
