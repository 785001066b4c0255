/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated camera: exposes on each pulse of TRIG, counts, stamps, and delivers after a while.
 * No pixels here: they are made when a frame is taken. One thread at a time. */
#ifndef OPMS_SIMULATED_WORLD_CAMERA_HPP
#define OPMS_SIMULATED_WORLD_CAMERA_HPP

#include <cstdint>
#include <deque>
#include <functional>

#include "frame_source.hpp"
#include "world_agenda.hpp"
#include "world_box_clock.hpp"
#include "world_faults.hpp"
#include "world_light.hpp"
#include "world_truth.hpp"

namespace opms_host {

/** What made the camera expose. */
struct CameraTrigger {
    std::int64_t true_ns = 0;
    std::uint32_t boot_id = 0, session_id = 0, number = 0; /**< number 0: nothing did */
    std::uint32_t picture = 0;  /**< that it sees then */
    double run_s = 0;           /**< since the run began, for the light; 0 before */
    BoxClock box_clock{};
};

/** A frame or news on its way to who waits for it. */
struct CameraItem {
    SourceItemKind kind = SourceItemKind::frame;
    std::int64_t t_host_ns = 0;
    const char *text = "";
    TrueFrame frame;
};

class WorldCamera {
public:
    struct Listener {
        /** An exposure was active; from and to in true time. */
        std::function<void(std::int64_t, std::int64_t)> on_strobe;
        /** A frame came to the host. False: no buffer was free, and it is lost. */
        std::function<bool(TrueFrame &)> on_arrival;
    };

    WorldCamera(Agenda &agenda, HostStall &stall, const WorldOptions &options,
                std::uint32_t pictures);
    void set_listener(Listener listener) { listener_ = std::move(listener); }

    void start(const SourceStart &start);
    void stop();
    bool is_streaming() const { return is_streaming_; }
    void set_exposure(double exposure_us, double gain_db);
    void trigger(const CameraTrigger &trigger);
    /** It loses its power and is back after a while. */
    void restart(std::int64_t length_ns);
    void hide_bar(std::int64_t until_ns) { hidden_until_ns_ = until_ns; }

    std::deque<CameraItem> &items() { return items_; }
    std::uint32_t queued_frames() const { return queued_frames_; }
    /** The oldest item; there must be one. */
    CameraItem take();

private:
    struct Setting {
        double exposure_us, gain_db;
    };

    void begin_stream();
    void free_run();
    Setting next_setting();
    void expose(const CameraTrigger &trigger);
    void deliver(const TrueFrame &frame);
    void deliver_at(std::int64_t t_ns, const TrueFrame &frame);
    void arrive(TrueFrame frame);
    std::uint64_t ticks(std::int64_t true_ns) const;
    void say(SourceItemKind kind, const char *text);

    Agenda &agenda_;
    HostStall &stall_;
    const WorldOptions options_;
    const std::uint32_t pictures_;
    Listener listener_;
    WorldRandom random_;
    FaultDice trigger_dice_, frame_dice_;
    const WorldLight light_;
    SourceStart start_;
    bool is_streaming_ = false, is_down_ = false;
    std::uint64_t stream_ = 0;      /**< what was exposed in an earlier one does not come */
    std::int64_t powered_ns_ = 0, busy_until_ns_ = 0, hidden_until_ns_ = 0;
    std::int64_t last_arrival_ns_ = 0;
    std::uint64_t next_id_ = 1, exposures_ = 0;
    Setting commanded_;
    std::deque<Setting> commands_;  /**< that do not act yet */
    std::deque<TrueFrame> past_;    /**< for stale ones */
    std::deque<CameraItem> items_;
    std::uint32_t queued_frames_ = 0;
};

}  // namespace opms_host
#endif
