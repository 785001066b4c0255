/* SPDX-License-Identifier: Apache-2.0 */
#include "folder_source.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <mutex>
#include <utility>
#include <vector>

#include "lent_buffers.hpp"
#include "picture_file.hpp"
#include "source_queue.hpp"

namespace opms_host {
namespace {

namespace fs = std::filesystem;

bool has_picture_name(const fs::path &path)
{
    std::string suffix = path.extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    static const char *const known[] = {".png", ".jpg", ".jpeg", ".tif", ".tiff",
                                        ".bmp", ".pgm", ".pnm", ".ppm"};
    return std::find(std::begin(known), std::end(known), suffix) != std::end(known);
}

bool list_pictures(const std::string &folder, std::vector<std::string> &paths, std::string &error)
{
    std::error_code why;
    if (!fs::is_directory(folder, why)) {
        error = folder + (why ? ": " + why.message() : " is no folder of pictures");
        return false;
    }
    for (fs::directory_iterator it(folder, why), end; !why && it != end; it.increment(why)) {
        std::error_code ignored;
        if (has_picture_name(it->path()) && it->is_regular_file(ignored)) {
            paths.push_back(it->path().string());
        }
    }
    if (why) {
        error = folder + ": " + why.message();
        return false;
    }
    std::sort(paths.begin(), paths.end(), name_is_before);
    if (paths.empty()) {
        error = folder + " holds no pictures (PNG, JPEG, TIFF, BMP or PGM)";
    }
    return !paths.empty();
}

class FolderSource : public FrameSource {
public:
    FolderSource(std::string folder, std::vector<std::string> paths, const cv::Mat &first,
                 std::shared_ptr<HostClock> clock)
        : folder_(std::move(folder)), paths_(std::move(paths)), clock_(std::move(clock)),
          width_px_(first.cols), height_px_(first.rows)
    {
    }

    SourceTraits traits() const override
    {
        SourceTraits traits;
        traits.name = "replay:" + folder_;
        traits.model = std::to_string(paths_.size()) + " pictures";
        traits.width_px = width_px_;
        traits.height_px = height_px_;
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
        next_ = 0;
        running_ = true;
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
        std::size_t index = 0;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            buffers = buffers_;
            index = next_;
            if (running_ && next_ >= paths_.size()) {
                item = source_news(SourceItemKind::end, clock_->now_ns(),
                                   "the end of " + folder_);
                return;
            }
        }
        if (!buffers->wait_for_free(timeout_ms)) {
            return;
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        if (running_ && next_ == index && buffers == buffers_) {
            ++next_;
            read(index, item);
        }
    }

    void wake() override
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        buffers_->wake();
    }

    bool set_exposure(double, double, std::string &error) override
    {
        error = "pictures of a folder have been taken already";
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
    void read(std::size_t index, SourceItem &item)
    {
        std::string why;
        cv::Mat picture = picture_read(paths_[index], width_px_, height_px_, why);
        if (picture.empty()) {
            ++counters_.failed;
            item = source_news(SourceItemKind::failed, clock_->now_ns(), paths_[index] + " " + why);
            return;
        }
        const auto grey = std::make_shared<const cv::Mat>(picture_grey(picture));
        auto frame = std::make_shared<Frame>();
        frame->image = picture_view(*grey, 0);
        frame->frame_id = index + 1;
        frame->flags = OPMS_FRAME_NO_ID | OPMS_FRAME_NO_TIME;
        frame->arrival_host_ns = clock_->now_ns();
        frame->memory = buffers_->lend(std::shared_ptr<const void>(grey));
        ++counters_.delivered;
        item.kind = SourceItemKind::frame;
        item.t_host_ns = frame->arrival_host_ns;
        item.frame = std::move(frame);
    }

    const std::string folder_;
    const std::vector<std::string> paths_;
    const std::shared_ptr<HostClock> clock_;
    const std::int32_t width_px_, height_px_;
    mutable std::mutex mutex_;
    std::shared_ptr<LentBuffers> buffers_ = LentBuffers::create(2);
    SourceCounters counters_;
    std::size_t next_ = 0;
    bool running_ = false;
};

}  // namespace

bool name_is_before(const std::string &a, const std::string &b)
{
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (digit(a[i]) && digit(b[j])) {
            const auto run = [&digit](const std::string &text, std::size_t &at) {
                while (at + 1 < text.size() && text[at] == '0' && digit(text[at + 1])) {
                    ++at;
                }
                const std::size_t from = at;
                while (at < text.size() && digit(text[at])) {
                    ++at;
                }
                return text.substr(from, at - from);
            };
            const std::string x = run(a, i), y = run(b, j);
            if (x != y) {
                return x.size() != y.size() ? x.size() < y.size() : x < y;
            }
        } else if (a[i] != b[j]) {
            return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
        } else {
            ++i;
            ++j;
        }
    }
    /* Alike but for leading zeros, or one is the other's beginning. */
    const bool a_ended = i >= a.size(), b_ended = j >= b.size();
    return a_ended && b_ended ? a < b : a_ended;
}

std::unique_ptr<FrameSource> open_folder_source(const std::string &folder,
                                                std::shared_ptr<HostClock> clock,
                                                std::string &error)
{
    std::vector<std::string> paths;
    if (!list_pictures(folder, paths, error)) {
        return nullptr;
    }
    std::string why;
    const cv::Mat first = picture_read_any(paths.front(), why);
    if (first.empty()) {
        error = paths.front() + " " + why;
        return nullptr;
    }
    return std::make_unique<FolderSource>(folder, std::move(paths), first, std::move(clock));
}

}  // namespace opms_host
