/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Results of `opms replay` as rows of JSON and as lines for people. */
#ifndef OPMS_CLI_REPLAY_ROWS_HPP
#define OPMS_CLI_REPLAY_ROWS_HPP

#include <string>

#include <nlohmann/json.hpp>

#include "replay_pairs.hpp"
#include "replay_run.hpp"

/** With what a scan was made, and with what it is replayed. */
struct ReplayMeans {
    std::string scan;
    ReplayFrom from = ReplayFrom::pictures;
    std::string recorded_versions, versions; /**< as JSON objects */
    bool same_code = false, same_camera = false;
};

/** opms.replay/1: one pose. */
nlohmann::ordered_json replay_pose_row(const PoseChange &change, ReplayFrom from);
/** opms.replay.pair/1: one trigger or frame whose fate differs. */
nlohmann::ordered_json replay_pair_row(const PairChange &change);
/** opms.replay.summary/1. @param pairs  NULL where pairing was not asked for. */
nlohmann::ordered_json replay_summary_row(const ReplayMeans &means, const ReplayOutcome &outcome,
                                          const PairReplay *pairs);

std::string replay_pose_line(const PoseChange &change);
std::string replay_pair_line(const PairChange &change);
std::string replay_summary_text(const ReplayMeans &means, const ReplayOutcome &outcome,
                                const PairReplay *pairs);

#endif
