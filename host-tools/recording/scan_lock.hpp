/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A lock on a file, held until it is destroyed or its process has gone, however that ends. */
#ifndef OPMS_RECORDING_SCAN_LOCK_HPP
#define OPMS_RECORDING_SCAN_LOCK_HPP

#include <memory>
#include <string>

namespace opms_host {

class ScanLock {
public:
    /** Make the file if it is missing, and lock it. Waits up to @p wait_ms for who holds it.
     * @return NULL with @p error; @p held says whether somebody else has it. */
    static std::unique_ptr<ScanLock> take(const std::string &path, int wait_ms, bool &held,
                                          std::string &error);
    /** Whether somebody holds it now. Looks only; takes and makes nothing. */
    static bool is_held(const std::string &path);
    ~ScanLock();
    ScanLock(const ScanLock &) = delete;
    ScanLock &operator=(const ScanLock &) = delete;

private:
    explicit ScanLock(int file) : file_(file) {}
    int file_;
};

}  // namespace opms_host
#endif
