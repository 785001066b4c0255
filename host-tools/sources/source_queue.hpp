/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a camera's own thread hands to the one that waits. */
#ifndef OPMS_SOURCES_SOURCE_QUEUE_HPP
#define OPMS_SOURCES_SOURCE_QUEUE_HPP

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>

#include "frame_source.hpp"

namespace opms_host {

/** Any thread, any time. The buffers of the camera bound it, not the queue. */
class SourceQueue {
public:
    void push(SourceItem item);
    /** The oldest item; its kind is none after @p timeout_ms, or after wake(). */
    void wait(std::uint32_t timeout_ms, SourceItem &item);
    void wake();
    /** Frames go back unseen; news stay. */
    void drop_frames();

private:
    std::mutex mutex_;
    std::condition_variable came_;
    std::deque<SourceItem> items_;
    bool woken_ = false;
};

/** News that is no frame. */
SourceItem source_news(SourceItemKind kind, std::int64_t t_host_ns, std::string text);

}  // namespace opms_host
#endif
