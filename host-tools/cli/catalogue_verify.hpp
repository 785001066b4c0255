/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Is a recorded scan sound? */
#ifndef OPMS_CLI_CATALOGUE_VERIFY_HPP
#define OPMS_CLI_CATALOGUE_VERIFY_HPP

#include <cstdint>
#include <string>
#include <vector>

struct VerifyOutcome {
    std::string name;
    bool readable = false;
    std::uint64_t pictures = 0; /**< looked at */
    /** What is wrong, one line each; those after the first 100 are counted only. */
    std::vector<std::string> problems;
    std::uint64_t problem_count = 0;
    std::vector<std::string> notes; /**< what is odd, but may be */

    bool sound() const { return readable && problem_count == 0; }
    void problem(const std::string &words);
};

/** Looks at the database (SQLite's own check), the pictures (each unpacked), the sums of triggers
 * and frames, and the order of times. @p folder  Of one scan. Never throws. */
VerifyOutcome catalogue_verify(const std::string &folder);

#endif
