/* SPDX-License-Identifier: Apache-2.0 */
#include "preview_source.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include "lent_buffers.hpp"
#include "picture_file.hpp"
#include "preview_camera.hpp"
#include "program_module.hpp"
#include "source_queue.hpp"

namespace opms_host {
namespace {

constexpr auto RETRY = std::chrono::milliseconds(500);

class PreviewSource : public FrameSource {
public:
    PreviewSource(int number, std::shared_ptr<HostClock> clock,
                  std::unique_ptr<PreviewCamera> camera)
        : number_(number), clock_(std::move(clock)), camera_(std::move(camera))
    {
    }
    ~PreviewSource() override { stop(); }

    bool open(std::string &error)
    {
        cv::Mat picture;
        if (!camera_->open(number_) || !camera_->read(picture) || picture.empty()) {
            error = "OpenCV finds no camera " + std::to_string(number_) +
                    "; see the list of cameras";
            return false;
        }
        traits_.name = "preview:" + std::to_string(number_);
        traits_.model = camera_->backend();
        traits_.width_px = picture.cols;
        traits_.height_px = picture.rows;
        traits_.preview_only = true;
        return true;
    }

    SourceTraits traits() const override { return traits_; }

    bool start(const SourceStart &start, std::string &error) override
    {
        if (start.hardware_trigger) {
            error = traits_.name + " is for a look only: it does not follow the box";
            return false;
        }
        stop();
        const std::lock_guard<std::mutex> lock(mutex_);
        buffers_ = LentBuffers::create(start.buffers);
        counters_ = SourceCounters();
        running_ = true;
        reader_ = std::thread([this] { read(); });
        return true;
    }

    void stop() override
    {
        running_ = false;
        if (reader_.joinable()) {
            reader_.join(); /* within one picture of the camera */
        }
        queue_.drop_frames();
    }

    void wait(std::uint32_t timeout_ms, SourceItem &item) override
    {
        queue_.wait(timeout_ms, item);
        if (item.kind == SourceItemKind::frame) {
            const std::lock_guard<std::mutex> lock(mutex_);
            ++counters_.delivered;
        }
    }
    void wake() override { queue_.wake(); }

    bool set_exposure(double, double, std::string &error) override
    {
        error = traits_.name + " is for a look only: its exposure is its own";
        return false;
    }

    SourceCounters counters() const override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        SourceCounters counters = counters_;
        counters.lent = buffers_->lent();
        counters.buffers = buffers_->most();
        return counters;
    }

private:
    void read()
    {
        bool lost = false;
        while (running_) {
            cv::Mat picture;
            if (!camera_->read(picture) || picture.empty()) {
                tell(lost, true);
                std::this_thread::sleep_for(RETRY);
                camera_->open(number_);
                continue;
            }
            tell(lost, false);
            hand_over(picture);
        }
    }

    void tell(bool &lost, bool is_lost)
    {
        if (lost != is_lost) {
            lost = is_lost;
            queue_.push(source_news(lost ? SourceItemKind::lost : SourceItemKind::back,
                                    clock_->now_ns(),
                                    traits_.name + (lost ? " gives no pictures" : " is there")));
        }
    }

    void hand_over(const cv::Mat &picture)
    {
        const auto grey = std::make_shared<const cv::Mat>(picture_grey(picture).clone());
        const std::lock_guard<std::mutex> lock(mutex_);
        if (grey->cols != traits_.width_px || grey->rows != traits_.height_px) {
            ++counters_.failed;
            return;
        }
        if (buffers_->lent() >= buffers_->most()) {
            ++counters_.no_buffer;
            return;
        }
        auto frame = std::make_shared<Frame>();
        frame->image = picture_view(*grey, 0);
        frame->frame_id = ++frames_;
        frame->flags = OPMS_FRAME_NO_ID | OPMS_FRAME_NO_TIME;
        frame->arrival_host_ns = clock_->now_ns();
        frame->memory = buffers_->lend(std::shared_ptr<const void>(grey));
        SourceItem item;
        item.kind = SourceItemKind::frame;
        item.t_host_ns = frame->arrival_host_ns;
        item.frame = std::move(frame);
        queue_.push(std::move(item));
    }

    const int number_;
    const std::shared_ptr<HostClock> clock_;
    const std::unique_ptr<PreviewCamera> camera_;
    SourceTraits traits_;
    SourceQueue queue_;
    std::thread reader_;
    std::atomic<bool> running_{false};
    mutable std::mutex mutex_;
    std::shared_ptr<LentBuffers> buffers_ = LentBuffers::create(2);
    SourceCounters counters_;
    std::uint64_t frames_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> open_preview_source(int number, std::shared_ptr<HostClock> clock,
                                                 std::string &error)
{
    const auto make = reinterpret_cast<decltype(&opms_preview_camera)>(
        program_module_symbol("opms_preview.so", "opms_preview_camera", error));
    if (!make) {
        return nullptr;
    }
    auto source = std::make_unique<PreviewSource>(number, std::move(clock),
                                                  std::unique_ptr<PreviewCamera>(make()));
    if (!source->open(error)) {
        return nullptr;
    }
    return source;
}

}  // namespace opms_host
