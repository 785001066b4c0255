/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A trigger box and a camera that do what a test tells them, in a time that the test makes. */
#ifndef OPMS_TESTS_ENGINE_SCENE_HPP
#define OPMS_TESTS_ENGINE_SCENE_HPP

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "live_session.hpp"
#include "scan_sink.hpp"

namespace engine_scene {

using namespace opms_host;

constexpr std::int64_t MS = 1'000'000;
constexpr std::int64_t BOX_BEHIND_NS = 900'000 * MS; /**< box time = host time - this */
constexpr std::int64_t START_DELAY_NS = 10'000, EXPOSURE_NS = 2 * MS;
constexpr std::uint32_t BOOT = 0xB007;

class ManualClock : public HostClock {
public:
    std::int64_t now_ns() const override { return now_; }
    std::int64_t wall_ns() const override { return now_ + 1'700'000'000'000 * MS; }
    void add(std::int64_t ns) { now_ += ns; }

private:
    std::atomic<std::int64_t> now_{1'000'000 * MS};
};

class SceneBox : public BoxPort {
public:
    std::string name() const override { return "scene"; }
    bool poll(std::uint32_t timeout_ms, opms_box_item_t &item) override;
    void wake() override;
    bool arm(std::uint32_t session_id, std::string &error) override;
    bool disarm(std::string &error) override;
    bool settings(opms_settings_report_t &report, std::string &error) override;
    bool set_settings(const opms_settings_t &settings, std::string &error) override;
    bool identity(opms_identity_report_t &identity) const override;
    bool press_start(std::string &error) override;

    void put(const opms_box_item_t &item);
    bool all_taken() const;

    mutable std::mutex mutex;
    std::condition_variable filled;
    std::deque<opms_box_item_t> items;
    bool woken = false, is_there = true, refuses = false, polling = false;
    std::uint32_t boot_id = BOOT, session_id = 0;
    opms_settings_t in_force{};
    std::function<void()> on_arm, on_disarm, on_start; /**< called without the lock */
};

class SceneCamera : public FrameSource {
public:
    SourceTraits traits() const override { return given; }
    bool start(const SourceStart &start, std::string &error) override;
    void stop() override { ++stops; }
    void wait(std::uint32_t timeout_ms, SourceItem &item) override;
    void wake() override;
    bool set_exposure(double exposure_us, double gain_db, std::string &error) override;
    SourceCounters counters() const override;

    void put(const SourceItem &item);
    bool all_taken() const;

    SourceTraits given;
    SourceStart started;
    std::atomic<int> stops{0}, starts{0}, starts_refused{0};
    std::atomic<std::uint32_t> lent{0};
    std::atomic<std::uint64_t> no_buffer{0};
    mutable std::mutex mutex;
    std::condition_variable filled;
    std::deque<SourceItem> items;
    bool woken = false, waiting = false;
    std::vector<double> exposures_set;
};

/** Keeps all that it is told. */
class Notes : public ScanListener {
public:
    void on_state(const SessionStatus &status) override;
    void on_pose(const std::shared_ptr<const PoseRecord> &pose) override;
    void on_event(const EventRecord &event) override;
    void on_picture(const FramePtr &, const std::shared_ptr<const PoseRecord> &) override
    {
        ++pictures;
    }

    std::vector<std::shared_ptr<const PoseRecord>> poses() const;
    std::vector<SessionState> states() const; /**< without repetitions */
    int events(const std::string &code) const;
    /** Wait until an event has come so often: what is heard lags behind what the session is. */
    bool hears(const std::string &code, int times) const;
    std::size_t pose_count() const;

    std::atomic<int> pictures{0};
    std::atomic<int> pose_delay_ms{0}; /**< a listener that is slow */

private:
    mutable std::mutex mutex_;
    std::vector<std::shared_ptr<const PoseRecord>> poses_;
    std::vector<SessionState> states_;
    std::map<std::string, int> events_;
};

/** A recording in memory. */
struct Tape {
    std::mutex mutex;
    int begun = 0, ended = 0;
    ScanHeader header;
    ScanEnd end;
    std::vector<std::uint64_t> frames, poses;
    int triggers = 0, from_history = 0, pairs = 0, clocks = 0, reports = 0, events = 0;
    int after_end = 0;
    std::vector<SensorRecord> samples;
    std::string refuse_begin;
};
ScanSinkMaker tape_maker(const std::shared_ptr<Tape> &tape);

/** What is amiss with a pulse. */
struct Pulse {
    bool report = true, history = false, frame = true, damaged = false;
    std::int64_t after_ms = 100;
};

/** The whole. Without a call of go() nothing moves. */
class Scene {
public:
    explicit Scene(SessionMode mode = SessionMode::capture, bool with_box = true);
    ~Scene();

    /** Make the session and connect it; options may be changed before. */
    void connect();
    /** Software start; then the preamble, WAITING, the hardware start. */
    void begin(bool record = false);
    void preamble();
    void press();
    void pulse(const Pulse &how = Pulse());
    void pulses(int count);
    /** Let time pass, with pings. */
    void go(std::int64_t ms);
    bool stop(ScanEnd *end = nullptr);
    /** Wait until the session has taken all that there is. */
    void taken() const;

    void link(opms_link_change_t change);
    void reboot();
    void status(opms_box_state_t state);
    void camera_news(SourceItemKind kind);
    void free_frame();

    std::shared_ptr<ManualClock> clock;
    SceneBox *box = nullptr;
    SceneCamera *camera = nullptr;
    Notes notes;
    std::shared_ptr<Tape> tape;
    SessionOptions options;
    std::unique_ptr<LiveSession> session;
    Devices devices;
    /** What each frame id was exposed by: the truth. */
    std::map<std::uint64_t, std::uint32_t> trigger_of_number;
    std::map<std::uint64_t, std::int64_t> scan_time_of_number;
    std::uint32_t trigger_number = 0, first_run_number = 0;
    std::uint64_t frame_number = 0, frame_id = 1000;
    std::int64_t start_edge_box_ns = 0;
    bool ids_start_anew = false;

private:
    std::int64_t box_ns() const { return clock->now_ns() - BOX_BEHIND_NS; }
    void ping();
    void event(opms_event_kind_t kind, opms_box_state_t state, std::uint32_t argument);
    void report_trigger(std::uint16_t flags, const Pulse &how);
    void deliver(const Pulse &how);

    std::uint32_t report_number_ = 0;
    std::int64_t pinged_ns_ = 0, last_pulse_box_ns_ = 0, pulse_before_ns_ = 0;
};

/** Wait for what threads will do; false after 60 s. */
bool eventually(const std::function<bool()> &is_so);
opms_box_time_t box_time(std::int64_t ns);
/** A picture of 8 x 8 pixels. */
FramePtr small_frame(std::int64_t arrival_host_ns);

}  // namespace engine_scene
#endif
