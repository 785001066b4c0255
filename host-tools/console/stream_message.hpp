/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What goes to the clients of the stream: text that is made once for all of them. */
#ifndef OPMS_CONSOLE_STREAM_MESSAGE_HPP
#define OPMS_CONSOLE_STREAM_MESSAGE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace opms_host {

enum class StreamKind : std::size_t { pose, event, state };
constexpr std::size_t STREAM_KINDS = 3;
constexpr std::array<const char *, STREAM_KINDS> STREAM_KIND_NAMES = {"pose", "event", "state"};

using StreamCounts = std::array<std::uint64_t, STREAM_KINDS>;

/** What a client wants to hear. */
struct StreamChoice {
    std::array<bool, STREAM_KINDS> kinds{true, true, true};
    bool squares = false; /**< poses with the squares' corners */
};

struct StreamMessage {
    StreamKind kind = StreamKind::state;
    std::string text;
    std::string text_squares; /**< of a pose, where any client wants them; else empty */
    StreamCounts lost{};      /**< published before this one, but never made into text */
};
using StreamMessagePtr = std::shared_ptr<const StreamMessage>;

}  // namespace opms_host
#endif
