/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A simulated world that a test goes through in one thread, with a host that reads all there is. */
#ifndef WORLD_SCENE_HPP
#define WORLD_SCENE_HPP

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <opms/pair.h>

#include "simulated_factory.hpp"
#include "simulated_world.hpp"

constexpr std::int64_t SCENE_MS = 1000000, SCENE_S = 1000 * SCENE_MS;

/** Options for a test: speed 0, no pictures, no drift of its own to think of. */
opms_host::WorldOptions scene_options(const std::string &text = "");

/** What is asked of the scene for each item and frame. */
struct SceneListener {
    std::function<void(const opms_box_item_t &)> on_item;
    std::function<void(const opms_host::SourceItem &)> on_source;
    std::function<void(std::int64_t)> on_time;
};

class WorldScene {
public:
    explicit WorldScene(const opms_host::WorldOptions &options);

    opms_host::SimulatedWorld &world() { return *world_; }
    opms_host::BoxPort &box() { return *box_; }
    opms_host::FrameSource &source() { return *source_; }
    std::int64_t now_ns() const { return world_->clock()->now_ns(); }
    void start_source(std::uint32_t buffers = 64);
    /** Let time pass and take what comes. */
    void run_for(double seconds);
    void listen(SceneListener listener) { listener_ = std::move(listener); }

    /** Items since the beginning, by kind. */
    std::vector<opms_box_item_t> items;
    std::vector<opms_box_item_t> of_kind(opms_item_kind_t kind) const;
    std::vector<opms_event_report_t> events(opms_event_kind_t kind) const;
    /** What the source brought; frames without their pictures, for their buffers go back. */
    std::vector<opms_host::SourceItem> source_items;
    std::vector<opms_host::Frame> frames;

private:
    void take_all();

    std::unique_ptr<opms_host::SimulatedWorld> world_;
    std::unique_ptr<opms_host::BoxPort> box_;
    std::unique_ptr<opms_host::FrameSource> source_;
    SceneListener listener_;
};

/** A pairer on a scene, judged by the world's truth. */
class PairedScene {
public:
    explicit PairedScene(const opms_host::WorldOptions &options);
    ~PairedScene();

    /** Arm, let somebody press START, run, disarm, wait until all is decided. */
    void session(std::uint32_t session_id, double seconds);
    WorldScene &scene() { return scene_; }
    opms_pair_summary_t summary() const;

    std::uint64_t paired = 0, wrong = 0, frame_results = 0;
    /** Largest distance of a pair's mid-exposure on the scan's axis from the truth. */
    std::int64_t worst_time_ns = 0;

private:
    void push(const opms_box_item_t &item);
    void push(const opms_host::SourceItem &item);
    void poll(std::int64_t now_ns);
    void judge(const opms_pair_result_t &result);
    void close();

    WorldScene scene_;
    opms_pairer_t *pairer_ = nullptr;
    bool is_open_ = false;
    std::uint64_t tag_ = 0;
};

#endif
