/* SPDX-License-Identifier: Apache-2.0 */
/* No thread of its own: who waits polls the device. A camera that vanishes is sought by its path,
 * and by its name and place among all devices: while pictures of the old opening are still in use,
 * the system gives it another number. */
#include "v4l2_source.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include <linux/videodev2.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "exposure_log.hpp"
#include "source_queue.hpp"
#include "v4l2_controls.hpp"
#include "v4l2_stream.hpp"

namespace opms_host {
namespace {

constexpr std::uint32_t SEQUENCE_BITS = 32;
constexpr std::uint32_t UNSURE_FRAMES = 2; /* USB cameras take a setting over with a delay */
constexpr std::uint32_t BROKEN_MOST = 10;  /* in a row: only opening it again may help */
constexpr int SEEK_MS = 500;
constexpr int NAP_MS = 10;
constexpr int DEVICES_MOST = 64;
constexpr double EXPOSURE_UNIT_US = 100.0;

/* An eventfd that outlives the source, for buffers that come back late. */
class Bell {
public:
    Bell() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}
    ~Bell() { ::close(fd_); }
    Bell(const Bell &) = delete;
    Bell &operator=(const Bell &) = delete;
    int fd() const { return fd_; }
    void ring() const { eventfd_write(fd_, 1); }
    void hush() const
    {
        eventfd_t value = 0;
        eventfd_read(fd_, &value);
    }

private:
    const int fd_;
};

class V4l2Source : public FrameSource {
public:
    V4l2Source(V4l2Place place, std::shared_ptr<HostClock> clock,
               std::shared_ptr<V4l2Calls> calls)
        : place_(std::move(place)), clock_(std::move(clock)), calls_(std::move(calls))
    {
    }
    ~V4l2Source() override { stop(); }

    bool open(bool wait_for_missing, std::string &error)
    {
        stream_ = V4l2Stream::open(calls_, place_.path, place_.size, error);
        if (stream_) {
            adopt();
            return true;
        }
        lost_ = wait_for_missing && (errno == ENOENT || errno == ENODEV || errno == ENXIO);
        news_ = lost_ ? error : "";
        return lost_;
    }

    SourceTraits traits() const override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        return traits_;
    }

    bool start(const SourceStart &start, std::string &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (start.buffers < 2 || start.buffers > 1024) {
            error = "2 to 1024 buffers are possible";
            return false;
        }
        start_ = start;
        counters_ = SourceCounters();
        wanted_ = true;
        if (lost_) {
            return true; /* begins when the camera comes */
        }
        wanted_ = begin(error);
        return wanted_;
    }

    void stop() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        wanted_ = false;
        if (stream_) {
            stream_->stop();
        }
        bell_->ring();
    }

    void wait(std::uint32_t timeout_ms, SourceItem &item) override
    {
        item = SourceItem();
        using Steady = std::chrono::steady_clock;
        const auto end = Steady::now() + std::chrono::milliseconds(timeout_ms);
        while (!step(item)) {
            const auto left =
                std::chrono::ceil<std::chrono::milliseconds>(end - Steady::now()).count();
            if (left <= 0 || !sleep(static_cast<int>(left))) {
                return;
            }
        }
    }

    void wake() override
    {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            woken_ = true;
        }
        bell_->ring();
    }

    bool set_exposure(double exposure_us, double gain_db, std::string &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (lost_) {
            error = traits_.name + " has vanished";
            return false;
        }
        ExposureSetting setting = {exposure_us, gain_db};
        if (!v4l2_set_exposure(*calls_, stream_->fd(), controls_, place_.gain_step_db, setting,
                               error)) {
            error = traits_.name + ": " + error;
            return false;
        }
        exposures_.change(clock_->now_ns(), setting);
        return true;
    }

    SourceCounters counters() const override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        SourceCounters counters = counters_;
        counters.buffers = stream_ ? stream_->buffers() : 0;
        counters.lent = stream_ ? stream_->lent() : 0;
        return counters;
    }

private:
    /* What a fresh opening can do. */
    void adopt()
    {
        const V4l2Shape &shape = stream_->shape();
        controls_ = v4l2_find_controls(*calls_, stream_->fd());
        traits_ = SourceTraits();
        traits_.name = "v4l2:" + place_.path;
        traits_.model = shape.card;
        traits_.width_px = shape.width_px;
        traits_.height_px = shape.height_px;
        traits_.profile.has_frame_id = 1;
        traits_.profile.frame_id_bits = SEQUENCE_BITS;
        if (shape.monotonic) {
            traits_.profile.has_camera_time = 1;
            traits_.profile.camera_time_bits = 64;
            traits_.profile.camera_tick_hz = 1'000'000;
        }
        traits_.can_trigger = controls_.trigger.has_value() || place_.wired_trigger;
        if (controls_.exposure) {
            traits_.exposure_min_us =
                EXPOSURE_UNIT_US * std::fmax(1.0, static_cast<double>(controls_.exposure->least));
            traits_.exposure_max_us =
                EXPOSURE_UNIT_US * static_cast<double>(controls_.exposure->most);
        }
        if (controls_.gain) {
            traits_.gain_max_db = place_.gain_step_db * static_cast<double>(
                                                            controls_.gain->most -
                                                            controls_.gain->least);
        }
    }

    bool begin(std::string &error)
    {
        const int fd = stream_->fd();
        if (!place_.wired_trigger &&
            !v4l2_set_trigger(*calls_, fd, controls_, start_.hardware_trigger, error)) {
            error = traits_.name + " cannot follow the box: " + error;
            return false;
        }
        if (!start_.hardware_trigger) {
            v4l2_streamparm rate = {};
            rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
            rate.parm.capture.timeperframe.numerator = 1000;
            rate.parm.capture.timeperframe.denominator =
                static_cast<std::uint32_t>(std::lround(1000 * start_.frame_rate_hz));
            calls_->ioctl(fd, VIDIOC_S_PARM, &rate); /* the nearest it has; or it has one alone */
        }
        v4l2_take_manual(*calls_, fd);
        ExposureSetting setting = {start_.exposure_us, start_.gain_db};
        if (!v4l2_set_exposure(*calls_, fd, controls_, place_.gain_step_db, setting, error) ||
            !stream_->start(start_.buffers, error)) {
            error = traits_.name + ": " + error;
            return false;
        }
        exposures_.begin(setting);
        has_last_ = false;
        return true;
    }

    /* @return Whether the wait is over. */
    bool step(SourceItem &item)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!news_.empty()) {
            item = source_news(SourceItemKind::lost, clock_->now_ns(), std::exchange(news_, ""));
            return true;
        }
        if (std::exchange(woken_, false)) {
            return true;
        }
        if (lost_) {
            return seek(item);
        }
        V4l2Filled filled;
        std::string why;
        switch (stream_->take(filled, why)) {
        case V4l2Take::none: return false;
        case V4l2Take::filled: deliver(filled, item); return true;
        case V4l2Take::gone: lose(why, item); return true;
        case V4l2Take::broken: break;
        }
        ++counters_.failed;
        if (++broken_ >= BROKEN_MOST) {
            lose(why, item);
            return true;
        }
        item = source_news(SourceItemKind::failed, clock_->now_ns(), traits_.name + ": " + why);
        return true;
    }

    void deliver(const V4l2Filled &filled, SourceItem &item)
    {
        broken_ = 0;
        const V4l2Shape &shape = stream_->shape();
        auto frame = std::make_shared<Frame>();
        frame->arrival_host_ns = clock_->now_ns();
        frame->memory = std::shared_ptr<const void>(
            filled.pixels,
            [stream = stream_, bell = bell_, index = filled.index](const void *) {
                stream->give_back(index);
                bell->ring();
            });
        frame->image.pixels = filled.pixels;
        frame->image.width_px = shape.width_px;
        frame->image.height_px = shape.height_px;
        frame->image.stride_bytes = shape.stride_bytes;
        frame->image.format = shape.pixels->grey;
        frame->image.white_level = shape.white_level;
        if (shape.pixels->interleaved) {
            /* The buffer goes with the copy, so that both are bounded by the one count. */
            using Both = std::pair<std::shared_ptr<const void>, std::shared_ptr<const void>>;
            auto both = std::make_shared<Both>(
                v4l2_copy_grey(filled.pixels, shape.width_px, shape.height_px,
                               shape.stride_bytes),
                std::move(frame->memory));
            frame->image.pixels = both->first.get();
            frame->memory = std::move(both);
            frame->image.stride_bytes = shape.width_px;
        }
        frame->frame_id = filled.sequence;
        frame->camera_time_ticks = static_cast<std::uint64_t>(filled.t_us);
        frame->flags = filled.damaged ? OPMS_FRAME_DAMAGED : 0;
        if (!filled.monotonic) {
            frame->flags |= OPMS_FRAME_NO_TIME;
        }
        const std::int64_t taken_ns =
            filled.monotonic ? filled.t_us * 1000 : frame->arrival_host_ns;
        const ExposureSetting setting = exposures_.take(taken_ns);
        frame->exposure_us = setting.exposure_us;
        frame->gain_db = setting.gain_db;
        count(filled);
        item.kind = SourceItemKind::frame;
        item.t_host_ns = frame->arrival_host_ns;
        item.frame = std::move(frame);
    }

    void count(const V4l2Filled &filled)
    {
        ++counters_.delivered;
        counters_.damaged += filled.damaged;
        if (has_last_ && filled.starved) {
            counters_.no_buffer += filled.sequence - last_sequence_ - 1U;
        }
        last_sequence_ = filled.sequence;
        has_last_ = true;
    }

    void lose(const std::string &why, SourceItem &item)
    {
        lost_ = true;
        next_seek_ = std::chrono::steady_clock::now();
        broken_ = 0;
        start_.exposure_us = exposures_.newest().exposure_us;
        start_.gain_db = exposures_.newest().gain_db;
        card_ = stream_->shape().card;
        bus_ = stream_->shape().bus;
        stream_->abandon();
        stream_->stop();
        stream_.reset();
        item = source_news(SourceItemKind::lost, clock_->now_ns(),
                           traits_.name + " has vanished (" + why + "); it is sought");
    }

    bool seek(SourceItem &item)
    {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_seek_) {
            return false;
        }
        next_seek_ = now + std::chrono::milliseconds(SEEK_MS);
        std::string why;
        std::shared_ptr<V4l2Stream> found = try_open(place_.path, why);
        for (int i = 0; !found && !card_.empty() && i < DEVICES_MOST; ++i) {
            found = try_open("/dev/video" + std::to_string(i), why);
        }
        if (!found) {
            return false;
        }
        stream_ = std::move(found);
        lost_ = false;
        adopt();
        if (wanted_ && !begin(why)) {
            item = source_news(SourceItemKind::failed, clock_->now_ns(), why);
            lost_ = true;
            stream_.reset();
            return true;
        }
        item = source_news(SourceItemKind::back, clock_->now_ns(), traits_.name + " is there");
        return true;
    }

    std::shared_ptr<V4l2Stream> try_open(const std::string &path, std::string &why)
    {
        std::shared_ptr<V4l2Stream> stream = V4l2Stream::open(calls_, path, place_.size, why);
        const bool other = stream && !card_.empty() &&
                           (stream->shape().card != card_ || stream->shape().bus != bus_);
        return other ? nullptr : stream;
    }

    /* @return false on a time-out. */
    bool sleep(int left_ms)
    {
        std::shared_ptr<V4l2Stream> stream;
        bool readable = false, seeking = false;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            stream = stream_;
            readable = wanted_ && !lost_ && stream->has_queued();
            seeking = lost_;
        }
        const int ms = seeking && left_ms > SEEK_MS ? SEEK_MS : left_ms;
        pollfd fds[2] = {{bell_->fd(), POLLIN, 0}, {stream ? stream->fd() : -1, POLLIN, 0}};
        calls_->poll(fds, readable ? 2 : 1, ms);
        if (readable && (fds[1].revents & POLLIN) == 0 && fds[1].revents != 0) {
            calls_->poll(fds, 1, std::min(ms, NAP_MS)); /* an error that taking does not clear */
        }
        if ((fds[0].revents & POLLIN) != 0) {
            bell_->hush();
        }
        return ms < left_ms || fds[0].revents != 0 || (readable && fds[1].revents != 0);
    }

    const V4l2Place place_;
    const std::shared_ptr<HostClock> clock_;
    const std::shared_ptr<V4l2Calls> calls_;
    const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
    mutable std::mutex mutex_;
    std::shared_ptr<V4l2Stream> stream_; /* none while it is lost */
    SourceTraits traits_;
    V4l2Controls controls_;
    SourceStart start_;
    SourceCounters counters_;
    ExposureLog exposures_{UNSURE_FRAMES};
    std::string news_, card_, bus_;
    std::chrono::steady_clock::time_point next_seek_{};
    std::uint32_t last_sequence_ = 0;
    std::uint32_t broken_ = 0; /* in a row */
    bool has_last_ = false, wanted_ = false, lost_ = false, woken_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> open_v4l2_source(const V4l2Place &place, bool wait_for_missing,
                                              std::shared_ptr<HostClock> clock,
                                              std::shared_ptr<V4l2Calls> calls,
                                              std::string &error)
{
    if (!calls) {
        calls = std::make_shared<V4l2Calls>();
    }
    auto source = std::make_unique<V4l2Source>(place, std::move(clock), std::move(calls));
    if (!source->open(wait_for_missing, error)) {
        return nullptr;
    }
    return source;
}

}  // namespace opms_host
