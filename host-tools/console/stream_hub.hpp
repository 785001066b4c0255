/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From the session's threads to all who listen: takes what they publish without ever making them
 * wait, makes text of it on a thread of its own, once for all clients, and hands that on.
 *
 *     session's threads --PublishQueue--> hub's thread --text--> sink (the server's clients) */
#ifndef OPMS_CONSOLE_STREAM_HUB_HPP
#define OPMS_CONSOLE_STREAM_HUB_HPP

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>

#include <semaphore.h>

#include "publish_queue.hpp"
#include "scan_listener.hpp"
#include "stream_message.hpp"

namespace opms_host {

class StreamHub : public ScanListener {
public:
    /** A minute at 60 Hz. */
    static constexpr std::size_t CAPACITY = 4096;

    explicit StreamHub(std::size_t capacity = CAPACITY);
    ~StreamHub() override;
    StreamHub(const StreamHub &) = delete;
    StreamHub &operator=(const StreamHub &) = delete;

    void on_state(const SessionStatus &status) override;
    void on_pose(const std::shared_ptr<const PoseRecord> &pose) override;
    void on_event(const EventRecord &event) override;

    using Sink = std::function<void(const StreamMessagePtr &message)>;
    /** Who gets all messages, called by the hub's thread; empty: nobody. Returns when the old one
     * is not called any more. */
    void set_sink(Sink sink);
    /** How many clients want the squares; without any they are not made into text. */
    void want_squares(int change) { squares_wanted_ += change; }

    /** NULL before the first. */
    std::shared_ptr<const PoseRecord> newest_pose() const;
    StreamMessagePtr newest_state() const;

    /** Published so far, and of them what found the queue full. */
    StreamCounts published() const;
    StreamCounts lost() const;

private:
    using Item = std::variant<std::monostate, std::shared_ptr<const PoseRecord>, EventRecord,
                              std::shared_ptr<const SessionStatus>>;
    void publish(StreamKind kind, Item item);
    void run();
    void take(const Item &item);

    PublishQueue<Item> queue_;
    std::array<std::atomic<std::uint64_t>, STREAM_KINDS> published_{}, lost_{};
    StreamCounts lost_told_{}; /* the thread's own */
    std::atomic<int> squares_wanted_{0};
    std::atomic<bool> ends_{false};
    sem_t news_;

    std::mutex sink_mutex_; /* the hub's thread and set_sink(): never a session's thread */
    Sink sink_;
    mutable std::mutex newest_mutex_; /* the hub's thread and requests */
    std::shared_ptr<const PoseRecord> newest_pose_;
    StreamMessagePtr newest_state_;
    std::thread thread_;
};

}  // namespace opms_host
#endif
