/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * One client of the stream, over a WebSocket. Everything here runs in the network thread, but for
 * ApiHandler::stream_message(), which is the workers'. */
#ifndef OPMS_CONSOLE_CONSOLE_SOCKET_HPP
#define OPMS_CONSOLE_CONSOLE_SOCKET_HPP

#include <memory>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "console_shared.hpp"
#include "stream_outbox.hpp"

namespace opms_host {

/** @tparam Next  The layer below: TCP, or TLS on it. */
template <typename Next>
class ConsoleSocket final : public StreamClient,
                            public Connection,
                            public std::enable_shared_from_this<ConsoleSocket<Next>> {
public:
    using Request = boost::beast::http::request<boost::beast::http::string_body>;
    using Error = boost::beast::error_code;

    ConsoleSocket(Next &&next, ConsoleShared &shared, const StreamChoice &choice)
        : socket_(std::move(next)), stall_timer_(shared.network), shared_(shared),
          outbox_(shared.options.outbox_messages)
    {
        choose(choice);
        shared_.clients.insert(this);
        shared_.connections.insert(this);
        ++shared_.client_count;
        ++shared_.connection_count;
    }

    ~ConsoleSocket() override
    {
        choose({});
        shared_.clients.erase(this);
        shared_.connections.erase(this);
        --shared_.client_count;
        --shared_.connection_count;
    }

    void start(Request request, bool confirm_protocol)
    {
        namespace ws = boost::beast::websocket;
        boost::beast::get_lowest_layer(socket_).expires_never();
        ws::stream_base::timeout timeout = {shared_.request_time(),
                                            std::chrono::milliseconds(shared_.options.idle_ms),
                                            true};
        socket_.set_option(timeout);
        socket_.read_message_max(HTTP_BODY_BYTES_MAX);
        socket_.text(true);
        socket_.set_option(ws::stream_base::decorator([confirm_protocol](
                                                          ws::response_type &response) {
            if (confirm_protocol) {
                response.set(boost::beast::http::field::sec_websocket_protocol, SUBPROTOCOL);
            }
        }));
        request_ = std::move(request);
        socket_.async_accept(request_, [self = this->shared_from_this()](Error error) {
            if (!error) {
                self->begin();
            }
        });
    }

    void publish(const StreamMessagePtr &message) override
    {
        if (open_) {
            outbox_.push(message);
            pump();
        }
    }

    void go_away() override
    {
        if (open_) {
            close(boost::beast::websocket::close_code::going_away);
        }
    }

    void close_now() override
    {
        open_ = false;
        stall_timer_.cancel();
        boost::beast::get_lowest_layer(socket_).close();
    }

private:
    void begin()
    {
        open_ = true;
        outbox_.push_reply(R"({"schema":"opms.hello/1","api":"v1"})");
        if (const StreamMessagePtr state = shared_.hub.newest_state()) {
            auto now = std::make_shared<StreamMessage>();
            now->kind = StreamKind::state;
            now->text = state->text;
            outbox_.push(now);
        }
        read();
        pump();
    }

    void read()
    {
        reading_ = true;
        socket_.async_read(buffer_, [self = this->shared_from_this()](Error error, std::size_t) {
            self->on_read(error);
        });
    }

    void on_read(Error error)
    {
        reading_ = false;
        if (error || !open_) {
            close_now();
            return;
        }
        if (!socket_.got_text()) {
            close(boost::beast::websocket::close_code::unknown_data);
            return;
        }
        std::string text = boost::beast::buffers_to_string(buffer_.data());
        buffer_.consume(buffer_.size());
        handling_ = true;
        boost::asio::post(shared_.workers, [self = this->shared_from_this(),
                                            choice = outbox_.choice(),
                                            text = std::move(text)]() mutable {
            std::string reply = self->shared_.handler.stream_message(text, choice);
            auto &network = self->shared_.network; /* before `self` moves on */
            boost::asio::post(network, [self = std::move(self), choice,
                                        reply = std::move(reply)]() mutable {
                self->on_reply(std::move(reply), choice);
            });
        });
    }

    void on_reply(std::string reply, const StreamChoice &choice)
    {
        handling_ = false;
        choose(choice);
        if (open_) {
            outbox_.push_reply(std::move(reply));
            pump();
        }
    }

    /** One write at a time; a client that does not read is given up after stall_ms. */
    void pump()
    {
        if (writing_ || !open_) {
            return;
        }
        if (!reading_ && !handling_ && !outbox_.has_replies()) {
            read();
        }
        sending_ = outbox_.pop();
        if (!sending_) {
            return;
        }
        writing_ = true;
        stall_timer_.expires_after(std::chrono::milliseconds(shared_.options.stall_ms));
        stall_timer_.async_wait([self = this->shared_from_this(), write = ++writes_](Error error) {
            self->on_stall(error, write);
        });
        socket_.async_write(boost::asio::buffer(*sending_),
                            [self = this->shared_from_this()](Error error, std::size_t) {
                                self->on_written(error);
                            });
    }

    void on_written(Error error)
    {
        writing_ = false;
        sending_.reset();
        stall_timer_.cancel();
        if (error) {
            close_now();
            return;
        }
        pump();
    }

    /** A timer that ran out may be told of late: only its own write counts. */
    void on_stall(Error error, std::uint64_t write)
    {
        if (!error && writing_ && open_ && write == writes_) {
            ++shared_.stalled;
            close_now();
        }
    }

    void close(boost::beast::websocket::close_code code)
    {
        open_ = false;
        stall_timer_.cancel();
        socket_.async_close(code, [self = this->shared_from_this()](Error) {
            self->close_now();
        });
    }

    void choose(const StreamChoice &choice)
    {
        shared_.hub.want_squares(int(choice.squares) - int(outbox_.choice().squares));
        outbox_.choose(choice);
    }

    boost::beast::websocket::stream<Next> socket_;
    boost::beast::flat_buffer buffer_;
    boost::asio::steady_timer stall_timer_;
    ConsoleShared &shared_;
    StreamOutbox outbox_;
    Request request_;
    std::shared_ptr<const std::string> sending_;
    std::uint64_t writes_ = 0;
    bool open_ = false, reading_ = false, handling_ = false, writing_ = false;
};

}  // namespace opms_host
#endif
