/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One HTTP connection: request after request, until it ends or becomes a WebSocket. */
#ifndef OPMS_CONSOLE_CONSOLE_HTTP_HPP
#define OPMS_CONSOLE_CONSOLE_HTTP_HPP

#include <memory>
#include <optional>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "console_message.hpp"
#include "console_shared.hpp"
#include "console_socket.hpp"

namespace opms_host {

/** @tparam Stream  TCP, or TLS on it. */
template <typename Stream>
class ConsoleHttp final : public Connection,
                          public std::enable_shared_from_this<ConsoleHttp<Stream>> {
public:
    using Error = boost::beast::error_code;

    ConsoleHttp(Stream &&stream, bool secure, ConsoleShared &shared)
        : stream_(std::move(stream)), secure_(secure), shared_(shared)
    {
        shared_.connections.insert(this);
        ++shared_.connection_count;
    }

    ~ConsoleHttp() override
    {
        shared_.connections.erase(this);
        --shared_.connection_count;
    }

    Stream &stream() { return stream_; }

    void read()
    {
        parser_.emplace();
        parser_->header_limit(HTTP_HEADER_BYTES_MAX);
        parser_->body_limit(HTTP_BODY_BYTES_MAX);
        lowest().expires_after(std::chrono::milliseconds(
            first_ ? shared_.options.request_ms : shared_.options.idle_ms));
        first_ = false;
        boost::beast::http::async_read_header(
            stream_, buffer_, *parser_,
            [self = this->shared_from_this()](Error error, std::size_t) {
                self->on_head(error);
            });
    }

    void close_now() override { lowest().close(); }

private:
    auto &lowest() { return boost::beast::get_lowest_layer(stream_); }

    void on_head(Error error)
    {
        if (error) {
            on_bad(error);
            return;
        }
        ++shared_.requests;
        const bool upgrade = boost::beast::websocket::is_upgrade(parser_->get());
        request_ = console_request(parser_->get(), secure_, upgrade);
        if (auto refused = shared_.handler.refusal(request_)) {
            /* What it still sends is not wanted; where nothing is sent, it may ask again. */
            send(*refused, parser_->get().keep_alive() && parser_->is_done());
            return;
        }
        if (upgrade) {
            become_socket();
            return;
        }
        lowest().expires_after(shared_.request_time());
        if (console_expects_continue(request_)) {
            send_continue();
        } else {
            read_body();
        }
    }

    void send_continue()
    {
        static constexpr char TEXT[] = "HTTP/1.1 100 Continue\r\n\r\n";
        boost::asio::async_write(stream_, boost::asio::buffer(TEXT, sizeof TEXT - 1),
                                 [self = this->shared_from_this()](Error error, std::size_t) {
                                     if (!error) {
                                         self->read_body();
                                     }
                                 });
    }

    void read_body()
    {
        boost::beast::http::async_read(stream_, buffer_, *parser_,
                                       [self = this->shared_from_this()](Error error,
                                                                         std::size_t) {
                                           self->on_body(error);
                                       });
    }

    void on_body(Error error)
    {
        if (error) {
            on_bad(error);
            return;
        }
        const bool keep = parser_->get().keep_alive();
        request_.body = std::move(parser_->get().body());
        /* A worker takes as long as it takes: a scan's stop waits for what is on its way. */
        lowest().expires_never();
        boost::asio::post(shared_.workers, [self = this->shared_from_this(), keep]() mutable {
            HttpResponse response = self->shared_.handler.handle(self->request_);
            auto &network = self->shared_.network; /* before `self` moves on */
            boost::asio::post(network, [self = std::move(self), keep,
                                        response = std::move(response)] {
                self->send(response, keep);
            });
        });
    }

    /** What could not be read as a request; nothing is said to who has gone. */
    void on_bad(Error error)
    {
        if (const auto refused = console_read_refusal(error)) {
            send(*refused, false);
        } else {
            close_now();
        }
    }

    void send(const HttpResponse &response, bool keep)
    {
        response_ = console_response(response, keep && !shared_.ends);
        lowest().expires_after(shared_.request_time());
        boost::beast::http::async_write(
            stream_, response_, [self = this->shared_from_this()](Error error, std::size_t) {
                self->on_sent(error);
            });
    }

    void on_sent(Error error)
    {
        if (error) {
            close_now();
        } else if (response_.keep_alive()) {
            read();
        } else {
            end();
        }
    }

    /** To close while data is still coming would make the system throw our answer away, too. */
    void end()
    {
        Error ignored;
        lowest().socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, ignored);
        lowest().expires_after(std::chrono::seconds(2));
        discard();
    }

    void discard()
    {
        buffer_.clear();
        lowest().async_read_some(buffer_.prepare(DISCARD_BYTES),
                                 [self = this->shared_from_this()](Error error,
                                                                   std::size_t count) {
                                     self->discarded_ += count;
                                     if (error || self->discarded_ > DISCARD_BYTES_MAX) {
                                         self->close_now();
                                     } else {
                                         self->discard();
                                     }
                                 });
    }

    void become_socket()
    {
        if (shared_.client_count >= shared_.options.clients_max) {
            send(http_error(503, "clients", "there are as many clients as this server takes"),
                 false);
            return;
        }
        StreamChoice choice;
        ApiHandler::stream_choice(request_.target, choice);
        auto socket =
            std::make_shared<ConsoleSocket<Stream>>(std::move(stream_), shared_, choice);
        socket->start(parser_->release(), offers_subprotocol(request_));
    }

    static constexpr std::size_t DISCARD_BYTES = 65536, DISCARD_BYTES_MAX = 16777216;

    Stream stream_;
    const bool secure_;
    ConsoleShared &shared_;
    boost::beast::flat_buffer buffer_{HTTP_HEADER_BYTES_MAX + HTTP_BODY_BYTES_MAX};
    std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
    HttpRequest request_;
    boost::beast::http::response<boost::beast::http::string_body> response_;
    std::size_t discarded_ = 0;
    bool first_ = true;
};

}  // namespace opms_host
#endif
