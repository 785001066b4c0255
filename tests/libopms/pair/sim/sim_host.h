/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A host that reads what the world sends, asks for what is lost, and hands it to a subject. */
#ifndef SIM_HOST_H
#define SIM_HOST_H

#include "sim_judge.h"
#include "sim_subject.h"
#include "sim_world.h"

/** Run one session. `delivered` remembers by serial number which frames ever came. */
void run_session(Profile profile, Session &session, const BoxState &next_box, Subject &subject,
                 std::vector<bool> &delivered, bool &delays_learnt, Faults &faults,
                 Random &random, Figures &figures);

#endif
