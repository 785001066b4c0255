/* SPDX-License-Identifier: Apache-2.0 */
#include "crc32_sum.hpp"

#include <array>

namespace opms_host {

namespace {

constexpr std::uint32_t REFLECTED_POLYNOMIAL = 0xEDB88320U;

std::array<std::uint32_t, 256> make_table()
{
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < 256; byte++) {
        std::uint32_t value = byte;
        for (int bit = 0; bit < 8; bit++) {
            value = (value >> 1) ^ ((value & 1U) != 0 ? REFLECTED_POLYNOMIAL : 0U);
        }
        table[byte] = value;
    }
    return table;
}

}  // namespace

void Crc32Sum::add(const void *bytes, std::size_t size)
{
    static const std::array<std::uint32_t, 256> table = make_table();
    const auto *byte = static_cast<const unsigned char *>(bytes);
    for (std::size_t i = 0; i < size; i++) {
        state_ = table[(state_ ^ byte[i]) & 255U] ^ (state_ >> 8);
    }
}

}  // namespace opms_host
