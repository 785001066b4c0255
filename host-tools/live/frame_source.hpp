/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A camera as the live system sees it: GenICam (Aravis), V4L2, simulated, replayed, a preview. */
#ifndef OPMS_LIVE_FRAME_SOURCE_HPP
#define OPMS_LIVE_FRAME_SOURCE_HPP

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include <opms/pair.h>
#include <opms/types.h>

namespace opms_host {

constexpr double NOT_KNOWN = std::numeric_limits<double>::quiet_NaN();

/** A picture and what the camera said with it. Read only once it is made. */
struct Frame {
    opms_image_t image{};  /**< a view into what `memory` keeps */
    std::uint64_t frame_id = 0;          /**< raw */
    std::uint64_t camera_time_ticks = 0; /**< raw */
    std::int64_t arrival_host_ns = 0;    /**< when the whole picture was there */
    std::uint32_t flags = 0;             /**< OPMS_FRAME_NO_ID ... */
    double exposure_us = NOT_KNOWN;      /**< as this frame reports them, not as they were asked */
    double gain_db = NOT_KNOWN;
    std::shared_ptr<const void> memory;  /**< the buffer; back to the camera with the last user */
};
using FramePtr = std::shared_ptr<const Frame>;

/** What a source is and can do. */
struct SourceTraits {
    std::string name;            /**< "aravis:Fake_1", "v4l2:/dev/video0", "simulated", ... */
    std::string model;           /**< maker, model, serial number; may be empty */
    std::int32_t width_px = 0, height_px = 0;
    opms_camera_profile_t profile{};
    bool can_trigger = false;    /**< follows the box's TRIG */
    /** Frames are a preview: whatever their ids say, no pair of them is more than UNCERTAIN. */
    bool preview_only = false;
    bool live = true;            /**< false: a replay, which waits for who takes its frames */
    double exposure_min_us = 0, exposure_max_us = 0; /**< both 0: cannot be set */
    double gain_min_db = 0, gain_max_db = 0;         /**< both 0: cannot be set */
};

struct SourceStart {
    bool hardware_trigger = true; /**< false: the camera's own clock */
    double frame_rate_hz = 10;    /**< without hardware trigger */
    std::uint32_t buffers = 16;   /**< most pictures that are lent out and queued, 2 to 1024 */
    double exposure_us = NOT_KNOWN, gain_db = NOT_KNOWN; /**< NaN: as they are */
};

enum class SourceItemKind {
    none,  /**< nothing came within the time */
    frame,
    lost,  /**< the camera has vanished; it is sought until it is back */
    back,  /**< ... and is there again; ids and times start anew */
    failed, /**< it is there, but refuses; `text` says what */
    end    /**< of a replay: no more will come */
};

struct SourceItem {
    SourceItemKind kind = SourceItemKind::none;
    FramePtr frame;
    std::int64_t t_host_ns = 0;
    std::string text;
};

/** Since start(). */
struct SourceCounters {
    std::uint64_t delivered = 0;  /**< frames handed out by wait() */
    std::uint64_t damaged = 0;    /**< of them, those with lost packets */
    std::uint64_t no_buffer = 0;  /**< came while all buffers were in use, and were lost */
    std::uint64_t failed = 0;     /**< could not be read for another reason, and were lost */
    std::uint32_t lent = 0, buffers = 0; /**< now */
};

/** Calls may come from any thread at any time; wait() from one thread at a time. Frames stay valid
 * after stop() and after the source itself is gone. False on failure, with @p error for people. */
class FrameSource {
public:
    virtual ~FrameSource() = default;
    virtual SourceTraits traits() const = 0;
    virtual bool start(const SourceStart &start, std::string &error) = 0;
    /** Frames that are still queued are gone after it. Idempotent. */
    virtual void stop() = 0;
    /** The next frame or news, within @p timeout_ms. */
    virtual void wait(std::uint32_t timeout_ms, SourceItem &item) = 0;
    /** End a wait(), and the next one if none is going on. */
    virtual void wake() = 0;
    /** For the pictures to come; what they were taken with in the end each frame tells. */
    virtual bool set_exposure(double exposure_us, double gain_db, std::string &error) = 0;
    virtual SourceCounters counters() const = 0;
};

}  // namespace opms_host
#endif
