/* SPDX-License-Identifier: Apache-2.0 */
/* opms serve: a session that a Master PC starts, stops and listens to over the network. */
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "access_token.hpp"
#include "api_handler.hpp"
#include "commands.hpp"
#include "console_server.hpp"
#include "interrupted.hpp"
#include "listen_address.hpp"
#include "live_control.hpp"
#include "live_options.hpp"
#include "result_stream.hpp"
#include "scan_feed.hpp"
#include "scan_view.hpp"
#include "sensor_feeder.hpp"

namespace {

using namespace opms_host;

constexpr std::uint32_t STEP_MS = 100;

struct ServeArguments {
    LiveArguments live;
    std::string listen = "127.0.0.1:47660", token_file;
    ServerOptions server;
    bool insecure = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** The whole of it, from the session to the network. Members end in reverse order: first nobody
 * asks any more, then the session goes, at last those who listened to it. */
class Serve {
public:
    Serve(const ServeArguments &arguments, std::vector<SensorFile> sensors)
        : arguments_(arguments), feeder_(std::move(sensors))
    {
    }

    int run(const std::string &token);

private:
    bool open(const std::string &token, int &exit_code);
    void feed();
    void show(std::uint32_t timeout_ms);
    int stop();

    const ServeArguments &arguments_;
    SensorFeeder feeder_;
    StreamHub hub_;
    ScanFeed news_;
    SessionState state_ = SessionState::idle;
    std::unique_ptr<LiveSession> session_;
    std::unique_ptr<LiveControl> control_;
    std::unique_ptr<ApiHandler> handler_;
    std::unique_ptr<ConsoleServer> server_;
};

bool Serve::open(const std::string &token, int &exit_code)
{
    session_ = open_live_session(arguments_.live, exit_code);
    if (!session_) {
        return false;
    }
    session_->add_listener(&hub_);
    session_->add_listener(&news_);
    const LiveArguments &live = arguments_.live;
    control_ = std::make_unique<LiveControl>(
        *session_, LiveControlOptions{
                       live_scans_folder(live),
                       [&live](const std::string &name) { return live_scan_request(live, name); },
                       [this] { feed(); }});
    const ServerOptions &options = arguments_.server;
    handler_ = std::make_unique<ApiHandler>(ApiContext{
        *control_, {token, options.listen}, [this] { return hub_.newest_pose(); }});
    std::string error;
    server_ = ConsoleServer::create(options, *handler_, hub_, error);
    if (!server_) {
        talk(error);
        exit_code = EXIT_CODE_INPUT;
        return false;
    }
    if (!session_->connect(error)) {
        talk(error);
        exit_code = EXIT_CODE_DEVICE;
        return false;
    }
    return true;
}

void Serve::feed()
{
    live_feed_sensors(feeder_, *session_);
}

/** Events and states, for the person at this machine. */
void Serve::show(std::uint32_t timeout_ms)
{
    std::deque<ScanFeed::Item> items;
    news_.take(timeout_ms, items);
    for (const ScanFeed::Item &item : items) {
        if (const auto *event = std::get_if<EventRecord>(&item)) {
            talk(scan_event_text(*event));
        } else if (const auto *status = std::get_if<SessionStatus>(&item)) {
            if (status->state != state_) {
                talk(scan_state_text(status->state));
            }
            state_ = status->state;
        }
    }
}

/** Whatever goes on is ended in order, and its recording closed; those who listen hear of it. */
int Serve::stop()
{
    ScanEnd end;
    ControlError error;
    while (!control_->stop_scan(end, error)) {
        if (session_->status().scan.empty()) {
            return EXIT_CODE_OK; /* there was none, or it ended by itself */
        }
        if (error.kind == ControlFailure::unavailable) {
            talk(error.text);
            return EXIT_CODE_INPUT;
        }
        show(STEP_MS); /* a client stops or starts it just now */
    }
    talk("the scan has been stopped, and its recording closed");
    return EXIT_CODE_OK;
}

int Serve::run(const std::string &token)
{
    int exit_code = EXIT_CODE_OK;
    if (!open(token, exit_code)) {
        return exit_code;
    }
    const ListenAddress &listen = arguments_.server.listen;
    ResultStream out;
    out.write_line(std::string(arguments_.server.cert_path.empty() ? "http" : "https") + "://" +
                   listen.url_host() + ":" + std::to_string(server_->port()) + "/api/v1/");
    while (!interrupted()) {
        show(STEP_MS);
        feed();
    }
    exit_code = stop();
    show(0);
    server_.reset();
    return exit_code;
}

/** The owner's token, or one for this run. @return false with an exit code. */
bool find_token(const ServeArguments &arguments, std::string &token, int &exit_code)
{
    std::string error;
    if (!arguments.token_file.empty()) {
        if (!access_token_read(arguments.token_file, token, error)) {
            talk(error);
            exit_code = EXIT_CODE_INPUT;
            return false;
        }
        return true;
    }
    token = access_token_make();
    if (token.empty()) {
        talk("this system gives no random numbers for a token");
        exit_code = EXIT_CODE_INPUT;
        return false;
    }
    talk("token of this run: " + token);
    return true;
}

int usage(const std::string &text)
{
    talk(text);
    return EXIT_CODE_USAGE;
}

int serve(ServeArguments arguments)
{
    ServerOptions &server = arguments.server;
    std::string problem = parse_listen_address(arguments.listen, server.listen);
    if (problem.empty() && server.cert_path.empty() != server.key_path.empty()) {
        problem = "--cert and --key belong together";
    }
    if (problem.empty()) {
        problem = listen_refusal(server.listen, {!arguments.token_file.empty(),
                                                 !server.cert_path.empty(), arguments.insecure});
    }
    if (!problem.empty()) {
        return usage(problem);
    }
    std::vector<SensorFile> sensors;
    if (!live_sensor_files(arguments.live, sensors)) {
        return EXIT_CODE_USAGE;
    }
    if (!server.listen.is_loopback && server.cert_path.empty()) {
        talk("warning: without TLS everybody on this network can read the token and all else");
    }
    std::string token;
    int exit_code = EXIT_CODE_OK;
    if (!find_token(arguments, token, exit_code)) {
        return exit_code;
    }
    catch_interrupts();
    return Serve(arguments, std::move(sensors)).run(token);
}

}  // namespace

void add_cmd_serve(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<ServeArguments>();
    CLI::App *cmd = app.add_subcommand(
        "serve", "A session for a Master PC: start, stop and positions over HTTP and WebSocket.");
    add_live_options(*cmd, arguments->live);
    cmd->add_option("--listen", arguments->listen,
                    "Where to listen [127.0.0.1:47660]; port 0: any that is free")
        ->type_name("ADDR:PORT");
    cmd->add_option("--token-file", arguments->token_file,
                    "File with the token that opens the interface [one is made and told]")
        ->type_name("FILE");
    cmd->add_option("--cert", arguments->server.cert_path, "Certificate for TLS, with its chain")
        ->type_name("FILE.pem");
    cmd->add_option("--key", arguments->server.key_path, "Key of the certificate")
        ->type_name("FILE.pem");
    cmd->add_flag("--insecure", arguments->insecure,
                  "Beyond this machine without TLS, where nobody else is on the network");
    cmd->callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}
