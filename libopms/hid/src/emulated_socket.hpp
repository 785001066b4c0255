/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The host's end of the emulated box's socket (docs/emulated-box.md): messages in and out.
 *
 * A thread of its own takes messages in as they come, so that arrival times are true and answers
 * reach who waits for them. Any thread may call. */
#ifndef OPMS_HID_EMULATED_SOCKET_HPP
#define OPMS_HID_EMULATED_SOCKET_HPP

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "box_transport.hpp"

namespace opms_hid {

/** Kinds of messages. */
enum class Message : uint8_t {
    attached = 1,
    detached = 2,
    input = 3,
    done = 4,
    edge = 5,
    output = 16,
    get = 17,
    set = 18,
    line = 19,
    plug = 20,
    power = 21
};

/** Little-endian fields of a message. */
void put_field(std::vector<uint8_t> &bytes, uint64_t value, size_t size);

class EmulatedSocket {
public:
    EmulatedSocket() = default;
    EmulatedSocket(const EmulatedSocket &) = delete;
    EmulatedSocket &operator=(const EmulatedSocket &) = delete;
    ~EmulatedSocket();

    /** @return Whether the server took the connection. Call once. */
    bool connect(uint16_t port, int timeout_ms);
    /** Is the server still there? */
    bool alive();
    /** Wait for the box to be on the bus. @return Which attachment it is, or 0. */
    uint32_t wait_attached(Clock::time_point deadline, std::string &serial);
    /** The next report of that attachment. */
    Io read(uint32_t attachment, Input &input, Clock::time_point deadline);
    /** Send, and wait for the answer. @param[out] bytes  Of the report that a GET brought. */
    Io request(Message kind, const std::vector<uint8_t> &payload, std::vector<uint8_t> &bytes,
               Clock::time_point deadline);
    /** Send, without an answer. */
    bool send(Message kind, const std::vector<uint8_t> &payload);
    /** End all that waits. */
    void interrupt();

private:
    struct Answer {
        bool done = false;
        uint8_t status = 0;
        std::vector<uint8_t> bytes;
    };
    struct Arrival {
        uint32_t attachment;
        Input input;
    };

    void receive();
    bool receive_exactly(uint8_t *bytes, size_t size);
    bool take(Message kind, const std::vector<uint8_t> &payload, int64_t t_host_ns);
    bool take_attached(const std::vector<uint8_t> &payload);
    void take_input(const std::vector<uint8_t> &payload, int64_t t_host_ns);
    bool take_done(const std::vector<uint8_t> &payload);

    int socket_ = -1;
    std::thread receiver_;
    std::mutex send_mutex_;
    std::mutex mutex_; /* of all below */
    std::condition_variable changed_;
    bool alive_ = false;
    uint32_t attachments_ = 0; /* so far */
    bool attached_ = false;
    std::string serial_;
    std::deque<Arrival> arrivals_;
    std::map<uint32_t, Answer> answers_;
    uint32_t next_request_ = 1;
};

} // namespace opms_hid

#endif
