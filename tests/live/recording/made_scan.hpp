/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A recording of made records, and all that a reader finds in one. */
#ifndef OPMS_TESTS_MADE_SCAN_HPP
#define OPMS_TESTS_MADE_SCAN_HPP

#include <memory>
#include <string>
#include <vector>

#include "recorder.hpp"
#include "scan_reader.hpp"

/** Its time moves only when it is told to. */
class HandClock : public opms_host::HostClock {
public:
    int64_t now_ns() const override { return now; }
    int64_t wall_ns() const override { return 1795356187000000000 + now; }
    std::int64_t now = 1000;
};

/** NULL, and a failed test, where it cannot begin. */
std::unique_ptr<opms_host::Recorder> begin_scan(const std::string &folder, const std::string &name,
                                                opms_host::RecorderOptions options = {});
/** All of records first to last; pictures of 64 x 48, 16 bit where n is even. */
void hand_over(opms_host::Recorder &recorder, std::uint64_t first, std::uint64_t last,
               std::size_t edges);
/** A whole scan of that many frames. */
void record_scan(const std::string &folder, const std::string &name, std::uint64_t frames);

/** Every row, read by every call of the reader. */
struct AllRows {
    std::vector<opms_host::FrameRecord> frames;
    std::vector<opms_host::TriggerRecord> triggers;
    std::vector<opms_host::PairRecord> pairs;
    std::vector<opms_host::PoseRecord> poses;
    std::vector<opms_host::EventRecord> events;
    std::vector<opms_host::ClockRecord> clock;
    std::vector<opms_host::BoxReportRecord> box_reports;
    std::vector<opms_host::SensorRecord> sensors;
    std::vector<opms_host::PictureRow> pictures;
};
/** @return False with @p error where a call fails; what came before it is in @p rows. */
bool read_all(opms_host::ScanReader &reader, AllRows &rows, std::string &error);

#endif
