/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Where the interface listens, and what it takes to listen there. */
#ifndef OPMS_CONSOLE_LISTEN_ADDRESS_HPP
#define OPMS_CONSOLE_LISTEN_ADDRESS_HPP

#include <cstdint>
#include <string>

namespace opms_host {

constexpr std::uint16_t CONSOLE_PORT = 47660;

struct ListenAddress {
    std::string address = "127.0.0.1"; /**< IPv4 or IPv6 by number */
    std::uint16_t port = CONSOLE_PORT; /**< 0: any that is free */
    bool is_loopback = true;
    /** "127.0.0.1" or "[::1]": as it stands in an URL. */
    std::string url_host() const;
};

/** "ADDR", "ADDR:PORT" or "[ADDR]:PORT"; ADDR may be "localhost".
 * @return Empty, or what is wrong with it. */
std::string parse_listen_address(const std::string &text, ListenAddress &listen);

struct ListenSafety {
    bool token_file = false, tls = false, insecure = false;
};

/** Beyond this machine nobody listens without a token of the owner's and TLS.
 * @return Empty, or why not. */
std::string listen_refusal(const ListenAddress &listen, const ListenSafety &safety);

}  // namespace opms_host
#endif
