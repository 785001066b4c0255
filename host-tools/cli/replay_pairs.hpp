/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Pairs a scan's triggers and frames anew, from what was recorded of them, and compares. */
#ifndef OPMS_CLI_REPLAY_PAIRS_HPP
#define OPMS_CLI_REPLAY_PAIRS_HPP

#include <cstdint>
#include <string>
#include <vector>

#include "scan_reader.hpp"

/** What became of a frame or of a trigger, and with which one. */
struct PairFate {
    int state = 0;             /**< opms_frame_state_t or opms_trigger_state_t; 0: not decided */
    std::uint64_t partner = 0; /**< number of the trigger or of the picture; 0: none */
};

struct PairChange {
    bool of_frame = false;
    std::uint64_t number = 0; /**< of the picture, or of the trigger */
    PairFate recorded, again;
};

struct PairReplay {
    bool possible = false;  /**< false: no box was armed */
    std::uint64_t triggers = 0, frames = 0; /**< that have a fate */
    std::uint64_t triggers_changed = 0, frames_changed = 0;
    std::vector<PairChange> changes; /**< the first 100 */
    bool sums_hold = false; /**< of the new pairing */
    std::string line;       /**< of the pairer, for people */

    bool identical() const { return triggers_changed == 0 && frames_changed == 0; }
};

/** False where the recording cannot be read or the pairer refuses it, with @p error. */
bool replay_pairs(opms_host::ScanReader &scan, PairReplay &replay, std::string &error);

#endif
