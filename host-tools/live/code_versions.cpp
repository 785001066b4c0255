/* SPDX-License-Identifier: Apache-2.0 */
#include "code_versions.hpp"

#include <nlohmann/json.hpp>
#include <opms/version.h>

#include "code_sum.h" /* made by source_sum.cmake */

namespace opms_host {

namespace {

std::string code_of(const std::string &text)
{
    const nlohmann::json versions = nlohmann::json::parse(text, nullptr, false);
    if (!versions.is_object() || !versions.contains("code") || !versions["code"].is_string()) {
        return std::string();
    }
    return versions["code"].get<std::string>();
}

}  // namespace

std::string code_versions_json()
{
    return nlohmann::ordered_json{{"opms", opms_version()}, {"code", OPMS_CODE_SUM}}.dump();
}

bool code_versions_equal(const std::string &a, const std::string &b)
{
    const std::string code = code_of(a);
    return !code.empty() && code == code_of(b);
}

}  // namespace opms_host
