/* SPDX-License-Identifier: Apache-2.0 */
/* Whole scans in the simulated world, whose truth the session does not see: with all faults at
 * once, with the bar hidden, in changing light, and for long. */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <thread>

#include <malloc.h>

#include "engine_scene.hpp"
#include "simulated_world.hpp"
#include "../recording/temporary_folder.hpp"

extern "C" {
#include "unity.h"
}

using namespace engine_scene;

void setUp(void) {}
void tearDown(void) {}

namespace {

/* 0.2 mm at 1 m/s. */
constexpr std::int64_t TIME_ERROR_MOST_NS = 200'000;

bool is_long_run()
{
    const char *wish = std::getenv("OPMS_LIVE_LONG");
    return wish && std::string(wish) == "1";
}

/** What is kept of a pose: the whole would be too much for a long scan. */
struct Seen {
    std::size_t scan = 0;
    std::uint64_t number = 0, trigger_number = 0;
    std::int64_t arrival_host_ns = 0, t_scan_ns = 0;
    opms_frame_state_t frame_state = OPMS_FRAME_NONE;
    opms_bar_state_t bar_state = OPMS_BAR_ABSENT;
    bool has_time = false;
    double white = 0, saturated = 0; /**< of the light on the bar */
    double camera_m[3] = {}; /**< in the bar's frame */
    std::size_t bytes_held = 0; /**< by the program, then; 0 where that cannot be known */
};

class Watch : public ScanListener {
public:
    void on_pose(const std::shared_ptr<const PoseRecord> &pose) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        scans_ += pose->number == 1;
        Seen seen;
        seen.scan = scans_;
        seen.number = pose->number;
        seen.trigger_number = pose->trigger_number;
        seen.arrival_host_ns = pose->arrival_host_ns;
        seen.t_scan_ns = pose->t_scan_ns;
        seen.frame_state = pose->frame_state;
        seen.bar_state = pose->location.state;
        seen.has_time = pose->has_time;
        std::copy_n(pose->location.pose.bar_camera.transform.t_m, 3, seen.camera_m);
        seen.white = pose->light.white;
        seen.saturated = pose->light.saturated;
        seen.bytes_held = mallinfo2().uordblks;
        seen_.push_back(seen);
    }
    std::size_t count() const
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return seen_.size();
    }
    std::vector<Seen> seen() const
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return seen_;
    }

private:
    mutable std::mutex mutex_;
    std::size_t scans_ = 0;
    std::vector<Seen> seen_;
};

struct Outcome {
    std::vector<Seen> seen;
    std::vector<std::uint32_t> sessions; /**< of each scan that has poses */
    int broken_sums = 0, scans = 0;
    std::uint64_t frames = 0, poses = 0;
};

/** A sink that keeps what a judge needs. */
class JudgeSink : public ScanSink {
public:
    JudgeSink(Outcome &outcome, std::uint32_t session) : outcome_(outcome), session_(session) {}
    void add(const FrameRecord &record, const FramePtr &) override
    {
        ++outcome_.frames;
        if (record.number == 1) {
            outcome_.sessions.push_back(session_);
        }
    }
    void add(const TriggerRecord &) override {}
    void add(const PairRecord &) override {}
    void add(const std::shared_ptr<const PoseRecord> &) override { ++outcome_.poses; }
    void add(const EventRecord &) override {}
    void add(const ClockRecord &) override {}
    void add(const BoxReportRecord &) override {}
    void add(const SensorRecord &) override {}
    RecorderFigures figures() const override { return {}; }
    std::string name() const override { return "judge"; }
    bool end(const ScanEnd &end, std::string &) override
    {
        ++outcome_.scans;
        outcome_.broken_sums += !end.summary.sums_hold ||
                                end.summary.counters.triggers_pending != 0 ||
                                end.summary.counters.frames_pending != 0;
        return true;
    }

private:
    Outcome &outcome_; /**< handed over under the session's lock, looked at after its end */
    std::uint32_t session_;
};

/** Scan until so many pictures have come, beginning anew whenever a run has ended by itself. */
void scan_in(SimulatedWorld &world, const SessionOptions &options, std::size_t pictures,
             Outcome &outcome)
{
    Devices devices;
    devices.clock = world.clock();
    devices.box = world.make_box();
    devices.source = world.make_source();
    const ScanSinkMaker make_sink = [&](const RecorderOptions &, const ScanHeader &header,
                                        std::shared_ptr<HostClock>, std::string &) {
        return std::make_shared<JudgeSink>(outcome, header.session_id);
    };
    std::string error;
    Watch watch;
    std::unique_ptr<LiveSession> session =
        LiveSession::create(std::move(devices), options, make_sink, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(session.get(), error.c_str());
    session->add_listener(&watch);
    TEST_ASSERT_TRUE_MESSAGE(session->connect(error), error.c_str());
    while (watch.count() < pictures) {
        const SessionState state = session->status().state;
        if (state == SessionState::idle || state == SessionState::interrupted) {
            ScanRequest request;
            request.recording = RecorderOptions();
            session->software_start(request, error); /* the box may be away: then again */
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    session->software_stop(nullptr, error);
    session.reset();
    outcome.seen = watch.seen();
}

/** @return Poses with a time; none may have a wrong trigger or a wrong time. */
std::size_t judge(const SimulatedWorld &world, const Outcome &outcome)
{
    std::map<std::int64_t, TrueFrame> truth;
    for (const TrueFrame &frame : world.true_frames()) {
        truth[frame.arrival_host_ns] = frame;
    }
    std::map<std::size_t, std::array<int, 8>> states; /* of each scan: by state; with a time */
    for (const Seen &seen : outcome.seen) {
        ++states[seen.scan][seen.frame_state];
        states[seen.scan][7] += seen.has_time;
    }
    for (const auto &[scan, count] : states) {
        std::printf("  scan %zu: %d paired, %d orphan, %d double, %d stale, %d uncertain, "
                    "%d timed\n",
                    scan, count[1], count[2], count[3], count[4], count[5], count[7]);
    }
    std::size_t with_time = 0, wrong_triggers = 0, wrong_times = 0, strangers = 0;
    std::int64_t worst_ns = 0;
    for (const Seen &seen : outcome.seen) {
        const auto place = truth.find(seen.arrival_host_ns);
        if (place == truth.end()) {
            ++strangers;
            continue;
        }
        if (seen.frame_state == OPMS_FRAME_PAIRED) {
            wrong_triggers += place->second.trigger_number != seen.trigger_number ||
                              place->second.session_id != outcome.sessions[seen.scan - 1];
        }
        if (seen.has_time) {
            std::int64_t true_ns = 0;
            const bool is_known = world.true_scan_time(place->second, true_ns);
            const std::int64_t error_ns = std::llabs(seen.t_scan_ns - true_ns);
            worst_ns = std::max(worst_ns, error_ns);
            wrong_times += !is_known || error_ns > TIME_ERROR_MOST_NS;
            ++with_time;
        }
    }
    std::printf("%zu pictures, %zu with a time, %d scans, worst time error %.1f us\n",
                outcome.seen.size(), with_time, outcome.scans,
                static_cast<double>(worst_ns) * 1e-3);
    TEST_ASSERT_EQUAL_UINT64(0, strangers);
    TEST_ASSERT_EQUAL_UINT64(0, wrong_triggers);
    TEST_ASSERT_EQUAL_UINT64(0, wrong_times);
    TEST_ASSERT_EQUAL_INT(0, outcome.broken_sums);
    TEST_ASSERT_EQUAL_UINT64(outcome.frames, outcome.poses);
    TEST_ASSERT_EQUAL_UINT64(outcome.frames, outcome.seen.size());
    return with_time;
}

WorldOptions fast_world(std::uint64_t seed)
{
    WorldOptions options;
    options.speed = 0;
    options.seed = seed;
    options.start_after_s = 0.5;
    options.pictures = PictureMode::blank;
    return options;
}

SessionOptions pictures_only()
{
    SessionOptions options;
    options.mode = SessionMode::capture;
    return options;
}

void ten_minutes_with_all_faults_give_no_wrong_trigger_and_no_wrong_time(void)
{
    WorldOptions options = fast_world(7);
    options.faults = FaultRates::many();
    std::string error;
    const auto world = SimulatedWorld::create(options, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(world.get(), error.c_str());
    Outcome outcome;
    scan_in(*world, pictures_only(), 6000, outcome);
    TEST_ASSERT_TRUE(judge(*world, outcome) > 3000);
    TEST_ASSERT_TRUE(outcome.scans > 1);
}

void an_undisturbed_scan_gives_each_pulse_its_pose(void)
{
    WorldOptions options = fast_world(3);
    std::string error;
    const auto world = SimulatedWorld::create(options, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(world.get(), error.c_str());
    Outcome outcome;
    scan_in(*world, pictures_only(), 600, outcome);
    const std::size_t with_time = judge(*world, outcome);
    TEST_ASSERT_TRUE(outcome.frames - with_time <= 6); /* those of the preamble */
}

/** The least memory held in a fifth of a scan: what waits at an instant is not in it. */
double least_held(const Outcome &outcome, std::size_t fifth)
{
    const std::size_t size = outcome.seen.size() / 5;
    const auto begin = outcome.seen.begin() + static_cast<std::ptrdiff_t>(fifth * size);
    const auto least = std::min_element(
        begin, begin + static_cast<std::ptrdiff_t>(size),
        [](const Seen &a, const Seen &b) { return a.bytes_held < b.bytes_held; });
    return static_cast<double>(least->bytes_held);
}

/** A camera of pictures so small that those which wait in its buffers weigh nothing beside the
 * records: a dozen more or fewer of them than before is the machine's load, not a leak. */
std::string write_small_camera(const TemporaryFolder &folder)
{
    const std::string file = folder / "small.yaml";
    std::ofstream(file) << R"(image_width: 64
image_height: 48
camera_name: small
camera_matrix: {rows: 3, cols: 3, data: [36, 0, 32, 0, 36, 24, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}
)";
    return file;
}

/** 6,000 triggers; 36,000 with OPMS_LIVE_LONG=1. It needs no more memory than what the judge and
 * the truth keep. */
void a_long_scan_needs_no_more_memory_as_it_goes_on(void)
{
    const TemporaryFolder folder;
    WorldOptions options = fast_world(5);
    options.camera_file = write_small_camera(folder);
    options.faults = FaultRates::some();
    options.faults[Mishap::box_reboot] = 0;
    std::string error;
    const auto world = SimulatedWorld::create(options, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(world.get(), error.c_str());
    Outcome outcome;
    scan_in(*world, pictures_only(), is_long_run() ? 36000 : 6000, outcome);
    judge(*world, outcome);
    /* The world's truth and the judge's notes grow by some 350 bytes a picture, in jumps. What may
     * wait for a slow machine is bounded: well below 300 poses at the least. */
    const double pictures = static_cast<double>(outcome.seen.size()) * 2 / 5;
    const double bytes = least_held(outcome, 4) - least_held(outcome, 2);
    std::printf("%.0f bytes more for each picture\n", bytes / pictures);
    TEST_ASSERT_TRUE(bytes < pictures * 700 + 300 * sizeof(PoseRecord));
}

/** The bar is hidden for a while, at 10 Hz: no picture shows it then, and the first that does gives
 * a right pose. */
void the_first_picture_that_shows_the_bar_again_gives_a_right_pose(void)
{
    WorldOptions options = fast_world(11);
    options.pictures = PictureMode::lazy;
    options.frames = 8;
    options.path_period_s = 0.1;
    options.max_speed_m_s = 0.3;
    double at_s = 1;
    for (const double length_s : {0.1, 0.5, 3.0, is_long_run() ? 60.0 : 6.0}) {
        options.planned.push_back({Mishap::hide_bar, at_s, length_s});
        at_s += length_s + 1;
    }
    std::string error;
    const auto world = SimulatedWorld::create(options, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(world.get(), error.c_str());
    SessionOptions session;
    session.camera = world->camera();
    Outcome outcome;
    scan_in(*world, session, static_cast<std::size_t>(at_s * 10), outcome);
    judge(*world, outcome);
    std::map<std::int64_t, TrueFrame> truth;
    for (const TrueFrame &frame : world->true_frames()) {
        truth[frame.arrival_host_ns] = frame;
    }
    int hidden = 0, returns = 0;
    bool was_hidden = false;
    for (const Seen &seen : outcome.seen) {
        const TrueFrame &frame = truth.at(seen.arrival_host_ns);
        hidden += frame.is_hidden;
        returns += was_hidden && !frame.is_hidden;
        was_hidden = frame.is_hidden;
        if (frame.is_hidden) {
            TEST_ASSERT_NOT_EQUAL_INT(OPMS_BAR_LOCATED, seen.bar_state);
            continue;
        }
        TEST_ASSERT_EQUAL_INT(OPMS_BAR_LOCATED, seen.bar_state);
        const TruePose pose = world->true_pose(frame.picture);
        for (int i = 0; i < 3; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(0.003, pose.bar_camera.t[i], seen.camera_m[i]);
        }
    }
    std::printf("%d pictures without the bar, %d returns\n", hidden, returns);
    TEST_ASSERT_TRUE(hidden > 60);
    TEST_ASSERT_EQUAL_INT(4, returns);
}

/** Steps of 3 EV down and up again. The world's camera takes up an exposure two frames later, and
 * two more are on their way at most: it has two buffers and waits for them. */
void a_step_of_the_light_is_followed_within_five_pictures_and_the_cameras_delay(void)
{
    constexpr int RECOVERED_AFTER = 5 + 2 + 2;
    WorldOptions options = fast_world(13);
    options.pictures = PictureMode::lazy;
    options.frames = 8;
    options.path_period_s = 0.1;
    options.max_speed_m_s = 0.3;
    options.light_steps = {{3, -3}, {6, 0}};
    std::string error;
    const auto world = SimulatedWorld::create(options, error);
    TEST_ASSERT_NOT_NULL_MESSAGE(world.get(), error.c_str());
    SessionOptions session;
    session.camera = world->camera();
    session.source.buffers = 2;
    Outcome outcome;
    scan_in(*world, session, 90, outcome);
    judge(*world, outcome);
    for (const std::int64_t step_s : {3, 6}) {
        std::size_t i = 0; /* the first picture that shows the step */
        const auto shows_it = [&](const Seen &seen) {
            return seen.has_time && seen.t_scan_ns > (step_s * 1000 - 300) * MS &&
                   std::fabs(seen.white - 0.75) > 0.15;
        };
        while (i < outcome.seen.size() && !shows_it(outcome.seen[i])) {
            ++i;
        }
        TEST_ASSERT_TRUE(i + RECOVERED_AFTER < outcome.seen.size());
        TEST_ASSERT_TRUE(outcome.seen[i].t_scan_ns < step_s * 1000 * MS + 500 * MS);
        const Seen &after = outcome.seen[i + RECOVERED_AFTER];
        TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.75, after.white);
        TEST_ASSERT_TRUE(after.saturated < 0.005);
    }
}

}  // namespace

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_undisturbed_scan_gives_each_pulse_its_pose);
    RUN_TEST(ten_minutes_with_all_faults_give_no_wrong_trigger_and_no_wrong_time);
    RUN_TEST(the_first_picture_that_shows_the_bar_again_gives_a_right_pose);
    RUN_TEST(a_step_of_the_light_is_followed_within_five_pictures_and_the_cameras_delay);
    RUN_TEST(a_long_scan_needs_no_more_memory_as_it_goes_on);
    return UNITY_END();
}
