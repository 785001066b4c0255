/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The verbs of `opms box`. Each adds itself to the group and sets @p exit_code when it runs. */
#ifndef OPMS_CLI_CMD_BOX_HPP
#define OPMS_CLI_CMD_BOX_HPP

namespace CLI {
class App;
}

#ifdef OPMS_CLI_HAVE_HID
void add_box_list(CLI::App &box, int &exit_code);
void add_box_info(CLI::App &box, int &exit_code);
void add_box_monitor(CLI::App &box, int &exit_code);
void add_box_settings(CLI::App &box, int &exit_code);
void add_box_selftest(CLI::App &box, int &exit_code);
#endif
#ifdef OPMS_CLI_HAVE_FLASH
void add_box_flash(CLI::App &box, int &exit_code);
#endif

#endif
