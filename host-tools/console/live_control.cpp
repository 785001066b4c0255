/* SPDX-License-Identifier: Apache-2.0 */
#include "live_control.hpp"

#include <filesystem>

namespace opms_host {

namespace {

bool fail(ControlError &error, ControlFailure kind, const std::string &text)
{
    error = {kind, text};
    return false;
}

const char BUSY[] = "a scan is being started or stopped just now";
const char NO_SCAN[] = "no scan is going on";

}  // namespace

LiveControl::LiveControl(LiveSession &session, LiveControlOptions options)
    : session_(session), options_(std::move(options)), clock_(session.clock())
{
}

SessionStatus LiveControl::status()
{
    return session_.status();
}

bool LiveControl::start_scan(const std::string &name, std::string &scan, ControlError &error)
{
    const std::unique_lock<std::mutex> turn(turn_, std::try_to_lock);
    if (!turn) {
        return fail(error, ControlFailure::conflict, BUSY);
    }
    if (!session_.status().scan.empty()) {
        return fail(error, ControlFailure::conflict, "a scan is going on already: stop it first");
    }
    std::string text;
    if (!session_.software_start(options_.request(name), text)) {
        return fail(error, ControlFailure::unavailable, text);
    }
    scan = session_.status().scan;
    return true;
}

bool LiveControl::stop_scan(ScanEnd &end, ControlError &error)
{
    const std::unique_lock<std::mutex> turn(turn_, std::try_to_lock);
    if (!turn) {
        return fail(error, ControlFailure::conflict, BUSY);
    }
    if (session_.status().scan.empty()) {
        return fail(error, ControlFailure::conflict, NO_SCAN);
    }
    if (options_.before_stop) {
        options_.before_stop();
    }
    std::string text;
    return session_.software_stop(&end, text) || fail(error, ControlFailure::unavailable, text);
}

bool LiveControl::press_start(ControlError &error)
{
    if (session_.status().state != SessionState::ready) {
        return fail(error, ControlFailure::conflict, "the box does not wait for its start");
    }
    std::string text;
    return session_.press_start(text) || fail(error, ControlFailure::unavailable, text);
}

bool LiveControl::add_samples(const std::vector<SensorRecord> &records, std::size_t &taken,
                              ControlError &error)
{
    taken = 0;
    if (session_.status().scan.empty()) {
        return fail(error, ControlFailure::conflict, NO_SCAN);
    }
    for (const SensorRecord &record : records) {
        std::string text;
        if (!session_.add_sensor_sample(record, text)) {
            return fail(error, ControlFailure::invalid,
                        "sample " + std::to_string(taken) + ": " + text);
        }
        ++taken;
    }
    return true;
}

FramePtr LiveControl::newest_picture()
{
    FramePtr picture;
    std::shared_ptr<const PoseRecord> pose;
    session_.newest(picture, pose);
    return picture;
}

const HostClock &LiveControl::clock() const
{
    return *clock_;
}

bool LiveControl::list(std::vector<ScanSummary> &scans, std::vector<std::string> &unreadable,
                       ControlError &)
{
    std::error_code nothing_there;
    if (std::filesystem::is_directory(options_.folder, nothing_there)) {
        scans = list_scans(options_.folder, unreadable);
    }
    return true;
}

bool LiveControl::find(const std::string &name, ScanSummary &scan, ControlError &error)
{
    const std::filesystem::path path = std::filesystem::path(options_.folder) / name;
    std::error_code nothing_there;
    if (!std::filesystem::is_directory(path, nothing_there)) {
        return fail(error, ControlFailure::not_found, "there is no such scan");
    }
    std::string text;
    const auto reader = ScanReader::open(path.string(), text);
    if (!reader) {
        return fail(error, ControlFailure::unavailable, text);
    }
    scan = reader->summary();
    return true;
}

}  // namespace opms_host
