/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the program that are loaded when they are first needed. */
#ifndef OPMS_MODULES_PROGRAM_MODULE_HPP
#define OPMS_MODULES_PROGRAM_MODULE_HPP

#include <string>

namespace opms_host {

/** Load a module (once; it stays) and find a function in it.
 *
 * It is looked for where the program looks for its shared libraries (its RUNPATH).
 *
 * @param module  File name, as "opms_preview.so".
 * @return NULL with @p error, which names the module. */
void *program_module_symbol(const char *module, const char *symbol, std::string &error);

}  // namespace opms_host
#endif
