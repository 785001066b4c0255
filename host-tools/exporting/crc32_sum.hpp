/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * CRC-32 of Ethernet, ZIP and PNG (polynomial 0x04C11DB7, reflected), which MCAP uses. */
#ifndef OPMS_EXPORTING_CRC32_SUM_HPP
#define OPMS_EXPORTING_CRC32_SUM_HPP

#include <cstddef>
#include <cstdint>

namespace opms_host {

/** Of bytes that come in pieces. */
class Crc32Sum {
public:
    void add(const void *bytes, std::size_t size);
    std::uint32_t value() const { return sum_; }

private:
    std::uint32_t sum_ = 0;
};

}  // namespace opms_host
#endif
