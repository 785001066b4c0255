/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The folder of a scan: its names, and how it comes to be all at once. */
#ifndef OPMS_RECORDING_SCAN_FOLDER_HPP
#define OPMS_RECORDING_SCAN_FOLDER_HPP

#include <memory>
#include <string>

#include "scan_lock.hpp"
#include "scan_records.hpp"

namespace opms_host {

constexpr const char SCAN_DATABASE_NAME[] = "scan.sqlite";
constexpr const char SCAN_LOCK_NAME[] = "scan.lock";

struct NewScanFolder {
    std::string path;
    std::unique_ptr<ScanLock> lock;
};

/** Make @p folder / header.name with an empty database that holds the header, durably. After a
 * kill or a power cut at any instant it is there and readable, or not there.
 * @return False with @p error. */
bool scan_folder_make(const std::string &folder, const ScanHeader &header, NewScanFolder &made,
                      std::string &error);

/** Whether a name may be that of a scan. @p error says why not. */
bool scan_name_check(const std::string &name, std::string &error);

}  // namespace opms_host
#endif
