/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The simulated camera on the emulated box's wires: it exposes when the real firmware says so, in
 * real time. Its truth is in the emulator's clock, which is the box's less a constant of each
 * boot. */
#ifndef OPMS_SIMULATED_WIRED_SOURCE_HPP
#define OPMS_SIMULATED_WIRED_SOURCE_HPP

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <thread>

#include "frame_source.hpp"
#include "host_clock.hpp"
#include "buried_sensor.hpp"
#include "wired_run.hpp"
#include "wires_socket.hpp"
#include "world_buffers.hpp"
#include "world_light.hpp"
#include "world_pictures.hpp"
#include "world_truth.hpp"

namespace opms_host {

class WiredSource : public FrameSource {
public:
    /** Throws std::runtime_error where the camera's file does not read or the truth cannot be
     * written. */
    WiredSource(const WorldOptions &options, std::uint16_t port);
    ~WiredSource() override;
    SourceTraits traits() const override;
    bool start(const SourceStart &start, std::string &error) override;
    void stop() override;
    void wait(std::uint32_t timeout_ms, SourceItem &item) override;
    void wake() override;
    bool set_exposure(double exposure_us, double gain_db, std::string &error) override;
    SourceCounters counters() const override;

private:
    /** News, or a frame that is there from `t_host_ns` on. */
    struct Item {
        SourceItemKind kind = SourceItemKind::frame;
        std::int64_t t_host_ns = 0;
        TrueFrame frame;
    };

    void follow();
    void take(const WiresExposure &exposure);
    bool seek();
    void say(SourceItemKind kind);
    void command();

    const WorldOptions options_;
    const std::uint16_t port_;
    const SystemClock clock_;
    mutable WorldPictures pictures_;
    const WorldLight light_;
    WiresSocket wires_;
    std::thread follower_;
    // Under the bell's lock:
    const std::shared_ptr<WorldBell> bell_ = std::make_shared<WorldBell>();
    WorldTruth truth_;
    WiredRun run_;
    BuriedSensor sensor_;
    std::shared_ptr<WorldBuffers> buffers_;
    std::deque<Item> items_;
    std::uint32_t queued_frames_ = 0;
    bool is_streaming_ = false, is_woken_ = false;
    double exposure_us_, gain_db_;
    std::uint64_t next_id_ = 1, exposures_ = 0;
    SourceCounters counters_;
};

}  // namespace opms_host
#endif
