/* SPDX-License-Identifier: Apache-2.0 */
#include <mutex>
#include <utility>

#include "lent_buffers.hpp"
#include "picture_file.hpp"
#include "replay_box.hpp"
#include "source_queue.hpp"

namespace opms_host {
namespace {

class ReplayCamera : public FrameSource {
public:
    explicit ReplayCamera(std::shared_ptr<ReplayScan> scan) : scan_(std::move(scan)) {}

    SourceTraits traits() const override
    {
        const ScanHeader &header = scan_->header();
        SourceTraits traits;
        traits.name = "replay:" + scan_->folder();
        traits.model = header.source_model.empty() ? header.source_name : header.source_model;
        traits.width_px = header.width_px;
        traits.height_px = header.height_px;
        traits.profile = header.camera_profile;
        traits.can_trigger = true; /* it followed, when it was recorded */
        traits.live = false;
        return traits;
    }

    bool start(const SourceStart &start, std::string &error) override
    {
        if (start.buffers < 2 || start.buffers > 1024) {
            error = "2 to 1024 buffers are possible";
            return false;
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        buffers_ = LentBuffers::create(start.buffers);
        counters_ = SourceCounters();
        scan_->rewind_camera();
        running_ = true;
        missing_told_ = scan_->frames_without_picture() == 0;
        return true;
    }
    void stop() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        running_ = false;
    }

    void wait(std::uint32_t timeout_ms, SourceItem &item) override
    {
        item = SourceItem();
        std::shared_ptr<LentBuffers> buffers;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            if (running_ && !std::exchange(missing_told_, true)) {
                counters_.failed += scan_->frames_without_picture();
                item = source_news(SourceItemKind::failed, scan_->now_ns(),
                                   std::to_string(scan_->frames_without_picture()) +
                                       " frames of the recording have no stored picture");
                return;
            }
            buffers = running_ ? buffers_ : nullptr;
        }
        ReplayFrame next;
        if (!buffers || !buffers->wait_for_free(timeout_ms)) {
            return;
        }
        const ReplayScan::Took took = scan_->take_frame(timeout_ms, next);
        if (took == ReplayScan::Took::end) {
            item = source_news(SourceItemKind::end, scan_->now_ns(), "the end of the recording");
        } else if (took == ReplayScan::Took::item) {
            read(next, buffers, item);
        }
    }
    void wake() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        buffers_->wake();
        scan_->wake_camera();
    }

    bool set_exposure(double, double, std::string &error) override
    {
        error = "the pictures of a recording have been taken already";
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
    void read(const ReplayFrame &next, const std::shared_ptr<LentBuffers> &buffers,
              SourceItem &item)
    {
        const ScanHeader &header = scan_->header();
        std::string why;
        const cv::Mat picture =
            picture_read(next.path, header.width_px, header.height_px, why);
        const std::lock_guard<std::mutex> lock(mutex_);
        if (picture.empty()) {
            ++counters_.failed;
            item = source_news(SourceItemKind::failed, scan_->now_ns(), next.path + " " + why);
            return;
        }
        const auto grey = std::make_shared<const cv::Mat>(picture_grey(picture));
        auto frame = std::make_shared<Frame>();
        frame->image = picture_view(*grey, next.record.white_level);
        frame->frame_id = next.record.frame_id;
        frame->camera_time_ticks = next.record.camera_time_ticks;
        frame->arrival_host_ns = next.record.arrival_host_ns;
        frame->flags = next.record.flags;
        frame->exposure_us = next.record.exposure_us;
        frame->gain_db = next.record.gain_db;
        frame->memory = buffers->lend(std::shared_ptr<const void>(grey));
        ++counters_.delivered;
        counters_.damaged += (frame->flags & OPMS_FRAME_DAMAGED) != 0;
        item.kind = SourceItemKind::frame;
        item.t_host_ns = frame->arrival_host_ns;
        item.frame = std::move(frame);
    }

    const std::shared_ptr<ReplayScan> scan_;
    mutable std::mutex mutex_;
    std::shared_ptr<LentBuffers> buffers_ = LentBuffers::create(2);
    SourceCounters counters_;
    bool running_ = false, missing_told_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> make_replay_camera(std::shared_ptr<ReplayScan> scan)
{
    return std::make_unique<ReplayCamera>(std::move(scan));
}

}  // namespace opms_host
