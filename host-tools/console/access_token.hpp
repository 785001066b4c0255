/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The secret that opens the interface. */
#ifndef OPMS_CONSOLE_ACCESS_TOKEN_HPP
#define OPMS_CONSOLE_ACCESS_TOKEN_HPP

#include <string>

namespace opms_host {

/** 256 random bits in 43 characters; empty where the system has no randomness. */
std::string access_token_make();

/** The first line of a file that nobody but its owner may read or write.
 * @return false with @p error. */
bool access_token_read(const std::string &path, std::string &token, std::string &error);

/** 16 to 256 letters, digits, "-", "_", ".", "~": they fit into every header. */
bool access_token_is_valid(const std::string &token);

/** Takes as long for a wrong one as for a right one, whatever it looks like. */
bool access_token_equal(const std::string &given, const std::string &wanted);

}  // namespace opms_host
#endif
