/* SPDX-License-Identifier: Apache-2.0 */
#include "live_session.hpp"

#include <utility>

#include "session_impl.hpp"

namespace opms_host {
namespace {

constexpr std::size_t PUBLISHER_ROOM = 256;

bool options_fit(const Devices &devices, const SessionOptions &options, std::string &error)
{
    if (!devices.clock) {
        error = "the devices have no clock";
    } else if (options.frame_queue < 1 || options.frame_queue > 4096) {
        error = "frame_queue is not 1 to 4096";
    } else if (options.source.buffers < 2 || options.source.buffers > 1024) {
        error = "buffers are not 2 to 1024";
    } else if (!(options.source.frame_rate_hz >= 0.01 && options.source.frame_rate_hz <= 10000)) {
        error = "the frame rate is not 0.01 to 10000 Hz";
    } else if (options.max_wait_ms != 0 &&
               (options.max_wait_ms < 100 || options.max_wait_ms > 60000)) {
        error = "max_wait_ms is not 0 or 100 to 60000";
    } else if (const char *problem = options.box_settings
                                         ? opms_wire_check_settings(&*options.box_settings)
                                         : nullptr) {
        error = std::string("settings of the box: ") + problem;
    } else {
        return true;
    }
    return false;
}

/** A camera's size is not known before it is there: then each picture is looked at. */
bool camera_fits(const Devices &devices, const SessionOptions &options, std::string &error)
{
    if (!devices.source || options.mode != SessionMode::position || !options.camera) {
        return true;
    }
    const SourceTraits traits = devices.source->traits();
    const opms_lens_t &lens = options.camera->lens;
    if (traits.width_px > 0 &&
        (traits.width_px != lens.width_px || traits.height_px != lens.height_px)) {
        error = "the camera file is for pictures of " + std::to_string(lens.width_px) + " x " +
                std::to_string(lens.height_px) + " px, the camera gives " +
                std::to_string(traits.width_px) + " x " + std::to_string(traits.height_px);
        return false;
    }
    return true;
}

}  // namespace

std::unique_ptr<LiveSession> LiveSession::create(Devices devices, const SessionOptions &options,
                                                 std::string &error)
{
    return create(std::move(devices), options, make_recorder_sink, error);
}

std::unique_ptr<LiveSession> LiveSession::create(Devices devices, const SessionOptions &options,
                                                 const ScanSinkMaker &make_sink,
                                                 std::string &error)
{
    if (!options_fit(devices, options, error) || !camera_fits(devices, options, error)) {
        return nullptr;
    }
    const SourceTraits traits = devices.source ? devices.source->traits() : SourceTraits();
    std::unique_ptr<FrameLocator> locator = make_frame_locator(options, traits, error);
    if (!locator) {
        return nullptr;
    }
    auto impl = std::make_unique<Impl>(std::move(devices), options, std::move(locator), make_sink);
    return std::unique_ptr<LiveSession>(new LiveSession(std::move(impl)));
}

LiveSession::LiveSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

LiveSession::~LiveSession() = default;

void LiveSession::add_listener(ScanListener *listener)
{
    impl_->publisher().add_listener(listener);
}

bool LiveSession::connect(std::string &error)
{
    return impl_->connect(error);
}

bool LiveSession::software_start(const ScanRequest &request, std::string &error)
{
    return impl_->software_start(request, error);
}

bool LiveSession::software_stop(ScanEnd *end, std::string &error)
{
    return impl_->software_stop(end, error);
}

bool LiveSession::press_start(std::string &error)
{
    return impl_->press_start(error);
}

bool LiveSession::single_picture(std::string &error)
{
    return impl_->single_picture(error);
}

bool LiveSession::add_sensor_sample(SensorRecord record, std::string &error)
{
    return impl_->add_sensor_sample(std::move(record), error);
}

SessionStatus LiveSession::status() const
{
    return impl_->status();
}

SourceTraits LiveSession::source_traits() const
{
    return impl_->source_traits();
}

std::shared_ptr<HostClock> LiveSession::clock() const
{
    return impl_->clock();
}

void LiveSession::newest(FramePtr &picture, std::shared_ptr<const PoseRecord> &pose) const
{
    impl_->newest().get(picture, pose);
}

/* The beginning and the end of the threads. */

LiveSession::Impl::Impl(Devices devices, const SessionOptions &options,
                        std::unique_ptr<FrameLocator> locator, ScanSinkMaker make_sink)
    : devices_(std::move(devices)), options_(options), make_sink_(std::move(make_sink)),
      publisher_(PUBLISHER_ROOM), queue_(options.frame_queue),
      core_(publisher_, devices_.clock, options.max_wait_ms), locator_(std::move(locator))
{
}

bool LiveSession::Impl::connect(std::string &error)
{
    const std::lock_guard<std::mutex> control(control_);
    if (closing_thread_.joinable()) {
        error = "the session is connected already";
        return false;
    }
    hardware_trigger_ = devices_.box && devices_.source && devices_.source->traits().can_trigger &&
                        (options_.mode == SessionMode::position ||
                         options_.source.hardware_trigger);
    publisher_.start();
    {
        const Lock lock(mutex_);
        opms_identity_report_t identity{};
        if (devices_.box && devices_.box->identity(identity)) {
            core_.set_box_connected();
        } else if (devices_.box) {
            core_.tell(Severity::warning, "box.waiting", "the trigger box is not there yet");
        }
    }
    box_thread_ = std::thread([this] { box_loop(); });
    if (devices_.source) {
        camera_thread_ = std::thread([this] { camera_loop(); });
    }
    locating_thread_ = std::thread([this] { locating_loop(); });
    closing_thread_ = std::thread([this] { closing_loop(); });
    return true;
}

LiveSession::Impl::~Impl()
{
    {
        Lock lock(mutex_);
        request_finish("session.closed", false);
        wait_for_finish(lock);
        quit_ = true;
        changed_.notify_all();
    }
    queue_.close();
    if (devices_.box) {
        devices_.box->wake();
    }
    if (devices_.source) {
        devices_.source->wake();
    }
    publisher_.stop();
    for (std::thread *thread : {&box_thread_, &camera_thread_, &locating_thread_,
                                &closing_thread_}) {
        if (thread->joinable()) {
            thread->join();
        }
    }
    if (devices_.source) {
        devices_.source->stop();
    }
}

}  // namespace opms_host
