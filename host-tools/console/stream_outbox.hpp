/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What waits to be sent to one client: bounded, the oldest goes first, and what had to go is told.
 *
 * One thread at a time (the server's). */
#ifndef OPMS_CONSOLE_STREAM_OUTBOX_HPP
#define OPMS_CONSOLE_STREAM_OUTBOX_HPP

#include <deque>

#include "stream_message.hpp"

namespace opms_host {

class StreamOutbox {
public:
    explicit StreamOutbox(std::size_t most) : most_(most) {}

    const StreamChoice &choice() const { return choice_; }
    /** For what comes from now on. */
    void choose(const StreamChoice &choice) { choice_ = choice; }

    void push(const StreamMessagePtr &message);
    /** An answer to the client's own message: it goes before all else and is never left out. The
     * server reads no further message of the client until it is sent. */
    void push_reply(std::string text);

    /** The next to be sent; NULL: nothing. What was missed is told by a message of its own
     * (opms.missed/1), at the place where it is missing. */
    std::shared_ptr<const std::string> pop();

    bool has_replies() const { return !replies_.empty(); }
    const StreamCounts &missed_total() const { return missed_total_; }

private:
    void miss(StreamKind kind, std::uint64_t count);

    struct Waiting {
        StreamMessagePtr message;
        bool squares;
    };
    const std::size_t most_;
    StreamChoice choice_;
    std::deque<std::shared_ptr<const std::string>> replies_;
    std::deque<Waiting> waiting_;
    StreamCounts missed_{}, missed_total_{};
};

}  // namespace opms_host
#endif
