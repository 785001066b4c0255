/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a small scan as the live system does, and says on stdout what is in it.
 *
 *     scan_fixture PICTURES FOLDER NAME [KEY=VALUE...]
 *
 * PICTURES holds camera.yaml and PNGs, which are taken in turn. Keys: frames (14), pictures (1:
 * each Nth is stored), edges (1), tilt_deg (19.3), samples (1), end=order|kill|hold (until the
 * standard input ends), spoil=NUMBER (that picture's recorded pose is made a little wrong),
 * swap=NUMBER (that frame's recorded trigger is made that of the next). */
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "camera_file.hpp"
#include "code_versions.hpp"
#include "recorder.hpp"

using namespace opms_host;
namespace fs = std::filesystem;

namespace {

constexpr std::int64_t MS = 1000000;
constexpr std::int64_t HOST_LESS_BOX_NS = 5000 * MS;
constexpr std::int64_t START_NS = 11000 * MS - 1032;
constexpr std::int64_t DELAY_NS = 20000, EXPOSURE_NS = 4 * MS;
constexpr std::int64_t BEGUN_WALL_NS = 1795356187LL * 1000 * MS; /* 2026-11-22T14:03:07Z */
constexpr std::uint32_t BOOT = 0x1234ABCD, SESSION = 7, PREAMBLE = 6;
constexpr double RAD = 3.14159265358979323846 / 180;

[[noreturn]] void fail(const std::string &why)
{
    std::cerr << "scan_fixture: " << why << "\n";
    std::exit(1);
}

/** Of the scan's time, not of today's. */
class FixtureClock : public HostClock {
public:
    std::int64_t now_ns() const override { return 13000 * MS; }
    std::int64_t wall_ns() const override { return BEGUN_WALL_NS; }
};

class Keys {
public:
    Keys(int argc, char **argv)
    {
        for (int i = 4; i < argc; i++) {
            const std::string word = argv[i];
            const std::size_t at = word.find('=');
            values_[word.substr(0, at)] = at == std::string::npos ? "" : word.substr(at + 1);
        }
    }
    std::string text(const std::string &key, const std::string &otherwise) const
    {
        const auto found = values_.find(key);
        return found == values_.end() ? otherwise : found->second;
    }
    double number(const std::string &key, double otherwise) const
    {
        const auto found = values_.find(key);
        return found == values_.end() ? otherwise : std::stod(found->second);
    }

private:
    std::map<std::string, std::string> values_;
};

struct Shot {
    cv::Mat picture;
    FrameRecord frame;
    TriggerRecord trigger;
    std::int64_t box_ns = 0;
};

opms_box_time_t box_time(std::int64_t ns)
{
    return {static_cast<std::uint64_t>(ns / 1000), static_cast<std::uint8_t>(ns % 1000 / 8)};
}

std::int64_t pulse_ns(std::uint32_t number)
{
    static const std::int64_t preamble[PREAMBLE] = {9000, 9100, 9300, 9400, 9700, 9800};
    return (number <= PREAMBLE ? preamble[number - 1] : 11000 + 100 * (number - PREAMBLE - 1)) *
           MS;
}

Shot make_shot(std::uint32_t number, const std::string &path)
{
    Shot shot;
    shot.picture = cv::imread(path, cv::IMREAD_UNCHANGED);
    if (shot.picture.empty()) {
        fail("cannot read " + path);
    }
    shot.box_ns = pulse_ns(number);
    const bool in_run = number > PREAMBLE;
    opms_trigger_report_t &report = shot.trigger.report;
    report.flags = in_run ? OPMS_TRIGGER_RUN : OPMS_TRIGGER_PREAMBLE;
    report.boot_id = BOOT;
    report.session_id = SESSION;
    report.report_number = 100 + number;
    report.trigger_number = number;
    report.time = box_time(shot.box_ns);
    report.start_edge = in_run ? box_time(START_NS) : opms_box_time_t{};
    report.first_run_number = in_run ? PREAMBLE + 1 : 0;
    report.gap_us[0] =
        number > 1 ? static_cast<std::uint32_t>((shot.box_ns - pulse_ns(number - 1)) / 1000) : 0;
    shot.trigger.arrival_host_ns = shot.box_ns + HOST_LESS_BOX_NS + MS;
    shot.frame.number = number;
    shot.frame.frame_id = 500 + number;
    shot.frame.camera_time_ticks = static_cast<std::uint64_t>(shot.box_ns / 1000 + 77000000);
    shot.frame.arrival_host_ns = shot.box_ns + HOST_LESS_BOX_NS + 28 * MS;
    shot.frame.exposure_us = EXPOSURE_NS / 1000.0;
    shot.frame.gain_db = 1.5;
    return shot;
}

std::vector<Shot> make_shots(const std::string &folder, std::uint32_t count)
{
    std::vector<std::string> paths;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == ".png") {
            paths.push_back(entry.path().string());
        }
    }
    std::sort(paths.begin(), paths.end());
    std::vector<Shot> shots;
    for (std::uint32_t i = 0; i < count; i++) {
        shots.push_back(make_shot(i + 1, paths[i % paths.size()]));
    }
    return shots;
}

std::vector<ClockRecord> make_clock()
{
    std::vector<ClockRecord> records;
    for (int i = 0; i < 10; i++) {
        const std::int64_t at = (8000 + 90 * i) * MS;
        ClockRecord record;
        record.trip = {at + HOST_LESS_BOX_NS - MS / 2, at, at, at + HOST_LESS_BOX_NS + MS / 2};
        record.wall_ns = BEGUN_WALL_NS;
        records.push_back(record);
    }
    return records;
}

ScanHeader make_header(const std::string &name, const CameraFile &camera, const std::string &text,
                       double tilt_deg)
{
    ScanHeader header;
    header.name = name;
    header.begun_wall_ns = BEGUN_WALL_NS;
    header.begun_host_ns = 8900 * MS + HOST_LESS_BOX_NS;
    header.mode = "position";
    header.camera_file_text = text;
    header.camera_file_name = "camera.yaml";
    header.box_name = "simulated";
    header.source_name = "simulated";
    header.source_model = "Fixture, \"one\"";
    header.has_box = true;
    opms_wire_default_settings(&header.box_settings);
    opms_camera_profile_t &profile = header.camera_profile;
    profile.has_frame_id = profile.has_camera_time = 1;
    profile.frame_id_bits = profile.camera_time_bits = 64;
    profile.camera_tick_hz = 1000000;
    profile.has_start_delay = profile.has_exposure = 1;
    profile.start_delay_ns = DELAY_NS;
    profile.exposure_ns = EXPOSURE_NS;
    header.boot_id = BOOT;
    header.session_id = SESSION;
    header.width_px = camera.camera.lens.width_px;
    header.height_px = camera.camera.lens.height_px;
    header.bar_tilt_rad = tilt_deg * RAD;
    header.bar = "hope33";
    header.versions_json = code_versions_json();
    header.settings_json = R"({"place":"Sandpit 3"})";
    return header;
}

/** In the order of arrival, as a live pairer gets it. */
std::vector<PairRecord> pair(const ScanHeader &header, const std::vector<Shot> &shots,
                             opms_pair_summary_t &summary)
{
    opms_pair_options_t options;
    opms_pair_options_init(&options);
    options.camera = header.camera_profile;
    opms_pairer_t *pairer = nullptr;
    opms_error_t why = {};
    opms_pairer_create(&options, &pairer, &why);
    for (const ClockRecord &record : make_clock()) {
        opms_pong_report_t pong = {};
        pong.boot_id = BOOT;
        pong.received = pong.sent = box_time(record.trip.sent_box_ns);
        opms_pairer_push_pong(pairer, record.trip.sent_host_ns, &pong,
                              record.trip.arrived_host_ns, nullptr);
    }
    opms_pairer_open(pairer, BOOT, SESSION, &header.box_settings, nullptr);
    for (const Shot &shot : shots) {
        opms_frame_t frame = {};
        frame.frame_id = shot.frame.frame_id;
        frame.camera_time_ticks = shot.frame.camera_time_ticks;
        frame.arrival_host_ns = shot.frame.arrival_host_ns;
        frame.tag = shot.frame.number;
        opms_pairer_push_trigger(pairer, &shot.trigger.report, shot.trigger.arrival_host_ns,
                                 nullptr);
        opms_pairer_push_frame(pairer, &frame, nullptr);
    }
    if (opms_pairer_close(pairer, &why) != OPMS_OK) {
        fail(why.message);
    }
    std::vector<PairRecord> records;
    std::uint32_t count = 1;
    while (count > 0) {
        PairRecord record;
        opms_pairer_poll(pairer, &record.result, 1, &count, nullptr);
        if (count > 0) {
            record.t_host_ns = record.result.frame.arrival_host_ns;
            records.push_back(record);
        }
    }
    opms_pairer_summary(pairer, &summary);
    opms_pairer_destroy(pairer);
    return records;
}

/** Each picture with the pose before it as its hint. */
std::vector<std::shared_ptr<PoseRecord>> locate(const CameraFile &camera, double tilt_deg,
                                                const std::vector<Shot> &shots)
{
    opms_locator_options_t options;
    opms_locator_options_init(&options);
    options.bar_tilt_rad = tilt_deg * RAD;
    opms_locator_t *locator = nullptr;
    opms_error_t why = {};
    if (opms_locator_create(&camera.camera, &options, &locator, &why) != OPMS_OK) {
        fail(why.message);
    }
    std::vector<std::shared_ptr<PoseRecord>> poses;
    for (const Shot &shot : shots) {
        const auto pose = std::make_shared<PoseRecord>();
        if (!poses.empty() && poses.back()->location.state == OPMS_BAR_LOCATED) {
            pose->has_hint = true;
            pose->hint = poses.back()->location.pose.bar_camera.transform;
        }
        const opms_image_t image = {shot.picture.data, shot.picture.cols, shot.picture.rows,
                                    static_cast<std::ptrdiff_t>(shot.picture.step[0]),
                                    OPMS_PIXEL_GREY8, 0};
        opms_locator_locate(locator, &image, nullptr, pose->has_hint ? &pose->hint : nullptr,
                            &pose->location, nullptr);
        std::uint32_t count = 0;
        const opms_square_t *squares = opms_locator_squares(locator, &count);
        pose->squares.assign(squares, squares + count);
        const opms_edge_t *edges = opms_locator_edges(locator, &count);
        pose->edges.assign(edges, edges + count);
        const double *residuals = opms_locator_residuals_px(locator);
        pose->residuals_px.assign(residuals, residuals ? residuals + count : residuals);
        pose->number = shot.frame.number;
        pose->arrival_host_ns = shot.frame.arrival_host_ns;
        pose->located_host_ns = pose->published_host_ns = shot.frame.arrival_host_ns + 3 * MS;
        poses.push_back(pose);
    }
    opms_locator_destroy(locator);
    return poses;
}

void add_times(const std::vector<PairRecord> &pairs,
               std::vector<std::shared_ptr<PoseRecord>> &poses)
{
    for (const PairRecord &record : pairs) {
        const opms_pair_result_t &result = record.result;
        if (result.frame_state == OPMS_FRAME_NONE) {
            continue;
        }
        PoseRecord &pose = *poses.at(result.frame.tag - 1);
        pose.frame_state = result.frame_state;
        pose.known = result.known;
        if (result.frame_state == OPMS_FRAME_PAIRED) {
            pose.trigger_number = result.trigger_number;
            pose.has_time = true;
            pose.is_mid_exposure = true;
            pose.t_scan_ns = pulse_ns(static_cast<std::uint32_t>(result.trigger_number)) +
                             DELAY_NS + EXPOSURE_NS / 2 - START_NS;
            pose.t_host_ns = pose.t_scan_ns + START_NS + HOST_LESS_BOX_NS;
        }
    }
}

/** Between, on, before and after the poses; one that has no time. */
std::vector<SensorRecord> make_samples()
{
    std::vector<SensorRecord> samples;
    const std::int64_t pose_ns = 100 * MS + 1032 + DELAY_NS + EXPOSURE_NS / 2; /* second of run */
    for (const std::int64_t t_ns : {-60000 * MS, pose_ns, pose_ns + 50 * MS, 60000 * MS}) {
        SensorRecord sample;
        sample.sensor = "metal";
        sample.number = samples.size() + 1;
        sample.has_time = true;
        sample.t_scan_ns = t_ns;
        sample.t_bound_ns = 2 * MS;
        sample.arrival_host_ns = t_ns + START_NS + HOST_LESS_BOX_NS + 5 * MS;
        sample.values = {0.25 * static_cast<double>(sample.number), NOT_KNOWN};
        samples.push_back(sample);
    }
    SensorRecord late;
    late.sensor = "radar";
    late.arrival_host_ns = 12000 * MS + HOST_LESS_BOX_NS;
    late.values = {1, 2, 3};
    late.data_json = R"({"note":"a \"quote\", a comma"})";
    samples.push_back(late);
    return samples;
}

std::vector<EventRecord> make_events(std::int64_t begun_host_ns)
{
    std::vector<EventRecord> events(2);
    events[0].t_host_ns = begun_host_ns;
    events[0].code = "scan.begun";
    events[0].text = "the scan has begun";
    events[1].t_host_ns = begun_host_ns + 1000 * MS;
    events[1].severity = Severity::warning;
    events[1].code = "box.lost";
    events[1].text = "the trigger box, \"unplugged\",\nis sought";
    return events;
}

FramePtr frame_of(const Shot &shot)
{
    const auto frame = std::make_shared<Frame>();
    const auto memory = std::make_shared<cv::Mat>(shot.picture);
    frame->image = {memory->data, memory->cols, memory->rows,
                    static_cast<std::ptrdiff_t>(memory->step[0]), OPMS_PIXEL_GREY8, 0};
    frame->frame_id = shot.frame.frame_id;
    frame->camera_time_ticks = shot.frame.camera_time_ticks;
    frame->arrival_host_ns = shot.frame.arrival_host_ns;
    frame->memory = memory;
    return frame;
}

/** Until all that was handed over is on the disk. */
void wait_for_disk(const Recorder &recorder)
{
    const auto begun = std::chrono::steady_clock::now();
    while (recorder.figures().queued_rows + recorder.figures().queued_pictures > 0 &&
           std::chrono::steady_clock::now() - begun < std::chrono::seconds(60)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
}

void finish(Recorder &recorder, const std::string &how, const opms_pair_summary_t &summary)
{
    std::string error;
    if (how == "kill" || how == "hold") {
        wait_for_disk(recorder);
        std::cout << std::flush;
        while (how == "hold" && std::cin.get() != EOF) {
        }
        ::_exit(0);
    }
    ScanEnd end;
    end.ended_wall_ns = BEGUN_WALL_NS + 3000 * MS;
    end.ended_host_ns = 13000 * MS;
    end.reason = "stop";
    end.has_summary = true;
    end.summary = summary;
    if (!recorder.end(end, error)) {
        fail(error);
    }
}

nlohmann::ordered_json describe(const Recorder &recorder,
                                const std::vector<std::shared_ptr<PoseRecord>> &poses)
{
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const auto &pose : poses) {
        const double *t_m = pose->location.ground_detector.transform.t_m;
        rows.push_back({{"number", pose->number},
                        {"located", pose->location.state == OPMS_BAR_LOCATED},
                        {"trigger", pose->trigger_number},
                        {"has_time", pose->has_time},
                        {"t_scan_ns", pose->t_scan_ns},
                        {"t_ground_detector_m", {t_m[0], t_m[1], t_m[2]}},
                        {"R_ground_detector",
                         std::vector<double>(pose->location.ground_detector.transform.R,
                                             pose->location.ground_detector.transform.R + 9)}});
    }
    return {{"folder", recorder.folder()}, {"poses", rows}};
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc < 4) {
        fail("PICTURES FOLDER NAME [KEY=VALUE...]");
    }
    const Keys keys(argc, argv);
    const std::string pictures = argv[1];
    CameraFile camera;
    std::string error;
    if (!camera_file_read(pictures + "/camera.yaml", camera, error)) {
        fail(error);
    }
    std::ifstream file(pictures + "/camera.yaml");
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    const double tilt_deg = keys.number("tilt_deg", 19.3);
    const ScanHeader header = make_header(argv[3], camera, text, tilt_deg);
    const std::vector<Shot> shots =
        make_shots(pictures, static_cast<std::uint32_t>(keys.number("frames", 14)));
    opms_pair_summary_t summary = {};
    std::vector<PairRecord> pairs = pair(header, shots, summary);
    auto poses = locate(camera, tilt_deg, shots);
    add_times(pairs, poses);

    RecorderOptions options;
    options.folder = argv[2];
    options.picture_every = static_cast<std::uint32_t>(keys.number("pictures", 1));
    options.edges = keys.number("edges", 1) != 0;
    const auto recorder =
        Recorder::begin(options, header, std::make_shared<FixtureClock>(), error);
    if (!recorder) {
        fail(error);
    }
    for (const ClockRecord &record : make_clock()) {
        recorder->add(record);
    }
    for (const Shot &shot : shots) {
        recorder->add(shot.trigger);
        recorder->add(shot.frame, frame_of(shot));
    }
    for (PairRecord &record : pairs) {
        if (record.result.frame.tag == static_cast<std::uint64_t>(keys.number("swap", 0))) {
            record.result.trigger_number++;
        }
        recorder->add(record);
    }
    for (const auto &pose : poses) {
        if (pose->number == static_cast<std::uint64_t>(keys.number("spoil", 0))) {
            pose->location.ground_detector.transform.t_m[1] += 1e-3;
        }
        recorder->add(std::shared_ptr<const PoseRecord>(pose));
    }
    for (const EventRecord &event : make_events(header.begun_host_ns)) {
        recorder->add(event);
    }
    if (keys.number("samples", 1) != 0) {
        for (const SensorRecord &sample : make_samples()) {
            recorder->add(sample);
        }
    }
    std::cout << describe(*recorder, poses).dump() << std::endl;
    finish(*recorder, keys.text("end", "order"), summary);
    return 0;
}
