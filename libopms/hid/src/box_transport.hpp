/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The one interface between the box's reports and what carries them.
 *
 * read() and open()/close() are called by the reader thread alone, the others by the worker thread;
 * a transport makes sure that open() and close() wait for the call of the other thread. */
#ifndef OPMS_HID_BOX_TRANSPORT_HPP
#define OPMS_HID_BOX_TRANSPORT_HPP

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include <opms/hid.h>

namespace opms_hid {

using Clock = std::chrono::steady_clock; /* CLOCK_MONOTONIC */
using Report = std::array<uint8_t, OPMS_WIRE_SIZE>;

inline int64_t host_now_ns()
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
        .count();
}

/** How a transfer ended. */
enum class Io {
    done,
    none,      /**< nothing came in time */
    stalled,   /**< the device refused on the bus */
    gone,      /**< unplugged */
    timed_out
};

/** Larger than any report, so that one that is too long shows its length. */
constexpr size_t INPUT_CAPACITY = 128;

/** Bytes as they came in. */
struct Input {
    std::array<uint8_t, INPUT_CAPACITY> bytes;
    size_t size; /**< of what came; more than the capacity where it was cut */
    int64_t t_host_ns;

    size_t held() const { return size < bytes.size() ? size : bytes.size(); }
};

/** What open() found. */
struct OpenResult {
    opms_status_t status; /**< OPMS_OK: open */
    bool absent;          /**< there is just no such box now: worth another try in silence */
    std::string message;  /**< for people, where it is not open */
    std::string unique_id;
};

class BoxTransport {
public:
    virtual ~BoxTransport() = default;
    /** Find and open the box of that id, "" the only one. */
    virtual OpenResult open(const std::string &unique_id, int timeout_ms) = 0;
    virtual void close() = 0;
    virtual Io read(Input &input, int timeout_ms) = 0;
    virtual Io write(const Report &report) = 0;
    /** @param[out] size  Bytes of the answer. */
    virtual Io get_feature(uint8_t id, Report &report, size_t &size) = 0;
    virtual Io set_feature(const Report &report) = 0;
    /** End what waits; any thread. Nothing else is called after it but close(). */
    virtual void interrupt() = 0;
};

/** Is this text a unique id: 16 hex digits? */
inline bool is_unique_id(const std::string &text)
{
    return text.size() == OPMS_BOX_ID_SIZE - 1 &&
           text.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos;
}

/** Do two ids mean the same box, whatever the case of their digits? */
inline bool same_unique_id(std::string a, std::string b)
{
    const auto lower = [](std::string &text) {
        for (char &c : text) {
            c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        }
    };
    lower(a);
    lower(b);
    return a == b;
}

} // namespace opms_hid

#endif
