/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A few lines of a terminal, drawn over again and again. */
#ifndef OPMS_CLI_TEXT_SCREEN_HPP
#define OPMS_CLI_TEXT_SCREEN_HPP

#include <cstddef>
#include <string>
#include <vector>

/** Draws lines on stdout over those of the last time, by plain ANSI. */
class TextScreen {
public:
    /** @return false where stdout cannot be written. */
    bool draw(const std::vector<std::string> &lines);

private:
    std::size_t drawn_ = 0;
};

#endif
