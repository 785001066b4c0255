/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What `opms scan` and `opms serve` have in common: the options of a session, and the session. */
#ifndef OPMS_CLI_LIVE_OPTIONS_HPP
#define OPMS_CLI_LIVE_OPTIONS_HPP

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "live_session.hpp"
#include "sensor_feeder.hpp"

namespace CLI {
class App;
}

struct LiveArguments {
    std::string camera;
    std::string box = "hid", source = "aravis:";
    std::string mode = "position", bar = "hope33";
    std::string folder;             /**< of all scans; empty: scans_folder() */
    std::string pictures = "all";   /**< "all", "none" or N: each Nth */
    bool no_recording = false, no_follow = false;
    double tilt_deg = 0;
    double period_ms = 0;           /**< 0: as the box has it */
    double rate_hz = 10;            /**< of a camera without a box */
    double exposure_us = opms_host::NOT_KNOWN, gain_db = opms_host::NOT_KNOWN;
    std::vector<std::string> sensors; /**< NAME=FILE.csv */
    bool wait = false;              /**< for devices that are not there yet */
};

/** Add the options to a command. */
void add_live_options(CLI::App &command, LiveArguments &arguments);

/** Open the devices and make the session, not yet connected.
 * @param[out] exit_code  Set on failure; why is said on stderr.
 * @return NULL then. */
std::unique_ptr<opms_host::LiveSession> open_live_session(const LiveArguments &arguments,
                                                          int &exit_code);

/** A scan to be made with these options. @param name  Empty: date and time. */
opms_host::ScanRequest live_scan_request(const LiveArguments &arguments, const std::string &name);

/** Where these options keep scans. */
std::string live_scans_folder(const LiveArguments &arguments);

/** The files of --sensor. @return false where one is not well said; why is on stderr. */
bool live_sensor_files(const LiveArguments &arguments, std::vector<opms_host::SensorFile> &files);

/** Hand over what the files have got; troubles go to stderr, once each. */
void live_feed_sensors(opms_host::SensorFeeder &feeder, opms_host::LiveSession &session);

#endif
