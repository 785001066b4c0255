/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the interface needs of a session and its recordings: a double stands in for it in tests. */
#ifndef OPMS_CONSOLE_SESSION_CONTROL_HPP
#define OPMS_CONSOLE_SESSION_CONTROL_HPP

#include <string>
#include <vector>

#include "host_clock.hpp"
#include "scan_listener.hpp"
#include "scan_reader.hpp"

namespace opms_host {

enum class ControlFailure {
    none,
    conflict,   /**< not in this state: a scan goes on, or none does */
    invalid,    /**< what was asked for cannot be */
    not_found,
    unavailable /**< a device or a disk does not do its part */
};

struct ControlError {
    ControlFailure kind = ControlFailure::none;
    std::string text; /**< one line for people */
};

/** Calls from several threads at a time; they may take as long as the devices do. False on failure,
 * with @p error. */
class SessionControl {
public:
    virtual ~SessionControl() = default;
    virtual SessionStatus status() = 0;
    /** @p name may be empty. @param[out] scan  The name that it got. */
    virtual bool start_scan(const std::string &name, std::string &scan, ControlError &error) = 0;
    virtual bool stop_scan(ScanEnd &end, ControlError &error) = 0;
    virtual bool press_start(ControlError &error) = 0;
    /** @param[out] taken  How many are in the scan, also on failure. */
    virtual bool add_samples(const std::vector<SensorRecord> &records, std::size_t &taken,
                             ControlError &error) = 0;
    /** NULL before the first. */
    virtual FramePtr newest_picture() = 0;
    virtual const HostClock &clock() const = 0;
    virtual bool list(std::vector<ScanSummary> &scans, std::vector<std::string> &unreadable,
                      ControlError &error) = 0;
    /** @p name was checked with scan_name_problem(). */
    virtual bool find(const std::string &name, ScanSummary &scan, ControlError &error) = 0;
};

/** Whether a scan may bear this name (letters, digits, "-", "_", ".", blanks; 1 to 100; no dot
 * first, no dot or blank last). @return Empty, or what is wrong. */
std::string scan_name_problem(const std::string &name);

}  // namespace opms_host
#endif
