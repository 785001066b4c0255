/* SPDX-License-Identifier: Apache-2.0 */
#include <algorithm>
#include <filesystem>

#include "scan_folder.hpp"
#include "scan_reader.hpp"

namespace opms_host {

std::vector<ScanSummary> list_scans(const std::string &folder, std::vector<std::string> &failed)
{
    namespace fs = std::filesystem;
    std::vector<ScanSummary> scans;
    std::error_code code;
    fs::directory_iterator entries(folder, code);
    if (code) {
        failed.push_back(folder + ": " + code.message());
        return scans;
    }
    for (const fs::directory_entry &entry : entries) {
        const bool hidden = entry.path().filename().string().rfind('.', 0) == 0;
        if (hidden || !fs::exists(entry.path() / SCAN_DATABASE_NAME, code)) {
            continue;
        }
        std::string error;
        const auto reader = ScanReader::open(entry.path().string(), error);
        if (reader) {
            scans.push_back(reader->summary());
        } else {
            failed.push_back(error);
        }
    }
    std::sort(failed.begin(), failed.end());
    std::sort(scans.begin(), scans.end(), [](const ScanSummary &a, const ScanSummary &b) {
        return a.header.begun_wall_ns != b.header.begun_wall_ns
                   ? a.header.begun_wall_ns < b.header.begun_wall_ns
                   : a.name < b.name;
    });
    return scans;
}

}  // namespace opms_host
