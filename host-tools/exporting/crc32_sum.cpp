/* SPDX-License-Identifier: Apache-2.0 */
#include "crc32_sum.hpp"

#include <zlib.h>

namespace opms_host {

void Crc32Sum::add(const void *bytes, std::size_t size)
{
    const uLong sum = crc32_z(sum_, static_cast<const Bytef *>(bytes), size);
    sum_ = static_cast<std::uint32_t>(sum);
}

}  // namespace opms_host
