/* SPDX-License-Identifier: Apache-2.0 */
#include "publisher.hpp"

#include <chrono>
#include <utility>

namespace opms_host {

Publisher::~Publisher()
{
    stop();
}

void Publisher::add_listener(ScanListener *listener)
{
    listeners_.push_back(listener);
}

void Publisher::start()
{
    thread_ = std::thread([this] { run(); });
}

void Publisher::stop()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopped_ = true;
        filled_.notify_all();
        taken_.notify_all();
    }
    if (thread_.joinable()) {
        thread_.join();
    }
}

void Publisher::put(Item item)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    items_.push_back(std::move(item));
    filled_.notify_one();
}

void Publisher::state(const SessionStatus &status)
{
    put(status);
}

void Publisher::event(const EventRecord &event)
{
    put(event);
}

void Publisher::pose(std::shared_ptr<const PoseRecord> pose)
{
    put(std::move(pose));
}

void Publisher::picture(FramePtr picture, std::shared_ptr<const PoseRecord> pose,
                        std::shared_ptr<const GridRecord> grid)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    display_dropped_ += display_.picture != nullptr;
    display_ = {std::move(picture), std::move(pose), std::move(grid)};
    filled_.notify_one();
}

bool Publisher::wait_for_room()
{
    std::unique_lock<std::mutex> lock(mutex_);
    taken_.wait(lock, [this] { return stopped_ || items_.size() < room_; });
    return !stopped_;
}

void Publisher::wait_until_told()
{
    std::unique_lock<std::mutex> lock(mutex_);
    taken_.wait_for(lock, std::chrono::seconds(2),
                    [this] { return stopped_ || (items_.empty() && !busy_); });
}

std::uint64_t Publisher::display_dropped() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return display_dropped_;
}

void Publisher::count_dropped()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    ++display_dropped_;
}

void Publisher::drop_picture()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    display_dropped_ += display_.picture != nullptr;
    display_ = Display();
}

void Publisher::run()
{
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
        filled_.wait(lock, [this] { return stopped_ || !items_.empty() || display_.picture; });
        if (items_.empty() && (stopped_ || !display_.picture)) {
            return;
        }
        busy_ = true;
        if (!items_.empty()) {
            const Item item = std::move(items_.front());
            items_.pop_front();
            taken_.notify_all();
            lock.unlock();
            tell(item);
        } else {
            const Display display = std::exchange(display_, Display());
            lock.unlock();
            tell(display);
        }
        lock.lock();
        busy_ = false;
        taken_.notify_all();
    }
}

void Publisher::tell(const Item &item)
{
    for (ScanListener *listener : listeners_) {
        if (const auto *status = std::get_if<SessionStatus>(&item)) {
            listener->on_state(*status);
        } else if (const auto *event = std::get_if<EventRecord>(&item)) {
            listener->on_event(*event);
        } else {
            listener->on_pose(std::get<std::shared_ptr<const PoseRecord>>(item));
        }
    }
}

void Publisher::tell(const Display &display)
{
    for (ScanListener *listener : listeners_) {
        if (display.grid) {
            listener->on_grid(display.grid);
        }
        listener->on_picture(display.picture, display.pose);
    }
}

}  // namespace opms_host
