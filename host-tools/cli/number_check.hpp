/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Checks of numbers that CLI11 has not, or that let NaN through there. */
#ifndef OPMS_CLI_NUMBER_CHECK_HPP
#define OPMS_CLI_NUMBER_CHECK_HPP

#include <string>

#include <CLI/CLI.hpp>

/** A time in seconds above 0, up to some 100 days. */
inline CLI::Validator seconds_check()
{
    constexpr double SECONDS_MAX = 1e7;
    return CLI::Validator(
        [](std::string &value) {
            double seconds = 0;
            const bool number = CLI::detail::lexical_cast(value, seconds);
            return number && seconds > 0 && seconds <= SECONDS_MAX
                       ? std::string()
                       : value + " is no time in seconds";
        },
        "");
}

#endif
