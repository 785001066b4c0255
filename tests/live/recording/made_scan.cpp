/* SPDX-License-Identifier: Apache-2.0 */
#include "made_scan.hpp"

#include <unity.h>

#include "made_records.hpp"

using namespace opms_host;

std::unique_ptr<Recorder> begin_scan(const std::string &folder, const std::string &name,
                                     RecorderOptions options)
{
    options.folder = folder;
    std::string error;
    auto recorder =
        Recorder::begin(options, made::header(name), std::make_shared<SystemClock>(), error);
    TEST_ASSERT_TRUE_MESSAGE(recorder != nullptr, error.c_str());
    return recorder;
}

void hand_over(Recorder &recorder, std::uint64_t first, std::uint64_t last, std::size_t edges)
{
    for (std::uint64_t n = first; n <= last; n++) {
        recorder.add(made::frame(n), made::picture(n, 64, 48, n % 2 == 0));
        recorder.add(made::trigger(n));
        recorder.add(made::pair(n));
        recorder.add(made::pose(n, edges));
        recorder.add(made::event(n));
        recorder.add(made::clock(n));
        recorder.add(made::box_report(n));
        recorder.add(made::sensor(n));
    }
}

void record_scan(const std::string &folder, const std::string &name, std::uint64_t frames)
{
    const auto recorder = begin_scan(folder, name);
    hand_over(*recorder, 1, frames, 9);
    std::string error;
    TEST_ASSERT_TRUE_MESSAGE(recorder->end(made::end("stop"), error), error.c_str());
}

bool read_all(ScanReader &reader, AllRows &rows, std::string &error)
{
    const auto into = [](auto &list) {
        return [&list](const auto &record) {
            list.push_back(record);
            return true;
        };
    };
    return reader.each_frame(into(rows.frames), error) &&
           reader.each_trigger(into(rows.triggers), error) &&
           reader.each_pair(into(rows.pairs), error) && reader.each_pose(into(rows.poses), error) &&
           reader.each_event(into(rows.events), error) &&
           reader.each_clock(into(rows.clock), error) &&
           reader.each_box_report(into(rows.box_reports), error) &&
           reader.each_sensor(into(rows.sensors), error) &&
           reader.each_picture(into(rows.pictures), error);
}
