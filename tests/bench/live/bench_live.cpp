/* SPDX-License-Identifier: Apache-2.0 */
/* Latency from a picture's arrival to its pose, processor time and memory of a session with a
 * simulated camera.
 *
 *     bench_live BOX SOURCE CAMERA.yaml HZ SECONDS [--generator]
 *
 * Prints one JSON object. With --generator the same box and camera run without a session, so that
 * their own load can be told apart. */
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "camera_file.hpp"
#include "live_session.hpp"
#include "open_devices.hpp"
#include "simulated_factory.hpp"

namespace {

using namespace opms_host;
using namespace std::chrono_literals;

constexpr double WARM_UP_S = 2;

struct Arguments {
    std::string box, source, camera;
    double hz = 10, seconds = 20;
    bool generator = false;
};

[[noreturn]] void give_up(const std::string &why)
{
    std::fprintf(stderr, "bench_live: %s\n", why.c_str());
    std::exit(3);
}

double cpu_s()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval &t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/** Resident now. */
double resident_mb()
{
    std::ifstream file("/proc/self/statm");
    long pages = 0, resident = 0;
    file >> pages >> resident;
    return static_cast<double>(resident) * 4096e-6;
}

class Delays : public ScanListener {
public:
    void on_pose(const std::shared_ptr<const PoseRecord> &pose) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!is_on_) {
            return;
        }
        const auto ms = [&](std::int64_t t_ns) {
            return static_cast<double>(t_ns - pose->arrival_host_ns) * 1e-6;
        };
        located_ms_.push_back(ms(pose->located_host_ns));
        published_ms_.push_back(ms(pose->published_host_ns));
        with_time_ += pose->has_time && pose->location.state == OPMS_BAR_LOCATED;
    }
    void turn(bool on)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        is_on_ = on;
    }
    void print(double period_ms)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto missed = std::count_if(located_ms_.begin(), located_ms_.end(),
                                          [&](double delay) { return delay > period_ms; });
        std::printf("\"pictures\":%zu,\"poses\":%zu,\"missed\":%zu,", located_ms_.size(),
                    with_time_, static_cast<std::size_t>(missed));
        print("located_ms", located_ms_);
        print("published_ms", published_ms_);
    }

private:
    static void print(const char *name, std::vector<double> &delays)
    {
        std::sort(delays.begin(), delays.end());
        const auto at = [&](double share) {
            const auto rank = static_cast<std::size_t>(
                std::ceil(share * static_cast<double>(delays.size())));
            return delays.empty() ? -1.0 : delays[std::max<std::size_t>(rank, 1) - 1];
        };
        std::printf("\"%s\":{\"p50\":%.3f,\"p99\":%.3f,\"p999\":%.3f,\"most\":%.3f},", name,
                    at(0.5), at(0.99), at(0.999), at(1));
    }

    std::mutex mutex_;
    bool is_on_ = false;
    std::size_t with_time_ = 0;
    std::vector<double> located_ms_, published_ms_;
};

/** Processor and memory while the time goes by. */
void measure(const Arguments &arguments, Delays *delays)
{
    std::this_thread::sleep_for(std::chrono::duration<double>(WARM_UP_S));
    if (delays) {
        delays->turn(true);
    }
    const double cpu_before = cpu_s(), mb_before = resident_mb();
    const auto begin = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(arguments.seconds));
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    if (delays) {
        delays->turn(false);
    }
    std::printf("\"cores\":%.4f,\"resident_mb\":%.1f,\"grown_mb\":%.1f,",
                (cpu_s() - cpu_before) / time.count(), resident_mb(), resident_mb() - mb_before);
}

void run_generator(const Arguments &arguments, Devices &devices)
{
    std::atomic<bool> done{false}, is_ready{false};
    std::thread box([&] {
        while (!done) {
            opms_box_item_t item{};
            devices.box->poll(20, item);
            is_ready = is_ready || (item.kind == OPMS_ITEM_EVENT &&
                                    item.as.event.kind == OPMS_EVENT_WAITING);
        }
    });
    std::string error;
    SourceStart start;
    if (!devices.source->start(start, error)) {
        give_up(error);
    }
    std::thread camera([&] {
        while (!done) {
            SourceItem item;
            devices.source->wait(100, item);
        }
    });
    if (!devices.box->arm(1, error)) {
        give_up(error);
    }
    for (int i = 0; i < 2000 && !is_ready; ++i) {
        std::this_thread::sleep_for(5ms);
    }
    devices.box->press_start(error);
    measure(arguments, nullptr);
    done = true;
    box.join();
    camera.join();
}

void run_session(const Arguments &arguments, Devices devices, const CameraFile &file)
{
    SessionOptions options;
    options.camera = file.camera;
    std::string error;
    opms_settings_report_t report{};
    if (!devices.box->settings(report, error)) {
        give_up(error);
    }
    report.settings.strobe_enabled = devices.source->traits().profile.has_strobe != 0;
    report.settings.period_us = static_cast<std::uint32_t>(std::lround(1e6 / arguments.hz));
    options.box_settings = report.settings;
    const double before_mb = resident_mb();
    Delays delays;
    const std::unique_ptr<LiveSession> session =
        LiveSession::create(std::move(devices), options, error);
    if (!session) {
        give_up(error);
    }
    session->add_listener(&delays);
    if (!session->connect(error)) {
        give_up(error);
    }
    bool has_begun = false;
    for (int i = 0; i < 100 && !has_begun; ++i) {
        has_begun = session->software_start(ScanRequest(), error);
        std::this_thread::sleep_for(100ms);
    }
    for (int i = 0; i < 2000 && session->status().state != SessionState::ready; ++i) {
        std::this_thread::sleep_for(5ms);
    }
    if (!has_begun || !session->press_start(error)) {
        give_up(error.empty() ? "the box does not get ready" : error);
    }
    measure(arguments, &delays);
    const SessionStatus status = session->status();
    session->software_stop(nullptr, error);
    delays.print(1e3 / arguments.hz);
    std::printf("\"session_mb\":%.1f,\"no_buffer\":%llu,\"display_dropped\":%llu,",
                resident_mb() - before_mb,
                static_cast<unsigned long long>(status.source.no_buffer),
                static_cast<unsigned long long>(status.display_dropped));
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc < 6) {
        give_up("usage: bench_live BOX SOURCE CAMERA.yaml HZ SECONDS [--generator]");
    }
    Arguments arguments;
    arguments.box = argv[1];
    arguments.source = argv[2];
    arguments.camera = argv[3];
    arguments.hz = std::atof(argv[4]);
    arguments.seconds = std::atof(argv[5]);
    arguments.generator = argc > 6 && std::strcmp(argv[6], "--generator") == 0;
    if (!(arguments.hz >= 0.1 && arguments.hz <= 100) || !(arguments.seconds > 0)) {
        give_up("HZ is not 0.1 to 100, or SECONDS not above 0");
    }
    CameraFile file;
    std::string error;
    if (!camera_file_read(arguments.camera, file, error)) {
        give_up(error);
    }
    OpenRequest request;
    request.box = arguments.box;
    request.source = arguments.source;
    request.simulated = simulated_devices;
    Devices devices;
    OpenError why;
    if (!open_devices(request, devices, why)) {
        give_up(why.text);
    }
    if (!devices.box || !devices.source) {
        give_up("both a box and a source are needed");
    }
    std::printf("{\"schema\":\"opms.bench_live/1\",\"hz\":%g,", arguments.hz);
    if (arguments.generator) {
        run_generator(arguments, devices);
    } else {
        run_session(arguments, std::move(devices), file);
    }
    std::printf("\"seconds\":%g}\n", arguments.seconds);
    return 0;
}
