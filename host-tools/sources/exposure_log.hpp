/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * With what a picture was taken, for cameras that do not say it with each picture. */
#ifndef OPMS_SOURCES_EXPOSURE_LOG_HPP
#define OPMS_SOURCES_EXPOSURE_LOG_HPP

#include <cstdint>
#include <deque>

#include "frame_source.hpp"

namespace opms_host {

struct ExposureSetting {
    double exposure_us = NOT_KNOWN, gain_db = NOT_KNOWN;
};

/** Keeps what was set and read back, and when. A picture that was there before a change was taken
 * with what held then; the first ones after it may have been on their way, so they are not known;
 * the later ones were taken with the new setting. One thread at a time. */
class ExposureLog {
public:
    /** @param unsure_frames  Pictures after a change that may have been begun before it. */
    explicit ExposureLog(std::uint32_t unsure_frames) : unsure_frames_(unsure_frames) {}
    /** A new stream: all its pictures are taken with this. */
    void begin(const ExposureSetting &setting);
    /** Confirmed by the camera at @p t_host_ns. */
    void change(std::int64_t t_host_ns, const ExposureSetting &setting);
    const ExposureSetting &newest() const { return changes_.back().setting; }
    /** Once for each picture, in their order. @param t_host_ns  When it was complete. */
    ExposureSetting take(std::int64_t t_host_ns);

private:
    struct Change {
        std::int64_t t_host_ns;
        std::uint32_t unsure;
        ExposureSetting setting;
    };
    std::uint32_t unsure_frames_;
    std::deque<Change> changes_ = {{INT64_MIN, 0, {}}};
};

}  // namespace opms_host
#endif
