/* SPDX-License-Identifier: Apache-2.0 */
#include "uf2_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <map>
#include <system_error>

#include "little_endian.hpp"

namespace opms::flash {

namespace {

constexpr std::size_t BLOCK_BYTES = 512;
constexpr std::size_t DATA_OFFSET = 32;
constexpr std::uint32_t MAGIC_FIRST = 0x0A324655;
constexpr std::uint32_t MAGIC_SECOND = 0x9E5D5157;
constexpr std::uint32_t MAGIC_LAST = 0x0AB16F30;
constexpr std::uint32_t FLAG_NOT_MAIN_FLASH = 0x00000001;
constexpr std::uint32_t FLAG_FILE_CONTAINER = 0x00001000;
constexpr std::uint32_t FLAG_FAMILY = 0x00002000;
constexpr std::uint32_t FAMILY_RP2040 = 0xE48BFF56;
constexpr std::uint32_t RAM_START = 0x20000000, RAM_END = 0x20042000;
/** As many blocks as fill the flash; more cannot be a firmware for it. */
constexpr std::size_t BLOCKS_MAX = FLASH_BYTES / PAGE_BYTES;

struct Block {
    std::uint32_t flags, address, size, number, count, family;
    const std::uint8_t *data;
};

std::string hex(std::uint32_t value)
{
    char text[16];
    std::snprintf(text, sizeof text, "0x%08" PRIX32, value);
    return text;
}

[[noreturn]] void refuse(std::size_t index, const std::string &why)
{
    throw FileError("block " + std::to_string(index + 1) + " " + why);
}

bool has_magic(const std::uint8_t *bytes)
{
    return u32_at(bytes) == MAGIC_FIRST && u32_at(bytes + 4) == MAGIC_SECOND;
}

void check_size(const std::uint8_t *bytes, std::size_t size)
{
    if (size == 0) {
        throw FileError("the file is empty");
    }
    if (size < 8 || !has_magic(bytes)) {
        throw FileError("this is no UF2 file: it does not begin with UF2's magic numbers");
    }
    if (size % BLOCK_BYTES != 0) {
        throw FileError("the file ends within a block, after " + std::to_string(size) +
                        " bytes: it was cut short; copy or build it again");
    }
    if (size / BLOCK_BYTES > BLOCKS_MAX) {
        throw FileError("the file is too large: " + std::to_string(size / BLOCK_BYTES) +
                        " blocks, and the box's flash holds " + std::to_string(BLOCKS_MAX));
    }
}

Block block_at(const std::uint8_t *bytes, std::size_t index)
{
    if (!has_magic(bytes) || u32_at(bytes + BLOCK_BYTES - 4) != MAGIC_LAST) {
        refuse(index, "has wrong magic numbers: the file is damaged");
    }
    return {u32_at(bytes + 8),  u32_at(bytes + 12), u32_at(bytes + 16), u32_at(bytes + 20),
            u32_at(bytes + 24), u32_at(bytes + 28), bytes + DATA_OFFSET};
}

void check_family(const Block &block, std::size_t index)
{
    if ((block.flags & FLAG_FILE_CONTAINER) != 0) {
        refuse(index, "holds a part of another file, not a firmware");
    }
    if ((block.flags & FLAG_FAMILY) == 0) {
        refuse(index, "does not say for which microcontroller it is; it must be for the RP2040");
    }
    if (block.family != FAMILY_RP2040) {
        refuse(index, "is for another microcontroller (family " + hex(block.family) +
                          "), not for the RP2040 (" + hex(FAMILY_RP2040) + ")");
    }
}

void check_place(const Block &block, std::size_t index)
{
    if (block.size != PAGE_BYTES) {
        refuse(index, "holds " + std::to_string(block.size) + " bytes; the RP2040 takes 256");
    }
    if (block.address >= RAM_START && block.address < RAM_END) {
        refuse(index, "is for RAM (" + hex(block.address) +
                          "): such a program is gone after a reset; build it for flash");
    }
    if (block.address < FLASH_START || block.address > FLASH_START + FLASH_BYTES - PAGE_BYTES) {
        refuse(index, "is for address " + hex(block.address) + ", outside of the 2 MiB of flash");
    }
    if (block.address % PAGE_BYTES != 0) {
        refuse(index, "is for address " + hex(block.address) + ", no multiple of 256");
    }
}

/** Which numbers were seen, by whatever order. */
class Numbers {
public:
    explicit Numbers(std::size_t blocks) : blocks_(blocks) {}

    void take(const Block &block, std::size_t index)
    {
        if (index == 0) {
            count_ = block.count;
            check_count();
            seen_.assign(count_, false);
        }
        if (block.count != count_) {
            refuse(index, "says that the file has " + std::to_string(block.count) +
                              " blocks, the first one said " + std::to_string(count_));
        }
        if (block.number >= count_) {
            refuse(index, "is numbered " + std::to_string(block.number) + " of " +
                              std::to_string(count_) + " (numbers begin with 0)");
        }
        if (seen_[block.number]) {
            refuse(index, "has the number " + std::to_string(block.number) +
                              ", which an earlier block has");
        }
        seen_[block.number] = true;
    }

private:
    void check_count() const
    {
        if (count_ > blocks_) {
            throw FileError("the file was cut short: it has " + std::to_string(blocks_) + " of " +
                            std::to_string(count_) + " blocks; copy or build it again");
        }
        if (count_ < blocks_) {
            throw FileError("the file has " + std::to_string(blocks_) + " blocks and says " +
                            std::to_string(count_) + ": it is damaged, or two files in one");
        }
    }

    std::size_t blocks_;
    std::uint32_t count_ = 0;
    std::vector<bool> seen_;
};

/** Data by address; what repeats is refused. */
class Pages {
public:
    void take(const Block &block, std::size_t index)
    {
        if (!pages_.emplace(block.address, block.data).second) {
            refuse(index, "is for address " + hex(block.address) + ", as an earlier block is");
        }
    }

    Image image() const
    {
        Image image;
        image.payload_bytes = pages_.size() * PAGE_BYTES;
        for (const auto &[address, data] : pages_) {
            const std::uint32_t start = address - address % SECTOR_BYTES;
            if (image.sectors.empty() || image.sectors.back().address != start) {
                image.sectors.emplace_back();
                image.sectors.back().address = start;
                image.sectors.back().bytes.fill(0xFF);
            }
            std::copy_n(data, PAGE_BYTES, image.sectors.back().bytes.data() + (address - start));
        }
        return image;
    }

private:
    std::map<std::uint32_t, const std::uint8_t *> pages_;
};

}  // namespace

Image uf2_parse(const std::uint8_t *bytes, std::size_t size)
{
    check_size(bytes, size);
    const std::size_t blocks = size / BLOCK_BYTES;
    Numbers numbers(blocks);
    Pages pages;
    for (std::size_t i = 0; i < blocks; ++i) {
        const Block block = block_at(bytes + i * BLOCK_BYTES, i);
        check_family(block, i);
        numbers.take(block, i);
        if ((block.flags & FLAG_NOT_MAIN_FLASH) == 0) {
            check_place(block, i);
            pages.take(block, i);
        }
    }
    const Image image = pages.image();
    if (image.sectors.empty()) {
        throw FileError("no block of the file is for the flash");
    }
    return image;
}

Image uf2_read(const std::string &path)
{
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    std::vector<std::uint8_t> bytes;
    /* One block more than can be right tells a file that is too large. */
    bytes.resize((BLOCKS_MAX + 1) * BLOCK_BYTES);
    if (file) {
        file.read(reinterpret_cast<char *>(bytes.data()), static_cast<long>(bytes.size()));
    }
    if (!file.is_open() || file.bad() || (file.gcount() == 0 && errno != 0)) {
        throw FileError(path + ": cannot be read: " + std::generic_category().message(errno));
    }
    try {
        return uf2_parse(bytes.data(), static_cast<std::size_t>(file.gcount()));
    } catch (const FileError &error) {
        throw FileError(path + ": " + error.what());
    }
}

}  // namespace opms::flash
