/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A recorded scan, laid out as what its box and its camera gave, in the order of its time.
 *
 * Box and camera are taken from by different threads; each waits until what the other one gave
 * before has been taken, so that a replay is in order however fast it runs. */
#ifndef OPMS_SOURCES_REPLAY_SCAN_HPP
#define OPMS_SOURCES_REPLAY_SCAN_HPP

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <opms/hid.h>

#include "host_clock.hpp"
#include "scan_records.hpp"

namespace opms_host {

/** A stored picture and its frame. */
struct ReplayFrame {
    FrameRecord record;
    std::string path;
};

/** Any thread, any time. Its clock is the scan's: it stands at what was taken last. */
class ReplayScan : public HostClock {
public:
    /** @return NULL where the scan cannot be read. */
    static std::shared_ptr<ReplayScan> open(const std::string &folder, std::string &error);

    const ScanHeader &header() const { return header_; }
    const std::string &folder() const { return folder_; }
    std::uint64_t frames_without_picture() const { return without_picture_; }
    std::int64_t now_ns() const override;
    std::int64_t wall_ns() const override;

    /** Which of them take part; before anything is taken. */
    void use(bool box, bool camera);
    /** The box is armed: what came after the beginning of the scan may be taken. */
    void arm(std::uint32_t session_id);
    /** The camera begins: from its first picture. */
    void rewind_camera();

    enum class Took { item, none, end };
    /** The next one, once it is due. Sessions have the id of arm(). */
    Took take_box(std::uint32_t timeout_ms, opms_box_item_t &item);
    Took take_frame(std::uint32_t timeout_ms, ReplayFrame &frame);
    /** End a wait, and the next one if none is going on. */
    void wake_box();
    void wake_camera();

private:
    bool read(const std::string &folder, std::string &error);
    bool is_box_due() const;
    bool is_frame_due() const;
    std::int64_t next_box_ns() const;
    std::int64_t next_frame_ns() const;

    ScanHeader header_;
    std::string folder_;
    std::vector<opms_box_item_t> items_;
    std::vector<ReplayFrame> frames_;
    std::uint64_t without_picture_ = 0;

    mutable std::mutex mutex_;
    std::condition_variable moved_;
    std::size_t next_item_ = 0, next_frame_ = 0;
    std::int64_t now_ns_ = 0;
    std::uint32_t session_id_ = 0; /* 0: not armed */
    bool has_box_ = false, has_camera_ = false;
    bool box_woken_ = false, camera_woken_ = false;
};

}  // namespace opms_host
#endif
