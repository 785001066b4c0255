/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What goes wrong in the simulation, and how often: the table of docs/pairing.md. */
#ifndef SIM_FAULTS_H
#define SIM_FAULTS_H

#include "sim_random.h"

/** One kind of fault: its share of all events, in bursts of 1 to 50 (short ones are commoner). */
struct FaultKind {
    const char *name;
    const char *event; ///< of which events it is the share
    double share;
};

enum Fault {
    REPORT_LOST,
    REPORT_LATE,
    REPORT_REPEATED,
    REPORT_REORDERED,
    REPORT_DAMAGED,
    HISTORY_LOST,
    STROBE_UNSEEN,
    TRIGGER_IGNORED,
    FRAME_EXTRA,
    ID_SKIP,
    ID_RESET,
    FRAME_LOST,
    FRAME_LATE,
    FRAME_REPEATED,
    FRAME_STALE,
    PING_STALL,
    FAULTS
};

constexpr FaultKind FAULT_TABLE[FAULTS] = {
    {"report lost", "reports", 0.010},
    {"report late by 1 ms to 5 s", "reports", 0.005},
    {"report repeated within 2 s", "reports", 0.005},
    {"report overtaken by 1 to 3 others", "reports", 0.005},
    {"report damaged (a bit flips)", "reports", 0.001},
    {"answer of HISTORY lost", "answers", 0.020},
    {"exposure not seen by the box", "exposures", 0.001},
    {"trigger ignored by the camera", "triggers", 0.002},
    {"frame without a trigger", "triggers", 0.002},
    {"frame id skips 1 to 20", "frames", 0.001},
    {"frame id starts anew", "frames", 0.001},
    {"frame lost", "frames", 0.010},
    {"frame late by 20 ms to 9 s", "frames", 0.005},
    {"frame repeated within 2 s", "frames", 0.005},
    {"frame of 3 to 300 frames ago comes (again)", "frames", 0.002},
    {"ping held up by 20 to 400 ms", "pings", 0.020},
};

/* These come once in so many triggers, at random. */
constexpr double TRIGGERS_PER_BOX_REBOOT = 2000;
constexpr double TRIGGERS_PER_CAMERA_RESTART = 2000;
constexpr double TRIGGERS_PER_HOST_STALL = 1000; ///< of 0.5 to 5 s: nothing is read meanwhile

constexpr int BURST_MAX = 50;

/** All faults' states: each runs by itself, so that they overlap as they like. */
class Faults {
public:
    /** Does this fault hit the next of its events? */
    bool hits(Fault fault, Random &random)
    {
        int &left = left_[fault];
        first_[fault] = false;
        if (left == 0) {
            constexpr double mean = (BURST_MAX - 1) / 3.912023; // of 1 to 50, log-uniform
            const double rate = FAULT_TABLE[fault].share / mean;
            if (!random.chance(rate / (1 - FAULT_TABLE[fault].share + rate))) {
                return false;
            }
            left = int(random.log_uniform(1, BURST_MAX + 1));
            first_[fault] = true;
        }
        --left;
        ++hits_[fault];
        return true;
    }
    /** Was the last hit the first one of its burst? */
    bool begins(Fault fault) const { return first_[fault]; }
    uint64_t count(Fault fault) const { return hits_[fault]; }

private:
    int left_[FAULTS] = {};
    bool first_[FAULTS] = {};
    uint64_t hits_[FAULTS] = {};
};

#endif
