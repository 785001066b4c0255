/* SPDX-License-Identifier: Apache-2.0 */
#include "scans_folder.hpp"

#include <cstdlib>
#include <filesystem>

namespace fs = std::filesystem;

std::string scans_folder()
{
    const char *chosen = std::getenv("OPMS_SCANS");
    if (chosen && *chosen) {
        return chosen;
    }
    const char *home = std::getenv("HOME");
    return (fs::path(home && *home ? home : ".") / "opms-scans").string();
}

std::string scan_path(const std::string &scan, const std::string &folder)
{
    std::error_code ignored;
    if (fs::exists(scan, ignored) || fs::path(scan).is_absolute()) {
        return scan;
    }
    const fs::path named = fs::path(folder.empty() ? scans_folder() : folder) / scan;
    return !scan.empty() && fs::exists(named, ignored) ? named.string() : scan;
}
