/* SPDX-License-Identifier: Apache-2.0 */
/* A camera that no longer answers is given up and sought again by a keeper thread, because a search
 * over the network takes a second; so no call here waits for one. */
#include "aravis_source.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "aravis_camera.hpp"
#include "aravis_stream.hpp"
#include "source_queue.hpp"

namespace opms_host {
namespace {

constexpr auto SEEK_INTERVAL = std::chrono::milliseconds(500);

class AravisSource : public FrameSource {
public:
    AravisSource(AravisPlace place, std::shared_ptr<HostClock> clock)
        : place_(std::move(place)), clock_(std::move(clock))
    {
    }

    ~AravisSource() override
    {
        {
            const std::lock_guard<std::mutex> lock(keeper_mutex_);
            closing_ = true;
        }
        keeper_wakes_.notify_all();
        if (keeper_.joinable()) {
            keeper_.join();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        give_up();
    }

    bool open(bool wait_for_missing, std::string &error)
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!find(error)) {
            if (!wait_for_missing) {
                return false;
            }
            set_name("aravis:" + place_.name);
            queue_.push(source_news(SourceItemKind::lost, clock_->now_ns(), error));
            ask_to_seek();
        }
        keeper_ = std::thread([this] { keep(); });
        return true;
    }

    SourceTraits traits() const override
    {
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        return traits_;
    }

    bool start(const SourceStart &start, std::string &error) override
    {
        if (start.buffers < 2 || start.buffers > 1024) {
            error = "2 to 1024 buffers are possible";
            return false;
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        end_stream();
        queue_.drop_frames();
        start_ = start;
        count_anew();
        wanted_ = true;
        if (camera_) { /* else it begins when the camera comes */
            wanted_ = begin(error);
        }
        return wanted_;
    }

    void stop() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        wanted_ = false;
        end_stream();
        queue_.drop_frames();
    }

    void wait(std::uint32_t timeout_ms, SourceItem &item) override
    {
        queue_.wait(timeout_ms, item);
        if (item.kind == SourceItemKind::frame) {
            const std::lock_guard<std::mutex> lock(traits_mutex_);
            ++delivered_;
            damaged_ += (item.frame->flags & OPMS_FRAME_DAMAGED) != 0;
        }
    }
    void wake() override { queue_.wake(); }

    bool set_exposure(double exposure_us, double gain_db, std::string &error) override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!camera_) {
            error = traits().name + " is not there";
            return false;
        }
        ExposureSetting setting = {exposure_us, gain_db};
        if (!camera_->set_exposure(setting, error)) {
            return false;
        }
        start_.exposure_us = setting.exposure_us;
        start_.gain_db = setting.gain_db;
        if (stream_) {
            stream_->exposure_changed(setting);
        }
        return true;
    }

    SourceCounters counters() const override
    {
        std::shared_ptr<AravisStream> stream;
        SourceCounters counters;
        {
            const std::lock_guard<std::mutex> lock(traits_mutex_);
            counters = ended_;
            stream = counted_;
            counters.delivered = delivered_;
            counters.damaged = damaged_;
        }
        if (stream) {
            const SourceCounters now = stream->counters();
            counters.no_buffer += now.no_buffer;
            counters.failed += now.failed;
            counters.lent = now.lent;
            counters.buffers = now.buffers;
        }
        return counters;
    }

private:
    void set_name(const std::string &name)
    {
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        traits_.name = name;
    }

    void count_anew()
    {
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        ended_ = SourceCounters();
        delivered_ = damaged_ = 0;
    }

    /* The functions from here on to keep() are called with mutex_ held. */
    bool find(std::string &error)
    {
        camera_ = AravisCamera::open(place_, error);
        if (!camera_) {
            return false;
        }
        if (place_.name.empty()) {
            place_.name = camera_->id(); /* the same one again, should it vanish */
        }
        lost_handler_ = g_signal_connect(arv_camera_get_device(camera_->get()), "control-lost",
                                         G_CALLBACK(on_control_lost), this);
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        traits_ = camera_->traits();
        return true;
    }

    bool begin(std::string &error)
    {
        ExposureSetting setting;
        if (!camera_->prepare(start_, setting, error)) {
            return false;
        }
        stream_ = AravisStream::start(
            *camera_, start_.buffers, setting, clock_,
            [this](std::shared_ptr<Frame> frame) {
                SourceItem item;
                item.kind = SourceItemKind::frame;
                item.t_host_ns = frame->arrival_host_ns;
                item.frame = std::move(frame);
                queue_.push(std::move(item));
            },
            error);
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        counted_ = stream_;
        return stream_ != nullptr;
    }

    void end_stream()
    {
        if (!stream_) {
            return;
        }
        if (camera_) {
            GFailure failure;
            arv_camera_stop_acquisition(camera_->get(), failure.fresh());
        }
        const SourceCounters last = stream_->counters();
        stream_->stop();
        stream_.reset();
        const std::lock_guard<std::mutex> lock(traits_mutex_);
        counted_.reset();
        ended_.no_buffer += last.no_buffer;
        ended_.failed += last.failed;
    }

    void give_up()
    {
        end_stream();
        if (camera_) {
            g_signal_handler_disconnect(arv_camera_get_device(camera_->get()), lost_handler_);
            camera_.reset();
        }
    }

    static void on_control_lost(ArvDevice *, gpointer user)
    {
        static_cast<AravisSource *>(user)->ask_to_seek();
    }

    void ask_to_seek()
    {
        {
            const std::lock_guard<std::mutex> lock(keeper_mutex_);
            seek_ = true;
        }
        keeper_wakes_.notify_all();
    }

    void keep()
    {
        for (;;) {
            {
                std::unique_lock<std::mutex> lock(keeper_mutex_);
                keeper_wakes_.wait(lock, [this] { return closing_ || seek_; });
                if (closing_) {
                    return;
                }
                seek_ = false;
            }
            drop_lost();
            while (!try_find()) {
                std::unique_lock<std::mutex> lock(keeper_mutex_);
                if (keeper_wakes_.wait_for(lock, SEEK_INTERVAL, [this] { return closing_; })) {
                    return;
                }
            }
        }
    }

    void drop_lost()
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (camera_) {
            give_up();
            queue_.push(source_news(SourceItemKind::lost, clock_->now_ns(),
                                    traits().name + " no longer answers; it is sought"));
        }
    }

    bool try_find()
    {
        arv_update_device_list(); /* the slow part, without the lock */
        const std::lock_guard<std::mutex> lock(mutex_);
        std::string error;
        if (!find(error)) {
            return false;
        }
        if (wanted_ && !begin(error)) {
            give_up();
            if (error != last_refusal_) {
                last_refusal_ = error;
                queue_.push(source_news(SourceItemKind::failed, clock_->now_ns(), error));
            }
            return false;
        }
        last_refusal_.clear();
        queue_.push(source_news(SourceItemKind::back, clock_->now_ns(),
                                traits().name + " is there"));
        return true;
    }

    AravisPlace place_;
    const std::shared_ptr<HostClock> clock_;
    SourceQueue queue_;

    std::mutex mutex_; /* the camera, and what it shall do; calls to it take their time */
    std::unique_ptr<AravisCamera> camera_;
    std::shared_ptr<AravisStream> stream_;
    SourceStart start_;
    bool wanted_ = false;
    gulong lost_handler_ = 0;
    std::string last_refusal_;

    mutable std::mutex traits_mutex_; /* what can be had without waiting; taken last */
    SourceTraits traits_;
    SourceCounters ended_;
    std::shared_ptr<AravisStream> counted_;
    std::uint64_t delivered_ = 0, damaged_ = 0;

    std::mutex keeper_mutex_;
    std::condition_variable keeper_wakes_;
    bool closing_ = false, seek_ = false;
    std::thread keeper_;
};

}  // namespace

std::unique_ptr<FrameSource> open_aravis_source(const AravisPlace &place, bool wait_for_missing,
                                                std::shared_ptr<HostClock> clock,
                                                std::string &error)
{
    auto source = std::make_unique<AravisSource>(place, std::move(clock));
    if (!source->open(wait_for_missing, error)) {
        return nullptr;
    }
    return source;
}

std::vector<AravisEntry> list_aravis(std::string &problem)
{
    problem.clear();
    arv_update_device_list();
    std::vector<AravisEntry> entries;
    const auto text = [](const char *name) { return std::string(name ? name : ""); };
    for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
        entries.push_back({text(arv_get_device_id(i)),
                           text(arv_get_device_vendor(i)) + " " + text(arv_get_device_model(i)) +
                               " " + text(arv_get_device_serial_nbr(i)),
                           text(arv_get_device_protocol(i)), text(arv_get_device_address(i))});
    }
    return entries;
}

}  // namespace opms_host
