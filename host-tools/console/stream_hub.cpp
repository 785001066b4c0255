/* SPDX-License-Identifier: Apache-2.0 */
#include "stream_hub.hpp"

#include "json_limits.hpp"
#include "scan_json.hpp"

namespace opms_host {

namespace {

StreamMessage message_of(const PoseRecord &pose, bool with_squares)
{
    StreamMessage message;
    message.kind = StreamKind::pose;
    message.text = json_text(pose_json(pose, PoseDetail::pose));
    if (with_squares) {
        message.text_squares = json_text(pose_json(pose, PoseDetail::squares));
    }
    return message;
}

}  // namespace

StreamHub::StreamHub(std::size_t capacity) : queue_(capacity)
{
    sem_init(&news_, 0, 0);
    thread_ = std::thread([this] { run(); });
}

StreamHub::~StreamHub()
{
    ends_ = true;
    sem_post(&news_);
    thread_.join();
    sem_destroy(&news_);
}

/* Neither the queue nor sem_post() waits; see publish_queue.hpp. */
void StreamHub::publish(StreamKind kind, Item item)
{
    const auto index = static_cast<std::size_t>(kind);
    if (!queue_.push(item)) {
        lost_[index].fetch_add(1, std::memory_order_relaxed);
    }
    published_[index].fetch_add(1, std::memory_order_relaxed);
    sem_post(&news_);
}

void StreamHub::on_state(const SessionStatus &status)
{
    publish(StreamKind::state, std::make_shared<const SessionStatus>(status));
}

void StreamHub::on_pose(const std::shared_ptr<const PoseRecord> &pose)
{
    publish(StreamKind::pose, pose);
}

void StreamHub::on_event(const EventRecord &event)
{
    publish(StreamKind::event, event);
}

void StreamHub::run()
{
    for (;;) {
        while (sem_wait(&news_) != 0) { /* a signal came in between */
        }
        Item item;
        while (queue_.pop(item)) {
            take(item);
        }
        if (ends_) {
            return;
        }
    }
}

void StreamHub::take(const Item &item)
{
    auto message = std::make_shared<StreamMessage>();
    if (const auto *pose = std::get_if<std::shared_ptr<const PoseRecord>>(&item)) {
        *message = message_of(**pose, squares_wanted_ > 0);
    } else if (const auto *event = std::get_if<EventRecord>(&item)) {
        message->kind = StreamKind::event;
        message->text = json_text(event_json(*event));
    } else if (const auto *status = std::get_if<std::shared_ptr<const SessionStatus>>(&item)) {
        message->kind = StreamKind::state;
        message->text = json_text(status_json(**status));
    }
    const StreamCounts lost_now = lost();
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        message->lost[kind] = lost_now[kind] - lost_told_[kind];
    }
    lost_told_ = lost_now;
    {
        const std::lock_guard<std::mutex> lock(newest_mutex_);
        if (const auto *pose = std::get_if<std::shared_ptr<const PoseRecord>>(&item)) {
            newest_pose_ = *pose;
        } else if (message->kind == StreamKind::state) {
            newest_state_ = message;
        }
    }
    const std::lock_guard<std::mutex> lock(sink_mutex_);
    if (sink_) {
        sink_(message);
    }
}

void StreamHub::set_sink(Sink sink)
{
    const std::lock_guard<std::mutex> lock(sink_mutex_);
    sink_ = std::move(sink);
}

std::shared_ptr<const PoseRecord> StreamHub::newest_pose() const
{
    const std::lock_guard<std::mutex> lock(newest_mutex_);
    return newest_pose_;
}

StreamMessagePtr StreamHub::newest_state() const
{
    const std::lock_guard<std::mutex> lock(newest_mutex_);
    return newest_state_;
}

StreamCounts StreamHub::published() const
{
    StreamCounts counts{};
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        counts[kind] = published_[kind].load(std::memory_order_relaxed);
    }
    return counts;
}

StreamCounts StreamHub::lost() const
{
    StreamCounts counts{};
    for (std::size_t kind = 0; kind < STREAM_KINDS; kind++) {
        counts[kind] = lost_[kind].load(std::memory_order_relaxed);
    }
    return counts;
}

}  // namespace opms_host
