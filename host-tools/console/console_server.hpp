/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The network side of the interface: HTTP, WebSockets, TLS; all decisions are ApiHandler's.
 *
 *     hub's thread --text--> network thread --> clients     (one thread has all connections)
 *     requests --> network thread --> workers --> network thread --> responses
 *
 * Nothing in the network thread waits: calls that may take long are the workers'. */
#ifndef OPMS_CONSOLE_CONSOLE_SERVER_HPP
#define OPMS_CONSOLE_CONSOLE_SERVER_HPP

#include <cstdint>
#include <memory>
#include <string>

#include "api_handler.hpp"
#include "listen_address.hpp"
#include "stream_hub.hpp"

namespace opms_host {

struct ServerOptions {
    ListenAddress listen;
    std::string cert_path, key_path;  /**< PEM; both empty: no TLS */
    std::uint32_t clients_max = 64;   /**< of the stream; further ones get 503 */
    std::uint32_t connections_max = 160;
    std::uint32_t outbox_messages = 256; /**< that wait for one client before the oldest go */
    std::uint32_t stall_ms = 10000;   /**< a client that takes nothing for so long is closed */
    std::uint32_t request_ms = 10000; /**< for a whole request to arrive, a response to leave */
    std::uint32_t idle_ms = 30000;    /**< between requests; a stream's client is pinged */
    int send_buffer_bytes = 262144;   /**< that the system may hold for one client */
};

struct ServerFigures {
    std::uint64_t requests = 0, refused_connections = 0, stalled = 0;
    std::uint32_t connections = 0, clients = 0;
};

/** Calls from any thread. */
class ConsoleServer {
public:
    /** Listens when it returns. @p handler and @p hub must live longer.
     * @return NULL on failure, with @p error for people. */
    static std::unique_ptr<ConsoleServer> create(const ServerOptions &options,
                                                 const ApiHandler &handler, StreamHub &hub,
                                                 std::string &error);
    /** Tells the clients that it goes, and ends. */
    ~ConsoleServer();

    std::uint16_t port() const;
    ServerFigures figures() const;

    class Impl;

private:
    explicit ConsoleServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace opms_host
#endif
