/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * How `opms scan` shows a scan to people: a few lines drawn over again, or a line a second. */
#ifndef OPMS_CLI_SCAN_VIEW_HPP
#define OPMS_CLI_SCAN_VIEW_HPP

#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "scan_listener.hpp"

/** What was last heard of a scan. One thread. */
class ScanView {
public:
    void take(const std::shared_ptr<const opms_host::PoseRecord> &pose) { pose_ = pose; }
    void take(const opms_host::EventRecord &event);

    /** Lines of the live view. */
    std::vector<std::string> screen(const opms_host::SessionStatus &status) const;
    /** One line, for a file or a pipe. */
    std::string line(const opms_host::SessionStatus &status) const;

private:
    static constexpr std::size_t EVENTS = 5;

    std::shared_ptr<const opms_host::PoseRecord> pose_;
    std::deque<std::string> events_;
};

/** "warning camera.lost: ..." */
std::string scan_event_text(const opms_host::EventRecord &event);
/** What the operator should know of a state: "READY: give the hardware start". */
std::string scan_state_text(opms_host::SessionState state);

#endif
