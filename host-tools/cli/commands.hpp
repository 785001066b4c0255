/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The subcommands of `opms`. Each adds itself to the program and sets @p exit_code when it runs. */
#ifndef OPMS_CLI_COMMANDS_HPP
#define OPMS_CLI_COMMANDS_HPP

namespace CLI {
class App;
}

/** What the program's exit codes mean; docs/locate.md and docs/box.md tell users. */
enum ExitCode {
    EXIT_CODE_OK = 0,
    EXIT_CODE_RESULT = 1, /**< a result failed the limit that was asked for */
    EXIT_CODE_USAGE = 2,
    EXIT_CODE_DEVICE = 3, /**< no such device, or it does not answer */
    EXIT_CODE_INPUT = 4,  /**< a file could not be read, or results not written */
    EXIT_CODE_LOST = 5    /**< pulses or frames were lost */
};

void add_cmd_box(CLI::App &app, int &exit_code);
void add_cmd_calibrate(CLI::App &app, int &exit_code);
void add_cmd_camera(CLI::App &app, int &exit_code);
void add_cmd_catalogue(CLI::App &app, int &exit_code);
void add_cmd_export(CLI::App &app, int &exit_code);
void add_cmd_locate(CLI::App &app, int &exit_code);
void add_cmd_nodes(CLI::App &app, int &exit_code);
void add_cmd_print(CLI::App &app, int &exit_code);
void add_cmd_replay(CLI::App &app, int &exit_code);
void add_cmd_scan(CLI::App &app, int &exit_code);
void add_cmd_serve(CLI::App &app, int &exit_code);
void add_cmd_siggen(CLI::App &app, int &exit_code);
void add_cmd_simulate(CLI::App &app, int &exit_code);

#endif
