/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Tells the listeners, by a thread of its own, so that a slow one holds up nothing but itself for
 * as long as there is room. */
#ifndef OPMS_ENGINE_PUBLISHER_HPP
#define OPMS_ENGINE_PUBLISHER_HPP

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include "scan_listener.hpp"

namespace opms_host {

/** Poses, states and events go out in the order in which they came in, all of them. Pictures are
 * for a display: only the newest one waits, and it goes out when nothing else does. Any thread. */
class Publisher {
public:
    /** @param room  Items that may wait before wait_for_room() waits. */
    explicit Publisher(std::size_t room) : room_(room) {}
    ~Publisher();

    /** Before start(). */
    void add_listener(ScanListener *listener);
    void start();
    /** Tell all that waits, then end. */
    void stop();

    /** None of these ever waits. */
    void state(const SessionStatus &status);
    void event(const EventRecord &event);
    void pose(std::shared_ptr<const PoseRecord> pose);
    void picture(FramePtr picture, std::shared_ptr<const PoseRecord> pose,
                 std::shared_ptr<const GridRecord> grid);

    /** Wait until there is room for more poses: who makes them slows down.
     * @return false: stopped. */
    bool wait_for_room();
    /** Wait until all that came in has gone out, 2 s at most: a listener may be slow. */
    void wait_until_told();
    /** Pictures that were not shown. */
    std::uint64_t display_dropped() const;
    /** Count one that was not even handed over. */
    void count_dropped();
    /** Let go of the picture that waits. */
    void drop_picture();

private:
    using Item = std::variant<SessionStatus, EventRecord, std::shared_ptr<const PoseRecord>>;
    struct Display {
        FramePtr picture;
        std::shared_ptr<const PoseRecord> pose;
        std::shared_ptr<const GridRecord> grid;
    };
    void put(Item item);
    void run();
    void tell(const Item &item);
    void tell(const Display &display);

    const std::size_t room_;
    std::vector<ScanListener *> listeners_;
    mutable std::mutex mutex_;
    std::condition_variable filled_, taken_;
    std::deque<Item> items_;
    Display display_;
    std::uint64_t display_dropped_ = 0;
    bool busy_ = false, stopped_ = false;
    std::thread thread_;
};

}  // namespace opms_host
#endif
