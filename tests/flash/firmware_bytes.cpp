/* SPDX-License-Identifier: Apache-2.0 */
#include "firmware_bytes.hpp"

#include <algorithm>
#include <fstream>
#include <random>

void set_u32(Bytes &bytes, std::size_t at, std::uint32_t value)
{
    for (std::size_t i = 0; i < 4; ++i) {
        bytes.at(at + i) = static_cast<std::uint8_t>(value >> (8 * i));
    }
}

std::uint32_t get_u32(const Bytes &bytes, std::size_t at)
{
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) {
        value = value << 8 | bytes.at(at + i);
    }
    return value;
}

constexpr std::uint64_t POLYNOMIAL = 0x104C11DB7;

std::uint32_t long_division_crc(const Bytes &bytes, std::size_t size)
{
    /* The message's bits with 32 zeros behind; the start value is added to its first 32 bits. */
    std::vector<bool> bits;
    for (std::size_t i = 0; i < size; ++i) {
        for (int bit = 7; bit >= 0; --bit) {
            bits.push_back((bytes[i] >> bit & 1) != (i < 4));
        }
    }
    bits.resize(bits.size() + 32, false);
    for (std::size_t i = 0; i + 32 < bits.size(); ++i) {
        for (std::size_t k = 0; bits[i] && k <= 32; ++k) {
            const std::size_t j = 32 - k; /* the leading bit, which decides, goes last */
            bits[i + j] = bits[i + j] != ((POLYNOMIAL >> (32 - j) & 1) != 0);
        }
    }
    std::uint32_t crc = 0;
    for (std::size_t i = bits.size() - 32; i < bits.size(); ++i) {
        crc = crc << 1 | (bits[i] ? 1U : 0U);
    }
    return crc;
}

bool rom_would_boot(const Bytes &flash)
{
    return long_division_crc(flash, 252) == get_u32(flash, 252);
}

Bytes make_firmware(std::size_t size, unsigned seed)
{
    std::mt19937 random(seed);
    Bytes bytes(size);
    std::generate(bytes.begin(), bytes.end(),
                  [&] { return static_cast<std::uint8_t>(random() >> 24); });
    set_u32(bytes, 252, long_division_crc(bytes, 252));
    set_u32(bytes, 256, 0x20042000);         /* stack */
    set_u32(bytes, 260, TEST_FLASH + 0x1F7); /* first instruction, in Thumb */
    const Bytes descriptor = {0x06, 0x4F, 0xFF, 0x09, 0x01, 0xA1, 0x01};
    std::copy(descriptor.begin(), descriptor.end(), bytes.begin() + 300);
    return bytes;
}

Bytes make_block(std::uint32_t address, const Bytes &page, std::uint32_t number,
                 std::uint32_t count)
{
    Bytes block(512);
    set_u32(block, 0, 0x0A324655);
    set_u32(block, 4, 0x9E5D5157);
    set_u32(block, 8, 0x2000); /* a family is given */
    set_u32(block, 12, address);
    set_u32(block, 16, 256);
    set_u32(block, 20, number);
    set_u32(block, 24, count);
    set_u32(block, 28, 0xE48BFF56);
    std::copy(page.begin(), page.end(), block.begin() + 32);
    set_u32(block, 508, 0x0AB16F30);
    return block;
}

Bytes make_uf2(const Bytes &firmware)
{
    const std::size_t count = (firmware.size() + 255) / 256;
    Bytes file;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t end = std::min(firmware.size(), (i + 1) * 256);
        const Bytes page(firmware.begin() + static_cast<std::ptrdiff_t>(i * 256),
                         firmware.begin() + static_cast<std::ptrdiff_t>(end));
        const Bytes block =
            make_block(TEST_FLASH + static_cast<std::uint32_t>(i * 256), page,
                       static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(count));
        file.insert(file.end(), block.begin(), block.end());
    }
    return file;
}

void write_file(const std::string &path, const Bytes &bytes)
{
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}
