/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The interface's view of a real session and its folder of recordings. */
#ifndef OPMS_CONSOLE_LIVE_CONTROL_HPP
#define OPMS_CONSOLE_LIVE_CONTROL_HPP

#include <functional>
#include <mutex>
#include <string>

#include "live_session.hpp"
#include "session_control.hpp"

namespace opms_host {

struct LiveControlOptions {
    std::string folder; /**< of all scans */
    /** A scan to be made, of this name (empty: date and time). */
    std::function<ScanRequest(const std::string &name)> request;
    /** Called just before a scan is stopped; may be empty. */
    std::function<void()> before_stop;
};

class LiveControl : public SessionControl {
public:
    /** @p session must live longer. */
    LiveControl(LiveSession &session, LiveControlOptions options);

    SessionStatus status() override;
    bool start_scan(const std::string &name, std::string &scan, ControlError &error) override;
    bool stop_scan(ScanEnd &end, ControlError &error) override;
    bool press_start(ControlError &error) override;
    bool add_samples(const std::vector<SensorRecord> &records, std::size_t &taken,
                     ControlError &error) override;
    FramePtr newest_picture() override;
    const HostClock &clock() const override;
    bool list(std::vector<ScanSummary> &scans, std::vector<std::string> &unreadable,
              ControlError &error) override;
    bool find(const std::string &name, ScanSummary &scan, ControlError &error) override;

private:
    LiveSession &session_;
    LiveControlOptions options_;
    std::shared_ptr<HostClock> clock_;
    std::mutex turn_; /* of starting and stopping: one at a time, the others are told so */
};

}  // namespace opms_host
#endif
