/* SPDX-License-Identifier: Apache-2.0 */
/* The real server over a session that is a double, driven by lines on stdin:
 *
 *     pose N     publish N poses, one after the other   -> "published N", when all calls returned
 *     event      publish an event                       -> "published 1"
 *     picture    there is a picture from now on         -> "picture"
 *     scan NAME  a scan goes on ("scan" alone: none)    -> "scan"
 *     figures    -> JSON: what was published, lost, stalled; connections and clients now
 *     end of stdin: it ends
 *
 *     console_bench TOKEN [--cert F --key F] [--stall-ms N] [--clients N] [--idle-ms N]
 *
 * The first line that it writes is its port. */
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "console_server.hpp"
#include "fake_control.hpp"

using namespace opms_host;

namespace {

constexpr int WIDTH_PX = 64, HEIGHT_PX = 48;

std::map<std::string, std::string> read_options(int argc, char **argv)
{
    std::map<std::string, std::string> options;
    for (int i = 2; i + 1 < argc; i += 2) {
        options[argv[i]] = argv[i + 1];
    }
    return options;
}

std::uint32_t number_or(const std::map<std::string, std::string> &options, const char *name,
                        std::uint32_t otherwise)
{
    const auto found = options.find(name);
    return found == options.end() ? otherwise
                                  : static_cast<std::uint32_t>(std::stoul(found->second));
}

class Bench {
public:
    explicit Bench(const std::string &token)
        : handler_({control_, {token, {}}, [this] { return hub_.newest_pose(); }})
    {
    }

    bool listen(const ServerOptions &options)
    {
        std::string error;
        server_ = ConsoleServer::create(options, handler_, hub_, error);
        std::cout << (server_ ? std::to_string(server_->port()) : error) << std::endl;
        return server_ != nullptr;
    }

    void take(const std::string &line);

private:
    void publish_poses(std::uint64_t count);
    void add_picture();
    std::string figures() const;

    StreamHub hub_;
    FakeControl control_;
    ApiHandler handler_;
    std::unique_ptr<ConsoleServer> server_;
    std::vector<unsigned char> pixels_;
    std::uint64_t poses_ = 0;
};

void Bench::publish_poses(std::uint64_t count)
{
    for (std::uint64_t i = 0; i < count; i++) {
        auto pose = std::make_shared<PoseRecord>();
        pose->number = ++poses_;
        pose->location.state = OPMS_BAR_LOCATED;
        pose->squares.resize(20);
        hub_.on_pose(pose);
    }
    std::cout << "published " << count << std::endl;
}

void Bench::add_picture()
{
    pixels_.assign(WIDTH_PX * HEIGHT_PX, 0);
    for (std::size_t i = 0; i < pixels_.size(); i++) {
        pixels_[i] = static_cast<unsigned char>(i % 251);
    }
    auto frame = std::make_shared<Frame>();
    frame->image = {pixels_.data(), WIDTH_PX, HEIGHT_PX, WIDTH_PX, OPMS_PIXEL_GREY8, 0};
    const std::lock_guard<std::mutex> lock(control_.mutex);
    control_.picture = frame;
    std::cout << "picture" << std::endl;
}

std::string Bench::figures() const
{
    const ServerFigures server = server_->figures();
    return nlohmann::json{{"published", hub_.published()[0]},
                          {"lost", hub_.lost()[0]},
                          {"requests", server.requests},
                          {"refused_connections", server.refused_connections},
                          {"stalled", server.stalled},
                          {"connections", server.connections},
                          {"clients", server.clients}}
        .dump();
}

void Bench::take(const std::string &line)
{
    std::istringstream words(line);
    std::string verb, rest;
    words >> verb;
    std::getline(words >> std::ws, rest);
    if (verb == "pose") {
        publish_poses(std::stoull(rest));
    } else if (verb == "event") {
        EventRecord event;
        event.code = "box.lost";
        event.text = "the box is not there any more";
        hub_.on_event(event);
        std::cout << "published 1" << std::endl;
    } else if (verb == "picture") {
        add_picture();
    } else if (verb == "scan") {
        const std::lock_guard<std::mutex> lock(control_.mutex);
        control_.now.scan = rest;
        control_.now.state = rest.empty() ? SessionState::idle : SessionState::ready;
        std::cout << "scan" << std::endl;
    } else if (verb == "figures") {
        std::cout << figures() << std::endl;
    } else {
        std::cout << "what?" << std::endl;
    }
}

}  // namespace

int main(int argc, char **argv)
{
    if (argc < 2) {
        std::fprintf(stderr, "usage: console_bench TOKEN [--cert F --key F] ...\n");
        return 2;
    }
    auto options = read_options(argc, argv);
    ServerOptions server;
    server.listen.port = 0;
    server.cert_path = options["--cert"];
    server.key_path = options["--key"];
    server.stall_ms = number_or(options, "--stall-ms", server.stall_ms);
    server.clients_max = number_or(options, "--clients", server.clients_max);
    server.request_ms = number_or(options, "--request-ms", server.request_ms);
    server.idle_ms = number_or(options, "--idle-ms", server.idle_ms);
    server.send_buffer_bytes = 16384; /* so that a stalled client shows soon */
    Bench bench(argv[1]);
    if (!bench.listen(server)) {
        return 3;
    }
    for (std::string line; std::getline(std::cin, line);) {
        bench.take(line);
    }
    return 0;
}
