/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A session that does as it is told, and remembers what it was told. */
#ifndef OPMS_TESTS_FAKE_CONTROL_HPP
#define OPMS_TESTS_FAKE_CONTROL_HPP

#include <mutex>
#include <string>
#include <vector>

#include "session_control.hpp"

namespace opms_host {

/** Stands still, so that times can be foretold. */
class StillClock : public HostClock {
public:
    std::int64_t now_ns() const override { return 5'000'000'000; }
    std::int64_t wall_ns() const override { return 1'800'000'000'000'000'000; }
};

class FakeControl : public SessionControl {
public:
    SessionStatus status() override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        return now;
    }

    bool start_scan(const std::string &name, std::string &scan, ControlError &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!now.scan.empty()) {
            error = {ControlFailure::conflict, "a scan is going on already"};
            return false;
        }
        scan = now.scan = name.empty() ? "2026-11-22_14-03-07" : name;
        now.state = SessionState::ready;
        return true;
    }

    bool stop_scan(ScanEnd &end, ControlError &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (now.scan.empty()) {
            error = {ControlFailure::conflict, "no scan is going on"};
            return false;
        }
        now.scan.clear();
        now.state = SessionState::idle;
        end.reason = "stop";
        end.ended_wall_ns = 1'800'000'000'250'000'000;
        return true;
    }

    bool press_start(ControlError &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        if (now.state != SessionState::ready) {
            error = {ControlFailure::conflict, "the box does not wait for its start"};
            return false;
        }
        now.state = SessionState::running;
        return true;
    }

    bool add_samples(const std::vector<SensorRecord> &records, std::size_t &taken,
                     ControlError &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        taken = 0;
        if (now.scan.empty()) {
            error = {ControlFailure::conflict, "no scan is going on"};
            return false;
        }
        samples.insert(samples.end(), records.begin(), records.end());
        taken = records.size();
        return true;
    }

    FramePtr newest_picture() override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        return picture;
    }

    const HostClock &clock() const override { return clock_; }

    bool list(std::vector<ScanSummary> &scans, std::vector<std::string> &unreadable,
              ControlError &error) override
    {
        ScanSummary scan;
        unreadable = {"broken: no scan.sqlite"};
        find("lane 3", scan, error);
        scans = {scan};
        return true;
    }

    bool find(const std::string &name, ScanSummary &scan, ControlError &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex);
        asked_for = name;
        if (name != "lane 3") {
            error = {ControlFailure::not_found, "there is no such scan"};
            return false;
        }
        scan.name = name;
        scan.poses = 41;
        scan.header.begun_wall_ns = 1'800'000'000'000'000'000;
        return true;
    }

    std::mutex mutex;
    SessionStatus now;
    std::vector<SensorRecord> samples;
    FramePtr picture;
    std::string asked_for;

private:
    StillClock clock_;
};

}  // namespace opms_host
#endif
