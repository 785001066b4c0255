/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What the connections of a server share. */
#ifndef OPMS_CONSOLE_CONSOLE_SHARED_HPP
#define OPMS_CONSOLE_CONSOLE_SHARED_HPP

#include <atomic>
#include <chrono>
#include <memory>
#include <set>

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>

#include "console_server.hpp"

namespace opms_host {

/** A client of the stream. The network thread alone. */
class StreamClient {
public:
    virtual ~StreamClient() = default;
    virtual void publish(const StreamMessagePtr &message) = 0;
    virtual void go_away() = 0;
};

/** Any connection, so that all can be ended. The network thread alone. */
class Connection {
public:
    virtual ~Connection() = default;
    virtual void close_now() = 0;
};

struct ConsoleShared {
    ConsoleShared(const ServerOptions &o, const ApiHandler &h, StreamHub &b)
        : options(o), handler(h), hub(b)
    {
    }

    const ServerOptions options;
    const ApiHandler &handler;
    StreamHub &hub;

    /* The network thread's. Connections may live as long as `network`, and take themselves out. */
    std::set<StreamClient *> clients;
    std::set<Connection *> connections;
    bool ends = false;

    std::atomic<std::uint64_t> requests{0}, refused_connections{0}, stalled{0};
    std::atomic<std::uint32_t> client_count{0}, connection_count{0};

    boost::asio::io_context network{1};
    boost::asio::thread_pool workers{4};

    std::chrono::milliseconds request_time() const
    {
        return std::chrono::milliseconds(options.request_ms);
    }
};

}  // namespace opms_host
#endif
