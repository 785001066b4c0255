/* SPDX-License-Identifier: Apache-2.0 */
#include "listen_address.hpp"

#include <charconv>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace opms_host {

namespace {

bool split(const std::string &text, std::string &address, std::string &port)
{
    const bool bracket = !text.empty() && text.front() == '[';
    const std::size_t end = bracket ? text.find(']') : text.rfind(':');
    if (bracket) {
        if (end == std::string::npos) {
            return false;
        }
        address = text.substr(1, end - 1);
        const std::string rest = text.substr(end + 1);
        port = rest.empty() ? "" : rest.substr(1);
        return rest.empty() || (rest[0] == ':' && !port.empty());
    }
    const bool has_port = end != std::string::npos && text.find(':') == end;
    address = has_port ? text.substr(0, end) : text; /* an IPv6 address without brackets: whole */
    port = has_port ? text.substr(end + 1) : "";
    return !has_port || !port.empty();
}

bool is_loopback_v4(const in_addr &address)
{
    return (ntohl(address.s_addr) >> 24) == 127;
}

}  // namespace

std::string ListenAddress::url_host() const
{
    return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

std::string parse_listen_address(const std::string &text, ListenAddress &listen)
{
    ListenAddress parsed;
    std::string port;
    if (!split(text, parsed.address, port)) {
        return "'" + text + "' is not ADDRESS:PORT";
    }
    if (parsed.address == "localhost") {
        parsed.address = "127.0.0.1";
    }
    in_addr v4 = {};
    in6_addr v6 = {};
    if (inet_pton(AF_INET, parsed.address.c_str(), &v4) == 1) {
        parsed.is_loopback = is_loopback_v4(v4);
    } else if (inet_pton(AF_INET6, parsed.address.c_str(), &v6) == 1) {
        parsed.is_loopback = IN6_IS_ADDR_LOOPBACK(&v6);
    } else {
        return "'" + parsed.address + "' is no address; give it by number, as 127.0.0.1 or [::1]";
    }
    if (!port.empty()) {
        unsigned value = 0;
        const char *end = port.data() + port.size();
        const auto result = std::from_chars(port.data(), end, value);
        if (result.ec != std::errc() || result.ptr != end || value > 65535) {
            return "'" + port + "' is no port";
        }
        parsed.port = static_cast<std::uint16_t>(value);
    }
    listen = parsed;
    return "";
}

std::string listen_refusal(const ListenAddress &listen, const ListenSafety &safety)
{
    if (safety.insecure && safety.tls) {
        return "--insecure means to go without TLS: leave it out, or --cert and --key";
    }
    if (listen.is_loopback) {
        return "";
    }
    if (!safety.token_file) {
        return listen.address + " can be reached from other machines: that needs --token-file";
    }
    if (!safety.tls && !safety.insecure) {
        return listen.address + " can be reached from other machines: that needs --cert and --key "
                                "(TLS), or --insecure on a network where nobody listens";
    }
    return "";
}

}  // namespace opms_host
