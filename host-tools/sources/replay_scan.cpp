/* SPDX-License-Identifier: Apache-2.0 */
#include "replay_scan.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <unordered_map>

#include "recorded_items.hpp"
#include "scan_reader.hpp"

namespace opms_host {

constexpr std::int64_t NEVER = std::numeric_limits<std::int64_t>::max();

std::shared_ptr<ReplayScan> ReplayScan::open(const std::string &folder, std::string &error)
{
    auto scan = std::make_shared<ReplayScan>();
    return scan->read(folder, error) ? scan : nullptr;
}

bool ReplayScan::read(const std::string &folder, std::string &error)
{
    const std::unique_ptr<ScanReader> reader = ScanReader::open(folder, error);
    if (!reader || !recorded_items(*reader, items_, error)) {
        return false;
    }
    header_ = reader->summary().header;
    folder_ = folder;
    std::unordered_map<std::uint64_t, std::string> paths;
    const bool good = reader->each_picture(
                          [&paths](const PictureRow &row) {
                              paths.emplace(row.number, row.path);
                              return true;
                          },
                          error) &&
                      reader->each_frame(
                          [this, &paths](const FrameRecord &record) {
                              const auto found = paths.find(record.number);
                              if (found == paths.end()) {
                                  ++without_picture_;
                              } else {
                                  frames_.push_back({record, found->second});
                              }
                              return true;
                          },
                          error);
    now_ns_ = header_.begun_host_ns;
    if (!items_.empty()) {
        now_ns_ = std::min(now_ns_, items_.front().t_host_ns);
    }
    return good;
}

std::int64_t ReplayScan::now_ns() const
{
    const std::lock_guard<std::mutex> lock(mutex_);
    return now_ns_;
}

std::int64_t ReplayScan::wall_ns() const
{
    return header_.begun_wall_ns + (now_ns() - header_.begun_host_ns);
}

void ReplayScan::use(bool box, bool camera)
{
    const std::lock_guard<std::mutex> lock(mutex_);
    has_box_ = box;
    has_camera_ = camera;
}

void ReplayScan::arm(std::uint32_t session_id)
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        session_id_ = session_id;
    }
    moved_.notify_all();
}

void ReplayScan::rewind_camera()
{
    const std::lock_guard<std::mutex> lock(mutex_);
    next_frame_ = 0;
}

std::int64_t ReplayScan::next_box_ns() const
{
    return has_box_ && next_item_ < items_.size() ? items_[next_item_].t_host_ns : NEVER;
}

std::int64_t ReplayScan::next_frame_ns() const
{
    return has_camera_ && next_frame_ < frames_.size()
               ? frames_[next_frame_].record.arrival_host_ns : NEVER;
}

/* Before it is armed, a box gives what the scan's began with: its answers to pings. */
bool ReplayScan::is_box_due() const
{
    const std::int64_t next_ns = next_box_ns();
    return next_ns != NEVER && (session_id_ != 0 ? next_ns <= next_frame_ns()
                                                 : next_ns < header_.begun_host_ns);
}

bool ReplayScan::is_frame_due() const
{
    const std::int64_t next_ns = next_frame_ns();
    return next_ns != NEVER && (!has_box_ || (session_id_ != 0 && next_ns < next_box_ns()));
}

ReplayScan::Took ReplayScan::take_box(std::uint32_t timeout_ms, opms_box_item_t &item)
{
    {
        std::unique_lock<std::mutex> lock(mutex_);
        moved_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [this] {
            return is_box_due() || box_woken_ || next_item_ >= items_.size();
        });
        if (!is_box_due()) {
            box_woken_ = false;
            return next_item_ >= items_.size() ? Took::end : Took::none;
        }
        item = items_[next_item_++];
        now_ns_ = std::max(now_ns_, item.t_host_ns);
        std::uint32_t *const session = item_session(item);
        if (session && *session == header_.session_id && session_id_ != 0) {
            *session = session_id_;
        }
    }
    moved_.notify_all();
    return Took::item;
}

ReplayScan::Took ReplayScan::take_frame(std::uint32_t timeout_ms, ReplayFrame &frame)
{
    {
        std::unique_lock<std::mutex> lock(mutex_);
        moved_.wait_for(lock, std::chrono::milliseconds(timeout_ms), [this] {
            return is_frame_due() || camera_woken_ || next_frame_ >= frames_.size();
        });
        if (!is_frame_due()) {
            camera_woken_ = false;
            return next_frame_ >= frames_.size() ? Took::end : Took::none;
        }
        frame = frames_[next_frame_++];
        now_ns_ = std::max(now_ns_, frame.record.arrival_host_ns);
    }
    moved_.notify_all();
    return Took::item;
}

void ReplayScan::wake_box()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        box_woken_ = true;
    }
    moved_.notify_all();
}

void ReplayScan::wake_camera()
{
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        camera_woken_ = true;
    }
    moved_.notify_all();
}

}  // namespace opms_host
