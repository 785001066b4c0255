/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Ctrl-C and its likes, for commands that go on until they are told to stop. */
#ifndef OPMS_CLI_INTERRUPTED_HPP
#define OPMS_CLI_INTERRUPTED_HPP

/** From now on a first SIGINT or SIGTERM is remembered, and a second one ends the program. */
void catch_interrupts();

/** Whether one came. */
bool interrupted();

#endif
