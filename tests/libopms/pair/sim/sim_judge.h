/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What is right: results against the truth. */
#ifndef SIM_JUDGE_H
#define SIM_JUDGE_H

#include <cstdint>
#include <vector>

#include <opms/pair.h>

#include "sim_world.h"

struct Figures {
    uint64_t triggers = 0, frames = 0;
    uint64_t paired = 0, wrong_pairs = 0;
    uint64_t pairable = 0, pairable_paired = 0;
    uint64_t broken_sums = 0;       ///< a trigger or frame without exactly one result
    uint64_t wrong_missing = 0;     ///< MISSING, and yet its frame had come in time
    uint64_t wrong_orphans = 0;     ///< ORPHAN, and yet a trigger exposed it
    uint64_t by_trigger_state[4] = {}, by_frame_state[6] = {};
    uint64_t locks_lost = 0;
    uint64_t frames_to_lock = 0;    ///< most undisturbed frames in a row without a lock
    uint64_t slow_locks = 0;        ///< more than 10 of them
    int64_t spent_ns = 0;
};

/** Take a result into account. */
void judge_result(Session &session, const opms_pair_result_t &result, Figures &figures);

/** After the last result of a session: sums, and the share of what could be paired.
 * @param delays_learnt  A preamble has shown how long after their triggers frames arrive. */
void judge_session(Profile profile, Session &session, bool &delays_learnt, Figures &figures);

/** Counts undisturbed frames while there is no lock: on time, counted like the ones before, their
 * triggers known, and nothing else comes in between. */
class LockWatch {
public:
    void see(const Session &session, const Delivery &delivery, bool locked, Figures &figures);

private:
    int64_t offset_ = INT64_MIN;
    uint32_t epoch_ = 0;
    uint64_t row_ = 0, unlocked_row_ = 0;
    bool was_locked_ = false, counted_ = false;
};

#endif
