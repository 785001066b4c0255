/* SPDX-License-Identifier: Apache-2.0 */
#include "emulated_socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace opms_hid {

namespace {

constexpr size_t MESSAGE_MAX = 4096;
/** As many reports as wait here at most; what comes then is lost, as in a kernel's ring. */
constexpr size_t ARRIVALS_MAX = 1024;
constexpr int SEND_TIMEOUT_MS = 1000;

uint64_t get_field(const uint8_t *bytes, size_t size)
{
    uint64_t value = 0;
    for (size_t i = size; i > 0; --i) {
        value = value << 8 | bytes[i - 1];
    }
    return value;
}

bool wait_for(int socket, short events, int timeout_ms)
{
    pollfd poller = {socket, events, 0};
    return poll(&poller, 1, timeout_ms) > 0;
}

bool connect_to(int socket, const sockaddr_in &address, int timeout_ms)
{
    if (connect(socket, reinterpret_cast<const sockaddr *>(&address), sizeof address) == 0) {
        return true;
    }
    int error = 0;
    socklen_t size = sizeof error;
    return errno == EINPROGRESS && wait_for(socket, POLLOUT, timeout_ms) &&
           getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error == 0;
}

} // namespace

void put_field(std::vector<uint8_t> &bytes, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; ++i) {
        bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
    }
}

EmulatedSocket::~EmulatedSocket()
{
    interrupt();
    if (receiver_.joinable()) {
        receiver_.join();
    }
    if (socket_ >= 0) {
        close(socket_);
    }
}

bool EmulatedSocket::connect(uint16_t port, int timeout_ms)
{
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) {
        return false;
    }
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (!connect_to(socket_, address, timeout_ms)) {
        return false;
    }
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    alive_ = true;
    receiver_ = std::thread(&EmulatedSocket::receive, this);
    return true;
}

bool EmulatedSocket::alive()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return alive_;
}

void EmulatedSocket::interrupt()
{
    if (socket_ >= 0) {
        shutdown(socket_, SHUT_RDWR);
    }
    const std::lock_guard<std::mutex> guard(mutex_);
    alive_ = attached_ = false;
    changed_.notify_all();
}

uint32_t EmulatedSocket::wait_attached(Clock::time_point deadline, std::string &serial)
{
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return attached_ || !alive_; });
    serial = serial_;
    return attached_ ? attachments_ : 0;
}

Io EmulatedSocket::read(uint32_t attachment, Input &input, Clock::time_point deadline)
{
    std::unique_lock<std::mutex> lock(mutex_);
    const auto is_over = [&] { return !attached_ || attachments_ != attachment; };
    changed_.wait_until(lock, deadline, [&] { return !arrivals_.empty() || is_over(); });
    while (!arrivals_.empty() && arrivals_.front().attachment < attachment) {
        arrivals_.pop_front();
    }
    if (!arrivals_.empty() && arrivals_.front().attachment == attachment) {
        input = arrivals_.front().input;
        arrivals_.pop_front();
        return Io::done;
    }
    return is_over() ? Io::gone : Io::none;
}

Io EmulatedSocket::request(Message kind, const std::vector<uint8_t> &payload,
                           std::vector<uint8_t> &bytes, Clock::time_point deadline)
{
    uint32_t number = 0, attachment = 0;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        if (!attached_) {
            return Io::gone;
        }
        attachment = attachments_;
        number = next_request_++;
        answers_[number] = Answer();
    }
    std::vector<uint8_t> message;
    put_field(message, number, 4);
    message.insert(message.end(), payload.begin(), payload.end());
    const bool sent = send(kind, message);
    std::unique_lock<std::mutex> lock(mutex_);
    const auto is_gone = [&] { return !sent || !attached_ || attachments_ != attachment; };
    changed_.wait_until(lock, deadline, [&] { return is_gone() || answers_[number].done; });
    const Answer answer = answers_[number];
    answers_.erase(number);
    if (!answer.done) {
        return is_gone() ? Io::gone : Io::timed_out;
    }
    bytes = answer.bytes;
    constexpr Io ENDS[] = {Io::done, Io::stalled, Io::gone, Io::timed_out};
    return ENDS[answer.status];
}

bool EmulatedSocket::send(Message kind, const std::vector<uint8_t> &payload)
{
    std::vector<uint8_t> bytes;
    put_field(bytes, payload.size() + 1, 4);
    bytes.push_back(static_cast<uint8_t>(kind));
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    const std::lock_guard<std::mutex> guard(send_mutex_);
    size_t sent = 0;
    while (sent < bytes.size()) {
        const ssize_t step =
            ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (step > 0) {
            sent += static_cast<size_t>(step);
        } else if (errno == EAGAIN && wait_for(socket_, POLLOUT, SEND_TIMEOUT_MS)) {
            continue;
        } else if (errno != EINTR) {
            return false;
        }
    }
    return true;
}

void EmulatedSocket::receive()
{
    std::vector<uint8_t> payload;
    for (;;) {
        uint8_t head[5];
        if (!receive_exactly(head, sizeof head)) {
            break;
        }
        const int64_t t_host_ns = host_now_ns();
        const uint64_t length = get_field(head, 4);
        if (length < 1 || length > MESSAGE_MAX) {
            break;
        }
        payload.resize(length - 1);
        if (!receive_exactly(payload.data(), payload.size()) ||
            !take(static_cast<Message>(head[4]), payload, t_host_ns)) {
            break;
        }
    }
    const std::lock_guard<std::mutex> guard(mutex_);
    alive_ = attached_ = false;
    changed_.notify_all();
}

bool EmulatedSocket::receive_exactly(uint8_t *bytes, size_t size)
{
    size_t got = 0;
    while (got < size) {
        const ssize_t step = recv(socket_, bytes + got, size - got, 0);
        if (step > 0) {
            got += static_cast<size_t>(step);
        } else if (step < 0 && (errno == EAGAIN || errno == EINTR)) {
            wait_for(socket_, POLLIN, -1);
        } else {
            return false;
        }
    }
    return true;
}

/** @return Whether the message made sense. */
bool EmulatedSocket::take(Message kind, const std::vector<uint8_t> &payload, int64_t t_host_ns)
{
    const std::lock_guard<std::mutex> guard(mutex_);
    bool good = true;
    switch (kind) {
    case Message::attached: good = take_attached(payload); break;
    case Message::detached: attached_ = false; break;
    case Message::input: take_input(payload, t_host_ns); break;
    case Message::done: good = take_done(payload); break;
    case Message::edge: break; /* for who watches lines */
    default: good = false;
    }
    changed_.notify_all();
    return good;
}

bool EmulatedSocket::take_attached(const std::vector<uint8_t> &payload)
{
    constexpr size_t SERIAL_AT = 7;
    if (payload.size() < SERIAL_AT || payload.size() < SERIAL_AT + payload[SERIAL_AT - 1]) {
        return false;
    }
    const auto begin = payload.begin() + SERIAL_AT;
    serial_.assign(begin, begin + payload[SERIAL_AT - 1]);
    attached_ = true;
    ++attachments_;
    return true;
}

void EmulatedSocket::take_input(const std::vector<uint8_t> &payload, int64_t t_host_ns)
{
    if (!attached_ || arrivals_.size() >= ARRIVALS_MAX) {
        return;
    }
    Arrival arrival = {attachments_, {{}, payload.size(), t_host_ns}};
    std::copy_n(payload.begin(), arrival.input.held(), arrival.input.bytes.begin());
    arrivals_.push_back(arrival);
}

bool EmulatedSocket::take_done(const std::vector<uint8_t> &payload)
{
    if (payload.size() < 5 || payload[4] > 3) {
        return false;
    }
    const auto answer = answers_.find(static_cast<uint32_t>(get_field(payload.data(), 4)));
    if (answer != answers_.end()) {
        answer->second.done = true;
        answer->second.status = payload[4];
        answer->second.bytes.assign(payload.begin() + 5, payload.end());
    }
    return true;
}

} // namespace opms_hid
