/* SPDX-License-Identifier: Apache-2.0 */
#include "result_stream.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

bool ResultStream::write_line(const std::string &line)
{
    if (failed_) {
        return false;
    }
    errno = 0;
    const bool written = std::fwrite(line.data(), 1, line.size(), stdout) == line.size() &&
                         std::fputc('\n', stdout) != EOF && std::fflush(stdout) == 0;
    if (!written) {
        failed_ = true;
        if (errno != EPIPE) {
            std::fprintf(stderr, "opms: cannot write results: %s\n", std::strerror(errno));
        }
    }
    return written;
}
