/* SPDX-License-Identifier: Apache-2.0 */
#include "wires_socket.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

namespace opms_host {

namespace {

constexpr std::uint8_t KIND_EDGE = 5, KIND_EXPOSURE = 6, KIND_EXPOSING = 7,
                       KIND_EXPOSE = 23;
constexpr std::size_t EDGE_SIZE = 10, EXPOSURE_SIZE = 24, HEAD_SIZE = 5, NUMBER_SIZE = 8;

std::uint64_t read_number(const std::uint8_t *bytes, std::size_t size)
{
    std::uint64_t value = 0;
    for (std::size_t i = size; i > 0; --i) {
        value = value << 8U | bytes[i - 1];
    }
    return value;
}

void write_number(std::vector<std::uint8_t> &bytes, std::uint64_t value, std::size_t size)
{
    for (std::size_t i = 0; i < size; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
}

}  // namespace

WiresSocket::~WiresSocket()
{
    if (socket_ >= 0) {
        close(socket_);
    }
}

bool WiresSocket::connect(std::uint16_t port, std::string &error)
{
    const int made = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto *const place = reinterpret_cast<const sockaddr *>(&address);
    if (made < 0 || ::connect(made, place, sizeof address) != 0) {
        error = "no wires of an emulated box at 127.0.0.1:" + std::to_string(port) + " (" +
                std::strerror(errno) + "): start it with --wires " + std::to_string(port);
        if (made >= 0) {
            close(made);
        }
        return false;
    }
    const int on = 1;
    setsockopt(made, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const std::lock_guard<std::mutex> guard(mutex_);
    if (socket_ >= 0) {
        close(socket_);
    }
    socket_ = made;
    return true;
}

bool WiresSocket::expose(std::uint64_t delay_ns, std::uint64_t length_ns)
{
    std::vector<std::uint8_t> bytes;
    write_number(bytes, 1 + 2 * NUMBER_SIZE, 4);
    bytes.push_back(KIND_EXPOSE);
    write_number(bytes, delay_ns, NUMBER_SIZE);
    write_number(bytes, length_ns, NUMBER_SIZE);
    const std::lock_guard<std::mutex> guard(mutex_);
    return socket_ >= 0 && send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
                               static_cast<ssize_t>(bytes.size());
}

/** The socket is closed by connect() and the destructor alone, so it is there while this reads. */
bool WiresSocket::receive_exactly(std::uint8_t *bytes, std::size_t size)
{
    for (std::size_t done = 0; done < size;) {
        const ssize_t got = recv(socket_, bytes + done, size - done, 0);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return false;
        }
        done += static_cast<std::size_t>(got);
    }
    return true;
}

WiresSocket::Message WiresSocket::receive(WiresExposure &exposure)
{
    std::array<std::uint8_t, HEAD_SIZE> head;
    std::array<std::uint8_t, EXPOSURE_SIZE> payload;
    if (!receive_exactly(head.data(), head.size())) {
        return Message::none;
    }
    const std::uint64_t length = read_number(head.data(), 4);
    const Message message = head[4] == KIND_EDGE && length == 1 + EDGE_SIZE ? Message::edge
                            : head[4] == KIND_EXPOSURE && length == 1 + EXPOSURE_SIZE
                                ? Message::exposure
                            : head[4] == KIND_EXPOSING && length == 1 ? Message::exposing
                                                                      : Message::none;
    if (message == Message::none || !receive_exactly(payload.data(), length - 1)) {
        return Message::none;
    }
    if (message == Message::exposure) {
        exposure.trigger_ns = read_number(&payload[0], NUMBER_SIZE);
        exposure.delay_ns = read_number(&payload[8], NUMBER_SIZE);
        exposure.length_ns = read_number(&payload[16], NUMBER_SIZE);
    }
    return message;
}

bool WiresSocket::read(WiresExposure &exposure)
{
    Message message = Message::none;
    do {
        message = receive(exposure);
    } while (message != Message::none && message != Message::exposure);
    return message == Message::exposure;
}

bool WiresSocket::wait_exposing()
{
    WiresExposure none_yet;
    Message message = Message::none;
    do {
        message = receive(none_yet);
    } while (message == Message::edge);
    return message == Message::exposing;
}

void WiresSocket::end()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    if (socket_ >= 0) {
        shutdown(socket_, SHUT_RDWR);
    }
}

}  // namespace opms_host
