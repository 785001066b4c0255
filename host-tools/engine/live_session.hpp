/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The live system: a box, a camera, and what is made of them, by threads of its own.
 *
 *     box thread -----reports-->  pairer  --pairs--.
 *     camera thread --frames--'                     +--> poses in order --> listeners, recorder
 *               '-----pictures--> locating thread --'
 *
 * Bounded queues all along. Where time is short, pictures for display are left out first; stored
 * pictures are never lost in silence, poses never. */
#ifndef OPMS_ENGINE_LIVE_SESSION_HPP
#define OPMS_ENGINE_LIVE_SESSION_HPP

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opms/exposure.h>
#include <opms/types.h>
#include <opms/wire.h>

#include "devices.hpp"
#include "recorder.hpp"
#include "scan_listener.hpp"

namespace opms_host {

enum class SessionMode {
    position,    /**< triggered by the box: a pose for each pulse */
    capture,     /**< pictures alone: single, continuous or triggered */
    calibration  /**< pictures for the calibration, with grid nodes instead of poses */
};

struct SessionOptions {
    SessionMode mode = SessionMode::position;
    std::optional<opms_camera_t> camera; /**< needed for position */
    std::string camera_file_text, camera_file_name; /**< for the recording */
    double bar_tilt_rad = 0;
    std::string bar = "hope33";
    bool follow = true;                 /**< the last pose is a hint for the next picture */
    std::optional<opms_settings_t> box_settings; /**< set before arming; none: as they are */
    SourceStart source;                 /**< hardware_trigger is set by the mode */
    bool automatic_exposure = true;     /**< where the source can be set */
    opms_exposure_options_t exposure{}; /**< struct_size 0: defaults, in the camera's limits */
    std::uint32_t frame_queue = 64;     /**< pictures that may wait to be located */
    std::uint32_t picture_count = 0;    /**< mode capture: end after so many; 0: go on */
    std::uint32_t max_wait_ms = 0;      /**< of the pairer; 0: its default */
};

/** A scan to be made. */
struct ScanRequest {
    std::string name;                   /**< empty: date and time */
    std::optional<RecorderOptions> recording; /**< none: nothing is stored */
    std::string settings_json;          /**< goes into the header as it is */
    /** Mode capture: of the camera's pictures, only those that single_picture() asks for. */
    bool single_pictures = false;
};

/** Where records go instead of a Recorder: see scan_sink.hpp. */
class ScanSink;
using ScanSinkMaker = std::function<std::shared_ptr<ScanSink>(
    const RecorderOptions &options, const ScanHeader &header, std::shared_ptr<HostClock> clock,
    std::string &error)>;

/** Calls from any thread at any time, the destructor excepted. False on failure, with @p error. */
class LiveSession {
public:
    /** Takes the devices. Box and camera may be missing at first and come later.
     * @return NULL where the options do not fit the devices. */
    static std::unique_ptr<LiveSession> create(Devices devices, const SessionOptions &options,
                                               std::string &error);
    /** The same with recordings of another kind. */
    static std::unique_ptr<LiveSession> create(Devices devices, const SessionOptions &options,
                                               const ScanSinkMaker &make_sink, std::string &error);
    /** Stops what goes on, in whatever state. */
    ~LiveSession();

    /** Before connect(); must live until the session has gone. */
    void add_listener(ScanListener *listener);
    /** Start the threads. */
    bool connect(std::string &error);

    /** The software start: new scan, recording on, box armed. Waits until the box has taken it up,
     * not until it is READY: on_state() tells. */
    bool software_start(const ScanRequest &request, std::string &error);
    /** Disarm, wait until each trigger and frame is decided, close the recording. Leaves the
     * devices connected for the next scan. @param[out] end  How it went; may be NULL. */
    bool software_stop(ScanEnd *end, std::string &error);
    /** Hardware start by software: simulated and emulated boxes only. */
    bool press_start(std::string &error);
    /** One picture now, without a box (mode capture): waits for it, 5 s at most. In a scan of
     * single pictures it is its next one; without a scan it can be had by newest(). */
    bool single_picture(std::string &error);
    /** A sensor's sample for the scan that goes on. Times that are not on the scan's axis are
     * placed by their arrival, with the bound stated: record.t_bound_ns says how old the sample may
     * have been then; 0: not known, and so is the bound. arrival_host_ns 0: now. */
    bool add_sensor_sample(SensorRecord record, std::string &error);

    SessionStatus status() const;
    SourceTraits source_traits() const;
    std::shared_ptr<HostClock> clock() const;
    /** The newest picture and its pose, for a display; NULL before the first. */
    void newest(FramePtr &picture, std::shared_ptr<const PoseRecord> &pose) const;

    class Impl;

private:
    explicit LiveSession(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace opms_host
#endif
