/* SPDX-License-Identifier: Apache-2.0 */
#include "console_server.hpp"

#include <future>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>

#include <semaphore.h>

#include "console_http.hpp"
#include "console_tls.hpp"

namespace opms_host {

namespace asio = boost::asio;
using boost::beast::error_code;
using boost::beast::tcp_stream;
using tcp = asio::ip::tcp;
using TlsStream = boost::beast::ssl_stream<tcp_stream>;

namespace {

/* Messages that may be on their way from the hub's thread to the network thread. Beyond them the
 * hub waits, and its own bounded queue fills, which is counted. */
constexpr unsigned IN_FLIGHT = 1024;
constexpr std::chrono::milliseconds GOODBYE_TIME(500), ACCEPT_AGAIN(100);

/** A counter that the hub takes from and the network thread gives back to. */
class InFlight {
public:
    InFlight() { sem_init(&places_, 0, IN_FLIGHT); }
    ~InFlight() { sem_destroy(&places_); }
    InFlight(const InFlight &) = delete;
    InFlight &operator=(const InFlight &) = delete;

    void take()
    {
        while (sem_wait(&places_) != 0) { /* a signal came in between */
        }
    }
    void give() { sem_post(&places_); }

private:
    sem_t places_;
};

}  // namespace

class ConsoleServer::Impl {
public:
    Impl(const ServerOptions &options, const ApiHandler &handler, StreamHub &hub)
        : shared_(options, handler, hub), tls_(asio::ssl::context::tls_server),
          acceptor_(shared_.network), timer_(shared_.network),
          work_(asio::make_work_guard(shared_.network))
    {
    }
    ~Impl();

    bool listen(std::string &error);
    void run();
    std::uint16_t port() const { return port_; }
    ServerFigures figures() const;

private:
    void accept();
    void on_accept(error_code error, tcp::socket socket);
    void serve(tcp::socket socket);
    void end();

    ConsoleShared shared_;
    asio::ssl::context tls_;
    tcp::acceptor acceptor_;
    asio::steady_timer timer_;
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    InFlight in_flight_;
    std::uint16_t port_ = 0;
    std::thread thread_;
};

bool ConsoleServer::Impl::listen(std::string &error)
{
    const ServerOptions &options = shared_.options;
    if (!options.cert_path.empty() &&
        !console_tls_load(tls_, options.cert_path, options.key_path, error)) {
        return false;
    }
    error_code problem;
    const tcp::endpoint endpoint(asio::ip::make_address(options.listen.address, problem),
                                 options.listen.port);
    if (!problem) {
        acceptor_.open(endpoint.protocol(), problem);
    }
    if (!problem) {
        acceptor_.set_option(tcp::acceptor::reuse_address(true), problem);
        acceptor_.bind(endpoint, problem);
    }
    if (!problem) {
        acceptor_.listen(tcp::acceptor::max_listen_connections, problem);
    }
    if (problem) {
        error = options.listen.url_host() + ":" + std::to_string(options.listen.port) +
                " cannot be listened on: " + problem.message();
        return false;
    }
    port_ = acceptor_.local_endpoint().port();
    return true;
}

void ConsoleServer::Impl::run()
{
    asio::post(shared_.network, [this] { accept(); });
    thread_ = std::thread([this] { shared_.network.run(); });
    shared_.hub.set_sink([this](const StreamMessagePtr &message) {
        in_flight_.take();
        asio::post(shared_.network, [this, message] {
            for (StreamClient *client : std::set<StreamClient *>(shared_.clients)) {
                client->publish(message);
            }
            in_flight_.give();
        });
    });
}

void ConsoleServer::Impl::accept()
{
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
        on_accept(error, std::move(socket));
    });
}

void ConsoleServer::Impl::on_accept(error_code error, tcp::socket socket)
{
    if (shared_.ends) {
        return;
    }
    if (error) { /* out of file descriptors, most likely: others may end meanwhile */
        timer_.expires_after(ACCEPT_AGAIN);
        timer_.async_wait([this](error_code) {
            if (!shared_.ends) {
                accept();
            }
        });
        return;
    }
    if (shared_.connection_count >= shared_.options.connections_max) {
        ++shared_.refused_connections;
        error_code ignored;
        socket.close(ignored);
    } else {
        serve(std::move(socket));
    }
    accept();
}

void ConsoleServer::Impl::serve(tcp::socket socket)
{
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(shared_.options.send_buffer_bytes),
                      ignored);
    if (shared_.options.cert_path.empty()) {
        std::make_shared<ConsoleHttp<tcp_stream>>(tcp_stream(std::move(socket)), false, shared_)
            ->read();
        return;
    }
    const auto connection = std::make_shared<ConsoleHttp<TlsStream>>(
        TlsStream(std::move(socket), tls_), true, shared_);
    boost::beast::get_lowest_layer(connection->stream()).expires_after(shared_.request_time());
    connection->stream().async_handshake(asio::ssl::stream_base::server,
                                         [connection](error_code error) {
                                             if (!error) {
                                                 connection->read();
                                             }
                                         });
}

/** In the network thread: nobody new, a word of goodbye, and soon the end. */
void ConsoleServer::Impl::end()
{
    shared_.ends = true;
    error_code ignored;
    acceptor_.close(ignored);
    for (StreamClient *client : std::set<StreamClient *>(shared_.clients)) {
        client->go_away();
    }
    timer_.expires_after(shared_.clients.empty() ? std::chrono::milliseconds(0) : GOODBYE_TIME);
    timer_.async_wait([this](error_code) {
        for (Connection *connection : std::set<Connection *>(shared_.connections)) {
            connection->close_now();
        }
        work_.reset();
        shared_.network.stop();
    });
}

ConsoleServer::Impl::~Impl()
{
    if (!thread_.joinable()) {
        return;
    }
    shared_.hub.set_sink({}); /* while the network thread still gives places back */
    asio::post(shared_.network, [this] { end(); });
    thread_.join();
    shared_.workers.join();
}

ServerFigures ConsoleServer::Impl::figures() const
{
    ServerFigures figures;
    figures.requests = shared_.requests;
    figures.refused_connections = shared_.refused_connections;
    figures.stalled = shared_.stalled;
    figures.connections = shared_.connection_count;
    figures.clients = shared_.client_count;
    return figures;
}

ConsoleServer::ConsoleServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ConsoleServer::~ConsoleServer() = default;

std::unique_ptr<ConsoleServer> ConsoleServer::create(const ServerOptions &options,
                                                     const ApiHandler &handler, StreamHub &hub,
                                                     std::string &error)
{
    auto impl = std::make_unique<Impl>(options, handler, hub);
    if (!impl->listen(error)) {
        return nullptr;
    }
    impl->run();
    return std::unique_ptr<ConsoleServer>(new ConsoleServer(std::move(impl)));
}

std::uint16_t ConsoleServer::port() const
{
    return impl_->port();
}

ServerFigures ConsoleServer::figures() const
{
    return impl_->figures();
}

}  // namespace opms_host
