/* SPDX-License-Identifier: Apache-2.0 */
/* Records a made scan at real rates and says what it has handed over, for tests that kill it or cut
 * its power:
 *
 *     scan_writer record FOLDER NAME FRAMES RATE_HZ EDGES COMMIT_MS
 *     scan_writer recover SCAN
 *
 * record ends after so many frames, or when its standard input ends. Lines, each written at once:
 * begun, "n NUMBER NS" once all of frame NUMBER has been handed over, "synced NS" (all before is
 * on the disk), "late NS" (this machine let us sleep so much too long), ending, ended. NS are of
 * the monotonic clock. */
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include <poll.h>
#include <unistd.h>

#include "disk_tap.h"
#include "made_records.hpp"
#include "recorder.hpp"
#include "scan_reader.hpp"

using namespace opms_host;

namespace {

struct Plan {
    std::string folder, name;
    std::uint64_t frames = 0;
    double rate_hz = 60;
    std::size_t edges = 0;
    std::uint32_t commit_ms = 100;
};

void say(const std::string &line)
{
    const std::string text = line + "\n";
    disk_tap_mark(line.c_str());
    if (::write(STDOUT_FILENO, text.data(), text.size()) < 0) {
        std::_Exit(3);
    }
}

bool told_to_stop()
{
    pollfd in = {STDIN_FILENO, POLLIN, 0};
    return ::poll(&in, 1, 0) > 0;
}

void hand_over(Recorder &recorder, std::uint64_t n, std::size_t edges)
{
    recorder.add(made::frame(n), made::picture(n, 64, 48, n % 2 == 0));
    recorder.add(made::trigger(n));
    recorder.add(made::pair(n));
    recorder.add(made::pose(n, edges));
    recorder.add(made::sensor(n));
    if (n % 10 == 0) {
        recorder.add(made::event(n));
    }
    if (n % 20 == 0) {
        recorder.add(made::clock(n));
    }
    if (n % 60 == 0) {
        recorder.add(made::box_report(n));
    }
}

int record(const Plan &plan)
{
    const auto clock = std::make_shared<SystemClock>();
    RecorderOptions options;
    options.folder = plan.folder;
    options.commit_ms = plan.commit_ms;
    options.picture_queue = 1024;
    std::string error;
    const auto recorder = Recorder::begin(options, made::header(plan.name), clock, error);
    if (!recorder) {
        std::fprintf(stderr, "scan_writer: %s\n", error.c_str());
        return 1;
    }
    say("begun");
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1 / plan.rate_hz));
    auto next = std::chrono::steady_clock::now();
    for (std::uint64_t n = 1; n <= plan.frames && !told_to_stop(); n++) {
        hand_over(*recorder, n, plan.edges);
        say("n " + std::to_string(n) + " " + std::to_string(clock->now_ns()));
        say("synced " + std::to_string(recorder->figures().synced_host_ns));
        next += period;
        std::this_thread::sleep_until(next);
        const auto late = std::chrono::steady_clock::now() - next;
        say("late " + std::to_string(std::chrono::nanoseconds(late).count()));
    }
    say("ending");
    const bool good = recorder->end(made::end("stop"), error);
    if (!good) {
        std::fprintf(stderr, "scan_writer: %s\n", error.c_str());
        return 1;
    }
    say("ended");
    return 0;
}

int recover(const char *path)
{
    ScanRecovery recovery;
    std::string error;
    if (!recover_scan(path, recovery, error)) {
        std::fprintf(stderr, "scan_writer: %s\n", error.c_str());
        return 1;
    }
    std::printf("{\"needed\": %s, \"rows\": %llu, \"pictures_lost\": %llu}\n",
                recovery.needed ? "true" : "false",
                static_cast<unsigned long long>(recovery.rows),
                static_cast<unsigned long long>(recovery.pictures_lost));
    return 0;
}

}  // namespace

int main(int count, char **words)
{
    if (count == 3 && std::strcmp(words[1], "recover") == 0) {
        return recover(words[2]);
    }
    if (count != 8 || std::strcmp(words[1], "record") != 0) {
        std::fprintf(stderr, "usage: scan_writer record FOLDER NAME FRAMES RATE_HZ EDGES COMMIT_MS"
                             " | recover SCAN\n");
        return 2;
    }
    Plan plan;
    plan.folder = words[2];
    plan.name = words[3];
    plan.frames = std::strtoull(words[4], nullptr, 10);
    plan.rate_hz = std::strtod(words[5], nullptr);
    plan.edges = std::strtoull(words[6], nullptr, 10);
    plan.commit_ms = static_cast<std::uint32_t>(std::strtoul(words[7], nullptr, 10));
    return record(plan);
}
