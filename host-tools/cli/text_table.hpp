/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Lines of text for people: formatted numbers, and columns that stay straight. */
#ifndef OPMS_CLI_TEXT_TABLE_HPP
#define OPMS_CLI_TEXT_TABLE_HPP

#include <cstddef>
#include <string>
#include <vector>

/** As std::snprintf(), up to 511 bytes. */
__attribute__((format(printf, 1, 2))) std::string text_format(const char *format, ...);

/** Filled up with spaces to @p width characters; bytes of one UTF-8 character count once. */
std::string text_padded(const std::string &name, std::size_t width);

/** Width of a column of names: that of the longest, at least 7 and at most 60. */
std::size_t text_name_width(const std::vector<std::string> &names);

#endif
