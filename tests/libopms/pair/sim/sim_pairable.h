/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Which frames can be paired at all. */
#ifndef SIM_PAIRABLE_H
#define SIM_PAIRABLE_H

#include "sim_world.h"

/** It came as long after its trigger as frames do, and the box's clock was known by then. */
bool is_on_time(const Session &session, const Delivery &delivery);

/** It came for the first time, and it and word of its trigger both reached the host in 6 s. */
bool is_in_time(const Session &session, const Delivery &delivery);

/** True difference of frame id and trigger. */
int64_t offset_of(const Delivery &delivery);

/** Mark the frames of a session that have two witnesses in this profile.
 * @param delays_learnt  A preamble has shown how long after their triggers frames arrive. */
void mark_pairable(Profile profile, Session &session, bool &delays_learnt);

#endif
