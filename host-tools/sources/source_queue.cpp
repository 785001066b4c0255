/* SPDX-License-Identifier: Apache-2.0 */
#include "source_queue.hpp"

#include <chrono>
#include <utility>

namespace opms_host {

void SourceQueue::push(SourceItem item)
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        items_.push_back(std::move(item));
    }
    came_.notify_one();
}

void SourceQueue::wait(std::uint32_t timeout_ms, SourceItem &item)
{
    item = SourceItem();
    std::unique_lock<std::mutex> lock(mutex_);
    came_.wait_for(lock, std::chrono::milliseconds(timeout_ms),
                   [this] { return !items_.empty() || woken_; });
    if (!items_.empty()) {
        item = std::move(items_.front());
        items_.pop_front();
    } else {
        woken_ = false;
    }
}

void SourceQueue::wake()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        woken_ = true;
    }
    came_.notify_all();
}

void SourceQueue::drop_frames()
{
    std::deque<SourceItem> gone; /* given back without the lock: that may call into the camera */
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        std::deque<SourceItem> news;
        for (SourceItem &item : items_) {
            (item.kind == SourceItemKind::frame ? gone : news).push_back(std::move(item));
        }
        items_ = std::move(news);
    }
}

SourceItem source_news(SourceItemKind kind, std::int64_t t_host_ns, std::string text)
{
    SourceItem item;
    item.kind = kind;
    item.t_host_ns = t_host_ns;
    item.text = std::move(text);
    return item;
}

}  // namespace opms_host
