/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the simulation tests: anything that pairs. It gets reports as bytes and frames as headers.*/
#ifndef SIM_SUBJECT_H
#define SIM_SUBJECT_H

#include <memory>
#include <vector>

#include <opms/pair.h>

#include "sim_world.h"

class Subject {
public:
    virtual ~Subject() = default;
    virtual void open(uint32_t boot_id, uint32_t session_id, const opms_settings_t &settings) = 0;
    virtual void report(const uint8_t *bytes, int64_t at) = 0;
    virtual void pong(int64_t sent, const uint8_t *bytes, int64_t at) = 0;
    virtual void frame(const opms_frame_t &frame) = 0;
    virtual void advance(int64_t now) = 0;
    virtual void close() = 0;
    virtual std::vector<opms_pair_gap_t> gaps() = 0;
    /** Decisions since the last call. */
    virtual const std::vector<opms_pair_result_t> &take() = 0;
    virtual bool locked() const = 0;
    virtual bool sums_hold() const = 0;
    /** Nanoseconds of processor time that it takes, without the report parser. */
    virtual int64_t spent_ns() const = 0;
};

/** opms_pairer_t. */
std::unique_ptr<Subject> make_pairer(Profile profile, const CameraState &camera,
                                     uint32_t first_number);

/** The first frame is of the first trigger, the next of the next: what everybody tries first. */
std::unique_ptr<Subject> make_naive(uint32_t first_number);

#endif
