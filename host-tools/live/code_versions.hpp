/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * With what code a scan was made: goes into its header, and a replay compares it. */
#ifndef OPMS_LIVE_CODE_VERSIONS_HPP
#define OPMS_LIVE_CODE_VERSIONS_HPP

#include <string>

namespace opms_host {

/** {"opms":"0.3.0","code":"91f0..."}; `code` is a sum over the sources of libopms. */
std::string code_versions_json();

/** Whether two such texts are of the same code: `code` is there and equal. */
bool code_versions_equal(const std::string &a, const std::string &b);

}  // namespace opms_host
#endif
