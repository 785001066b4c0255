/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The threads of a session around its core.
 *
 * | thread | waits for | gives to |
 * |---|---|---|
 * | box | the box's items, 20 ms at most | the core |
 * | camera | the camera's pictures; room in the queue and at the publisher | core, queue |
 * | locating | the queue | core, display, exposure of the camera |
 * | publishing (Publisher) | what the core gives out | listeners |
 * | closing | the end of a scan | the recording |
 *
 * `mutex_` guards the core and the small things beside it. It is never held while a device, a
 * listener or the disk is called; the order of locks is control_, mutex_, those of the publisher
 * and of the recording. */
#ifndef OPMS_ENGINE_SESSION_IMPL_HPP
#define OPMS_ENGINE_SESSION_IMPL_HPP

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "bounded_queue.hpp"
#include "frame_locator.hpp"
#include "light_loop.hpp"
#include "live_session.hpp"
#include "newest_picture.hpp"
#include "publisher.hpp"
#include "scan_sink.hpp"
#include "session_core.hpp"

namespace opms_host {

class LiveSession::Impl {
public:
    Impl(Devices devices, const SessionOptions &options, std::unique_ptr<FrameLocator> locator,
         ScanSinkMaker make_sink);
    ~Impl();

    Publisher &publisher() { return publisher_; }
    bool connect(std::string &error);
    bool software_start(const ScanRequest &request, std::string &error);
    bool software_stop(ScanEnd *end, std::string &error);
    bool press_start(std::string &error);
    bool single_picture(std::string &error);
    bool add_sensor_sample(SensorRecord record, std::string &error);
    SessionStatus status() const;
    SourceTraits source_traits() const;
    std::shared_ptr<HostClock> clock() const { return devices_.clock; }
    const NewestPicture &newest() const { return newest_; }

private:
    using Lock = std::unique_lock<std::mutex>;
    /** A picture to be located; number 0: of no scan. */
    struct Work {
        FramePtr frame;
        std::uint64_t number = 0;
    };
    struct Finish {
        std::string reason;
        bool patient = false; /**< wait for what may still come */
    };

    /* session_devices.cpp */
    void box_loop();
    void take_box_item(const opms_box_item_t &item);
    void disarm_forgotten_box();
    void camera_loop();
    bool start_source();
    void take_source_item(const SourceItem &item);
    void take_frame(const FramePtr &frame);
    bool is_wanted(const Frame &frame);
    void count_picture();
    void watch_source();
    void set_exposure_again();
    void wait_for_scan();

    /* session_locating.cpp */
    void locating_loop();
    void locate(const Work &work);
    void check_size(const opms_image_t &image);
    bool is_reported(const Frame &frame);
    void control_light(const Frame &frame, const BarInPicture &bar, PoseRecord &pose);
    void fit_light();
    void tell_light(const PoseRecord &pose);
    void tell_blur(const PoseRecord &pose);
    void show(const FramePtr &frame, const PoseRecord &pose);

    /* session_scan.cpp */
    bool may_start(const ScanRequest &request, std::string &error);
    bool prepare_box(ScanStart &start, std::string &error);
    void wait_for_box_clock(Lock &lock, std::uint32_t boot_id);
    bool begin_recording(const ScanRequest &request, ScanStart &start, std::string &error);
    ScanHeader scan_header(const ScanRequest &request, const ScanStart &start) const;
    bool arm(std::uint32_t session_id, std::string &error);
    std::uint32_t new_session_id();

    /* session_closing.cpp */
    void request_finish(const std::string &reason, bool patient);
    void wait_for_finish(Lock &lock);
    void closing_loop();
    void finish_scan(Lock &lock, const Finish &finish);
    void disarm_box(Lock &lock);
    void wait_until_decided(Lock &lock);

    const Devices devices_;
    const SessionOptions options_;
    const ScanSinkMaker make_sink_;
    bool hardware_trigger_ = false;

    Publisher publisher_;
    NewestPicture newest_;
    BoundedQueue<Work> queue_;

    std::mutex control_; /**< one start, stop or single picture at a time */
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    SessionCore core_;
    std::optional<Finish> finish_;
    std::optional<ScanEnd> last_end_;
    std::string last_end_error_;
    bool disarm_wanted_ = false;
    bool singles_only_ = false;
    std::uint32_t singles_wanted_ = 0;
    std::int64_t single_since_ns_ = 0;
    double asked_exposure_us_ = NOT_KNOWN, asked_gain_db_ = NOT_KNOWN;
    std::uint32_t last_session_id_ = 0;

    /* Of the camera's thread. */
    SourceCounters told_counters_;
    std::int64_t watched_ns_ = 0;

    /* Of the locating thread. */
    std::unique_ptr<FrameLocator> locator_;
    std::unique_ptr<LightLoop> light_;
    std::uint32_t frames_not_reported_ = 0;
    BlurVerdict told_blur_ = BlurVerdict::unknown, seen_blur_ = BlurVerdict::unknown;
    std::uint32_t blur_seen_ = 0; /**< pictures in a row of this verdict */
    opms_exposure_state_t told_light_ = OPMS_EXPOSURE_SEARCHING;
    std::atomic<bool> camera_is_new_{true};

    std::atomic<bool> source_ended_{false}, quit_{false};
    std::thread box_thread_, camera_thread_, locating_thread_, closing_thread_;
};

}  // namespace opms_host
#endif
