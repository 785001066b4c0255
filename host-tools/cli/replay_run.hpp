/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Goes through a recorded scan, makes its poses again and tells how they compare. */
#ifndef OPMS_CLI_REPLAY_RUN_HPP
#define OPMS_CLI_REPLAY_RUN_HPP

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "replay_compare.hpp"
#include "scan_reader.hpp"

struct ReplayRequest {
    opms_camera_t camera{};
    ReplayFrom from = ReplayFrom::pictures;
    std::uint64_t every = 1; /**< of the poses that can be replayed, each Nth */
};

/** Called for each pose; false ends the replay. */
using ReplayTake =
    std::function<bool(const PoseChange &change, const opms_host::PoseRecord &again)>;

struct ReplayOutcome {
    ReplayFigures figures;
    std::uint64_t left_out = 0;        /**< poses without a stored picture, or without points */
    std::vector<std::string> problems; /**< pictures that could not be read */
};

/** False where the recording cannot be read, with @p error. */
bool replay_poses(opms_host::ScanReader &scan, const ReplayRequest &request,
                  const ReplayTake &take, ReplayOutcome &outcome, std::string &error);

#endif
