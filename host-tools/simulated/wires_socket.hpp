/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The camera's end of the emulated box's wires: TRIG and STROBE (docs/emulated-box.md). */
#ifndef OPMS_SIMULATED_WIRES_SOCKET_HPP
#define OPMS_SIMULATED_WIRES_SOCKET_HPP

#include <cstdint>
#include <mutex>
#include <string>

namespace opms_host {

/** A pulse on TRIG, and the exposure that follows it; ns of the emulator's clock. */
struct WiresExposure {
    std::uint64_t trigger_ns = 0, delay_ns = 0, length_ns = 0;
};

/** read() by one thread; the others from any. */
class WiresSocket {
public:
    WiresSocket() = default;
    WiresSocket(const WiresSocket &) = delete;
    WiresSocket &operator=(const WiresSocket &) = delete;
    ~WiresSocket();

    /** Closes an earlier connection. */
    bool connect(std::uint16_t port, std::string &error);
    /** From the next pulse on STROBE is active for a while after each; length 0: never. */
    bool expose(std::uint64_t delay_ns, std::uint64_t length_ns);
    /** Wait for the next exposure. @return false at the connection's end, or at an end(). */
    bool read(WiresExposure &exposure);
    /** After connect() and the first expose(): wait until that acts. @return As read(). */
    bool wait_exposing();
    /** End a read(), and all that come until connect(). */
    void end();

private:
    enum class Message { none, edge, exposure, exposing };
    Message receive(WiresExposure &exposure);
    bool receive_exactly(std::uint8_t *bytes, std::size_t size);

    std::mutex mutex_; /**< of socket_ and of sending */
    int socket_ = -1;
};

}  // namespace opms_host
#endif
