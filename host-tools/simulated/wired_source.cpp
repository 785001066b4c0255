/* SPDX-License-Identifier: Apache-2.0 */
#include "wired_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "world_agenda.hpp"
#include "world_frame.hpp"

namespace opms_host {

namespace {

constexpr std::chrono::milliseconds SEEK_PAUSE(300);
constexpr std::uint32_t BUFFERS_MIN = 2, BUFFERS_MAX = 1024;
constexpr double PERIOD_S = 0.1; /* of the box, unless the options tell another one */

double box_period_s(const WorldOptions &options)
{
    return options.period_us > 0 ? options.period_us * 1e-6 : PERIOD_S;
}

double pulse_period_s(const WorldOptions &options)
{
    return options.path_period_s > 0 ? options.path_period_s : box_period_s(options);
}

std::chrono::steady_clock::time_point real_time_of(std::int64_t host_ns)
{
    return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(host_ns));
}

}  // namespace

WiredSource::WiredSource(const WorldOptions &options, std::uint16_t port)
    : options_(options), port_(port), pictures_(options, pulse_period_s(options)),
      light_(options), truth_(options.truth_file, false), run_(box_period_s(options)),
      sensor_(options, pictures_.path(), pulse_period_s(options) / box_period_s(options),
              (options.start_delay_us + options.exposure_us / 2) * 1e-6),
      exposure_us_(options.exposure_us),
      gain_db_(options.gain_db)
{
}

WiredSource::~WiredSource()
{
    stop();
}

SourceTraits WiredSource::traits() const
{
    SourceTraits traits;
    traits.name = "simulated:wires=" + std::to_string(port_);
    traits.model = "OPMS simulated camera on an emulated box";
    traits.width_px = pictures_.width_px();
    traits.height_px = pictures_.height_px();
    traits.profile = world_camera_profile(options_);
    traits.can_trigger = true;
    traits.exposure_min_us = EXPOSURE_MIN_US;
    traits.exposure_max_us = EXPOSURE_MAX_US;
    traits.gain_max_db = GAIN_MAX_DB;
    return traits;
}

bool WiredSource::start(const SourceStart &start, std::string &error)
{
    if (start.buffers < BUFFERS_MIN || start.buffers > BUFFERS_MAX) {
        error = "a source needs 2 to 1024 buffers";
        return false;
    }
    if (!start.hardware_trigger) {
        error = "the simulated camera on an emulated box follows its TRIG alone";
        return false;
    }
    if (follower_.joinable()) {
        error = "the simulated camera has been started already";
        return false;
    }
    if (!wires_.connect(port_, error)) {
        return false;
    }
    {
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        const std::size_t bytes = static_cast<std::size_t>(pictures_.width_px()) *
                                  static_cast<std::size_t>(pictures_.height_px());
        buffers_ = std::make_shared<WorldBuffers>(start.buffers, bytes, bell_);
        exposure_us_ = std::isnan(start.exposure_us) ? exposure_us_ : start.exposure_us;
        gain_db_ = std::isnan(start.gain_db) ? gain_db_ : start.gain_db;
        counters_ = SourceCounters();
        next_id_ = options_.first_frame_id;
        is_streaming_ = true;
    }
    command();
    if (!wires_.wait_exposing()) {
        error = "127.0.0.1:" + std::to_string(port_) + " is no socket of an emulated box's wires";
        stop();
        return false;
    }
    follower_ = std::thread([this] { follow(); });
    return true;
}

void WiredSource::stop()
{
    {
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        is_streaming_ = false;
        bell_->changed.notify_all();
    }
    wires_.end();
    if (follower_.joinable()) {
        follower_.join();
    }
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    items_.clear();
    queued_frames_ = 0;
}

/** Tell the wires' end what exposure follows each pulse. */
void WiredSource::command()
{
    double exposure_us = 0;
    {
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        exposure_us = exposure_us_;
    }
    wires_.expose(static_cast<std::uint64_t>(options_.start_delay_us * 1000),
                  static_cast<std::uint64_t>(exposure_us * 1000));
}

void WiredSource::say(SourceItemKind kind)
{
    Item item;
    item.kind = kind;
    item.t_host_ns = clock_.now_ns();
    items_.push_back(item);
    bell_->changed.notify_all();
}

void WiredSource::follow()
{
    WiresExposure exposure;
    do {
        while (wires_.read(exposure)) {
            take(exposure);
        }
    } while (seek());
}

/** The emulated box has gone: until it is back, or the stream is stopped. */
bool WiredSource::seek()
{
    std::unique_lock<std::mutex> lock(bell_->mutex);
    const auto is_over = [this] { return !is_streaming_; };
    if (is_streaming_) {
        say(SourceItemKind::lost);
    }
    while (!bell_->changed.wait_for(lock, SEEK_PAUSE, is_over)) {
        std::string error;
        lock.unlock();
        const bool is_back = wires_.connect(port_, error);
        if (is_back) {
            command();
        }
        lock.lock();
        if (is_back && is_streaming_) {
            next_id_ = options_.first_frame_id;
            say(SourceItemKind::back);
            return true;
        }
    }
    return false;
}

void WiredSource::take(const WiresExposure &exposure)
{
    const std::int64_t now = clock_.now_ns();
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    if (!is_streaming_) {
        return;
    }
    const auto trigger_ns = static_cast<std::int64_t>(exposure.trigger_ns);
    if (run_.take(trigger_ns)) {
        sensor_.run_began();
    }
    const double run_s = run_.is_running() ? run_.run_s(trigger_ns) : 0;
    if (run_.is_running()) {
        sensor_.advance_to(run_s);
    }
    const double from_s = static_cast<double>(exposure.trigger_ns + exposure.delay_ns) * 1e-9;
    Item item;
    TrueFrame &frame = item.frame;
    frame.exposure_number = ++exposures_;
    frame.frame_id = world_raw_id(options_, next_id_++);
    if (options_.camera_time) {
        frame.camera_time_ticks = static_cast<std::uint64_t>(
            std::llround(from_s * (1 + options_.camera_drift_ppm * 1e-6) *
                         static_cast<double>(options_.camera_tick_hz)));
    }
    frame.mid_box_ns = static_cast<std::int64_t>(exposure.trigger_ns + exposure.delay_ns +
                                                 exposure.length_ns / 2);
    frame.picture = static_cast<std::uint32_t>(run_.pulse() % pictures_.count());
    frame.exposure_us = static_cast<double>(exposure.length_ns) * 1e-3;
    frame.gain_db = gain_db_;
    frame.light = light_.factor(run_s);
    item.t_host_ns = now + static_cast<std::int64_t>(exposure.delay_ns + exposure.length_ns) +
                     static_cast<std::int64_t>(options_.readout_ms * NS_PER_MS);
    frame.arrival_host_ns = item.t_host_ns;
    if (buffers_->lent() + queued_frames_ >= buffers_->count()) {
        ++counters_.no_buffer;
        return;
    }
    const PathPoint point = pictures_.point(frame.picture);
    truth_.add(frame, {point.ground_detector, pictures_.bar_camera(frame.picture),
                       point.velocity_m_s});
    items_.push_back(item);
    ++queued_frames_;
    bell_->changed.notify_all();
}

void WiredSource::wait(std::uint32_t timeout_ms, SourceItem &item)
{
    item = SourceItem();
    Item taken;
    std::shared_ptr<std::uint8_t> pixels;
    {
        std::unique_lock<std::mutex> lock(bell_->mutex);
        const std::int64_t deadline = clock_.now_ns() + timeout_ms * NS_PER_MS;
        const auto is_there = [this] {
            return !items_.empty() && items_.front().t_host_ns <= clock_.now_ns();
        };
        while (!is_there() && !is_woken_ && clock_.now_ns() < deadline) {
            const std::int64_t due =
                items_.empty() ? deadline : std::min(deadline, items_.front().t_host_ns);
            bell_->changed.wait_until(lock, real_time_of(due));
        }
        is_woken_ = is_woken_ && is_there();
        if (!is_there()) {
            return;
        }
        taken = items_.front();
        items_.pop_front();
        if (taken.kind == SourceItemKind::frame) {
            --queued_frames_;
            ++counters_.delivered;
            pixels = buffers_->lend();
        }
    }
    item.kind = taken.kind;
    item.t_host_ns = taken.t_host_ns;
    if (taken.kind == SourceItemKind::frame) {
        item.frame = world_frame(pictures_, options_, taken.frame, std::move(pixels));
    } else {
        item.text = taken.kind == SourceItemKind::lost
                        ? "the emulated box's wires are gone; seeking them"
                        : "the emulated box's wires are back";
    }
}

void WiredSource::wake()
{
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    is_woken_ = true;
    bell_->changed.notify_all();
}

bool WiredSource::set_exposure(double exposure_us, double gain_db, std::string &error)
{
    if (!(exposure_us > 0) || !std::isfinite(exposure_us) || !std::isfinite(gain_db)) {
        error = "exposure and gain must be numbers, and the exposure above 0";
        return false;
    }
    {
        const std::lock_guard<std::mutex> guard(bell_->mutex);
        exposure_us_ = std::clamp(exposure_us, EXPOSURE_MIN_US, EXPOSURE_MAX_US);
        gain_db_ = std::clamp(gain_db, 0.0, GAIN_MAX_DB);
    }
    command();
    return true;
}

SourceCounters WiredSource::counters() const
{
    const std::lock_guard<std::mutex> guard(bell_->mutex);
    SourceCounters counters = counters_;
    if (buffers_) {
        counters.lent = buffers_->lent();
        counters.buffers = buffers_->count();
    }
    return counters;
}

}  // namespace opms_host
