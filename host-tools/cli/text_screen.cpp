/* SPDX-License-Identifier: Apache-2.0 */
#include "text_screen.hpp"

#include <cstdio>

#include <sys/ioctl.h>
#include <unistd.h>

namespace {

/** Of the terminal; a line that wrapped would spoil the drawing. */
std::size_t columns()
{
    winsize size = {};
    return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/** The first @p width characters; bytes of one UTF-8 character count once. */
std::string cut(const std::string &line, std::size_t width)
{
    std::size_t characters = 0;
    for (std::size_t i = 0; i < line.size(); i++) {
        const bool begins = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
        if (begins && characters++ == width) {
            return line.substr(0, i);
        }
    }
    return line;
}

}  // namespace

bool TextScreen::draw(const std::vector<std::string> &lines)
{
    if (drawn_ > 0) {
        std::printf("\033[%zuF", drawn_);
    }
    const std::size_t width = columns();
    for (const std::string &line : lines) {
        std::printf("%s\033[K\n", cut(line, width - 1).c_str());
    }
    std::printf("\033[J");
    drawn_ = lines.size();
    return std::fflush(stdout) == 0 && !std::ferror(stdout);
}
