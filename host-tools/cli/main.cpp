/* SPDX-License-Identifier: Apache-2.0 */
/* The `opms` program: options shared by all subcommands, and the last line of defence. */
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>

#include <opms/version.h>

#include "commands.hpp"

namespace {

/** What is still buffered may fail to be written, too (a full disk). */
int finish(int exit_code)
{
    if ((std::fflush(stdout) != 0 || std::ferror(stdout)) && exit_code == EXIT_CODE_OK) {
        return EXIT_CODE_INPUT;
    }
    return exit_code;
}

int run(int argc, char **argv)
{
    int exit_code = EXIT_CODE_OK;
    CLI::App app("opms - where is the detector? Reads a coded marker bar in camera pictures.",
                 "opms");
    app.set_version_flag("--version", std::string("opms ") + opms_version());
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    add_cmd_locate(app, exit_code);
    add_cmd_nodes(app, exit_code);
    add_cmd_calibrate(app, exit_code);
    add_cmd_camera(app, exit_code);
#ifdef OPMS_CLI_HAVE_PRINT
    add_cmd_print(app, exit_code);
#endif
#ifdef OPMS_CLI_HAVE_SIMULATE
    add_cmd_simulate(app, exit_code);
#endif
    add_cmd_box(app, exit_code);
#ifdef OPMS_CLI_HAVE_LIVE
    add_cmd_scan(app, exit_code);
#endif
#ifdef OPMS_CLI_HAVE_SERVE
    add_cmd_serve(app, exit_code);
#endif
#ifdef OPMS_CLI_HAVE_SCANS
    add_cmd_replay(app, exit_code);
    add_cmd_export(app, exit_code);
    add_cmd_catalogue(app, exit_code);
#endif
#ifdef OPMS_CLI_HAVE_SIGGEN
    add_cmd_siggen(app, exit_code);
#endif
    app.footer("'opms COMMAND --help' explains a command. Exit codes: 0 ok, 1 a result failed its\n"
               "limit, 2 usage, 3 no device, 4 a file could not be read or written, 5 pulses or\n"
               "frames were lost.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError &e) {
        return app.exit(e) == 0 ? EXIT_CODE_OK : EXIT_CODE_USAGE;
    }
    return exit_code;
}

}  // namespace

int main(int argc, char **argv)
{
#ifdef SIGPIPE
    /* A reader that has gone shows as a failed write, which every command checks. */
    std::signal(SIGPIPE, SIG_IGN);
#endif
    try {
        return finish(run(argc, argv));
    } catch (const std::exception &e) {
        std::fprintf(stderr, "opms: %s\n", e.what());
        return EXIT_CODE_INPUT;
    }
}
