/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * From the session's threads to the one that writes and draws. */
#ifndef OPMS_CLI_SCAN_FEED_HPP
#define OPMS_CLI_SCAN_FEED_HPP

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <variant>

#include "scan_listener.hpp"

/** Keeps what happened until it is taken, so that a slow terminal or a full pipe never holds up a
 * session. Beyond MOST items the oldest poses go, and how many is told. */
class ScanFeed : public opms_host::ScanListener {
public:
    using Pose = std::shared_ptr<const opms_host::PoseRecord>;
    using Item = std::variant<Pose, opms_host::EventRecord, opms_host::SessionStatus>;
    static constexpr std::size_t MOST = 100'000;

    void on_state(const opms_host::SessionStatus &status) override;
    void on_pose(const Pose &pose) override;
    void on_event(const opms_host::EventRecord &event) override;

    /** All that came, after at most @p timeout_ms where nothing did.
     * @return Items that were left out since the last call. */
    std::uint64_t take(std::uint32_t timeout_ms, std::deque<Item> &items);

private:
    void push(Item item);

    std::mutex mutex_;
    std::condition_variable came_;
    std::deque<Item> items_;
    std::uint64_t left_out_ = 0;
};

#endif
