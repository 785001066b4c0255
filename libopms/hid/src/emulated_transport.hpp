/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The emulated box as a transport, and the hands that its wires and its cable need. */
#ifndef OPMS_HID_EMULATED_TRANSPORT_HPP
#define OPMS_HID_EMULATED_TRANSPORT_HPP

#include <memory>
#include <vector>

#include "box_transport.hpp"
#include "emulated_socket.hpp"

namespace opms_hid {

class EmulatedTransport : public BoxTransport {
public:
    explicit EmulatedTransport(uint16_t port) : port_(port) {}

    OpenResult open(const std::string &unique_id, int timeout_ms) override;
    void close() override;
    Io read(Input &input, int timeout_ms) override;
    Io write(const Report &report) override;
    Io get_feature(uint8_t id, Report &report, size_t &size) override;
    Io set_feature(const Report &report) override;
    void interrupt() override;

    /** Any thread, also while the box is off the bus. @return Whether the server is there. */
    bool send(Message kind, const std::vector<uint8_t> &payload);

private:
    std::shared_ptr<EmulatedSocket> socket();
    /** A connection to the server: the one there is, or a new one. NULL: none. */
    std::shared_ptr<EmulatedSocket> connected(int timeout_ms);
    Io request(Message kind, const std::vector<uint8_t> &payload, std::vector<uint8_t> &bytes);

    const uint16_t port_;
    uint32_t attachment_ = 0; /* of the reader thread */
    std::mutex mutex_;        /* of all below */
    bool interrupted_ = false;
    std::shared_ptr<EmulatedSocket> socket_;
};

} // namespace opms_hid

#endif
