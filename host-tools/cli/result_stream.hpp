/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Results on stdout, line by line, with every failure to write noticed at once. */
#ifndef OPMS_CLI_RESULT_STREAM_HPP
#define OPMS_CLI_RESULT_STREAM_HPP

#include <string>

class ResultStream {
public:
    /** Write a line and push it out. After a failure nothing more is written.
     * A reader that has gone away (a closed pipe) fails silently, anything else says why on
     * stderr. @return false once writing has failed. */
    bool write_line(const std::string &line);
    bool failed() const { return failed_; }

private:
    bool failed_ = false;
};

#endif
