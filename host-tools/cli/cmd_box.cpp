/* SPDX-License-Identifier: Apache-2.0 */
/* opms box: the group of commands about the trigger box. */
#include <CLI/CLI.hpp>

#include "cmd_box.hpp"
#include "commands.hpp"

void add_cmd_box(CLI::App &app, int &exit_code)
{
#if defined(OPMS_CLI_HAVE_HID) || defined(OPMS_CLI_HAVE_FLASH)
    CLI::App *box = app.add_subcommand(
        "box", "The trigger box: what is plugged in, is it well, and what does it do?");
    box->require_subcommand(1);
#ifdef OPMS_CLI_HAVE_HID
    add_box_list(*box, exit_code);
    add_box_info(*box, exit_code);
    add_box_monitor(*box, exit_code);
    add_box_settings(*box, exit_code);
    add_box_selftest(*box, exit_code);
#endif
#ifdef OPMS_CLI_HAVE_FLASH
    add_box_flash(*box, exit_code);
#endif
#else
    (void)app;
    (void)exit_code;
#endif
}
