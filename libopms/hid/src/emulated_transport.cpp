/* SPDX-License-Identifier: Apache-2.0 */
/* The connection outlives an unplug, because the hand that plugs the box in again is on it. */
#include "emulated_transport.hpp"

#include <algorithm>

namespace opms_hid {

namespace {

constexpr std::chrono::milliseconds REQUEST_TIMEOUT(1000); /* as that of hidapi's transfers */

} // namespace

std::shared_ptr<EmulatedSocket> EmulatedTransport::socket()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return socket_;
}

std::shared_ptr<EmulatedSocket> EmulatedTransport::connected(int timeout_ms)
{
    std::shared_ptr<EmulatedSocket> current = socket();
    if (current && current->alive()) {
        return current;
    }
    auto fresh = std::make_shared<EmulatedSocket>();
    if (!fresh->connect(port_, timeout_ms)) {
        return nullptr;
    }
    const std::lock_guard<std::mutex> guard(mutex_);
    if (interrupted_) {
        return nullptr;
    }
    socket_ = fresh;
    return fresh;
}

OpenResult EmulatedTransport::open(const std::string &unique_id, int timeout_ms)
{
    const Clock::time_point deadline = Clock::now() + std::chrono::milliseconds(timeout_ms);
    const std::string name = "the emulated box on port " + std::to_string(port_);
    const std::shared_ptr<EmulatedSocket> connection = connected(timeout_ms);
    if (!connection) {
        return {OPMS_ERR_DEVICE, true, name + " is not running", {}};
    }
    std::string serial;
    attachment_ = connection->wait_attached(deadline, serial);
    if (attachment_ == 0) {
        return {OPMS_ERR_DEVICE, true,
                name + " is not on the bus: its cable is pulled, or another program uses it", {}};
    }
    if (!unique_id.empty() && !same_unique_id(unique_id, serial)) {
        return {OPMS_ERR_DEVICE, false, name + " is " + serial + ", not " + unique_id, {}};
    }
    return {OPMS_OK, false, {}, serial};
}

void EmulatedTransport::close()
{
    attachment_ = 0;
}

Io EmulatedTransport::read(Input &input, int timeout_ms)
{
    const std::shared_ptr<EmulatedSocket> connection = socket();
    return connection->read(attachment_, input,
                            Clock::now() + std::chrono::milliseconds(timeout_ms));
}

Io EmulatedTransport::request(Message kind, const std::vector<uint8_t> &payload,
                              std::vector<uint8_t> &bytes)
{
    const std::shared_ptr<EmulatedSocket> connection = socket();
    return connection ? connection->request(kind, payload, bytes, Clock::now() + REQUEST_TIMEOUT)
                      : Io::gone;
}

Io EmulatedTransport::write(const Report &report)
{
    std::vector<uint8_t> none;
    return request(Message::output, {report.begin(), report.end()}, none);
}

Io EmulatedTransport::get_feature(uint8_t id, Report &report, size_t &size)
{
    std::vector<uint8_t> payload, bytes;
    put_field(payload, id, 1);
    put_field(payload, report.size(), 2);
    const Io io = request(Message::get, payload, bytes);
    size = bytes.size();
    report.fill(0);
    std::copy_n(bytes.begin(), std::min(bytes.size(), report.size()), report.begin());
    return io;
}

Io EmulatedTransport::set_feature(const Report &report)
{
    std::vector<uint8_t> none;
    return request(Message::set, {report.begin(), report.end()}, none);
}

void EmulatedTransport::interrupt()
{
    std::shared_ptr<EmulatedSocket> connection;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        interrupted_ = true;
        connection = socket_;
    }
    if (connection) {
        connection->interrupt();
    }
}

bool EmulatedTransport::send(Message kind, const std::vector<uint8_t> &payload)
{
    const std::shared_ptr<EmulatedSocket> connection = socket();
    return connection && connection->send(kind, payload);
}

} // namespace opms_hid
