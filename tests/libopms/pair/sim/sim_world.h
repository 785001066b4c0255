/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The world of one session: what the box and the camera really did, and what reaches the host.
 *
 * True time is the host's monotonic clock, in ns. Nothing of libopms is used but the structs of the
 * wire. */
#ifndef SIM_WORLD_H
#define SIM_WORLD_H

#include <cstdint>
#include <vector>

#include <opms/pair.h>

#include "sim_faults.h"
#include "sim_random.h"

enum Profile { STAMP_AND_STROBE, STAMP_ONLY, STROBE_ONLY, ARRIVAL_ONLY, PROFILES };

constexpr const char *PROFILE_NAMES[PROFILES] = {"time stamp and strobe", "time stamp only",
                                                 "strobe only", "arrival only"};

inline bool has_stamp(Profile profile) { return profile <= STAMP_ONLY; }
inline bool has_strobe(Profile profile)
{
    return profile == STAMP_AND_STROBE || profile == STROBE_ONLY;
}

constexpr int64_t MS = 1000000;
constexpr int64_t SECOND = 1000 * MS;
constexpr int64_t PERIOD = 100 * MS;
constexpr int64_t FRAME_DELAY = 27 * MS; ///< trigger to arrival, at least
constexpr int64_t ON_TIME = 10 * MS;     ///< what an undisturbed frame may take beyond it
constexpr int64_t WAIT = 6 * SECOND;
constexpr int64_t NEVER = INT64_MAX;

struct TrueTrigger {
    int64_t at;            ///< host time
    int64_t known = NEVER; ///< when its report or HISTORY entry reached the host
    opms_trigger_report_t report;
    bool exposed = false, strobe_seen = false;
    uint32_t strobe_delay_cycles, strobe_length_cycles;
    int results = 0;
};

struct TrueFrame {
    uint64_t serial = 0; ///< of all exposures
    int trigger = -1;  ///< index in the session, or -1
    uint32_t session = 0;
    uint32_t epoch = 0; ///< starts of the camera
    int64_t exposed_at = 0;
    int64_t id = 0;     ///< as the camera counts, not wrapped
    uint64_t raw_id = 0, ticks = 0;
};

/** One frame as it comes to the host. */
struct Delivery {
    int64_t at;
    TrueFrame frame;
    int results = 0;
    bool copy = false;      ///< it came before
    bool paired = false;
    bool pairable = false;
    opms_pair_result_t result{}; ///< the last one
};

struct ReportDelivery {
    int64_t at;
    int trigger;
    int damaged_bit; ///< or -1
};

struct Stall {
    int64_t from, to;
};

/** What passes from one session to the next. */
struct CameraState {
    uint32_t bits = 16;
    bool skips_0 = true;
    int64_t next_id = 1;  ///< not wrapped
    uint32_t epoch = 0;
    int64_t started_at = 0;
    double drift = 0;
    int64_t down_until = 0;
    uint64_t serial = 0;
    std::vector<TrueFrame> past; ///< last frames, for stale ones
};

struct BoxState {
    uint32_t boot_id = 0;
    int64_t started_at = 0;
    double drift = 0;
    uint32_t report_number = 0;

    int64_t box_from_host(int64_t host) const
    {
        const double since = double(host - started_at);
        return 5 * SECOND + (host - started_at) + int64_t(since * drift);
    }
};

struct Session {
    uint32_t id;
    uint32_t first_number;
    BoxState box;
    int64_t armed_at, ended_at, closed_at;
    bool rebooted; ///< how it ended
    opms_box_time_t start_edge;
    uint32_t first_run;
    std::vector<TrueTrigger> triggers;
    int64_t clock_known = NEVER; ///< when the first ping came back that was not held up
    size_t heard = 0; ///< triggers that the host can know to exist
    std::vector<Delivery> frames;        ///< by arrival
    std::vector<ReportDelivery> reports; ///< by arrival
    std::vector<Stall> stalls;
};

opms_settings_t sim_settings(Profile profile);

opms_box_time_t box_time(int64_t box_ns);

/** When what comes at a time is read by a host with these stalls. */
int64_t read_time(const std::vector<Stall> &stalls, int64_t at);

/** One session of about 1,800 triggers. */
Session make_session(Profile profile, uint32_t id, uint32_t first_number, int64_t armed_at,
                     BoxState &box, CameraState &camera, Faults &faults, Random &random);

#endif
