/* SPDX-License-Identifier: Apache-2.0 */
#include "flash_write.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cinttypes>
#include <cstdio>

#include "flash_error.hpp"

namespace opms::flash {

namespace {

[[noreturn]] void fail_verify(std::uint32_t address, unsigned wanted, unsigned found)
{
    char text[200];
    std::snprintf(text, sizeof text,
                  "the flash does not hold what was written: at 0x%08" PRIX32
                  " 0x%02X instead of 0x%02X. Run the same command again; if it fails at the same "
                  "place, the flash is worn out",
                  address, found, wanted);
    throw FlashError(Fault::verify, text);
}

void verify(FlashTarget &target, std::uint32_t address, const std::uint8_t *bytes,
            std::uint32_t size)
{
    std::array<std::uint8_t, SECTOR_BYTES> found;
    target.read(address, found.data(), size);
    const auto [at, wanted] = std::mismatch(found.begin(), found.begin() + size, bytes);
    if (at != found.begin() + size) {
        fail_verify(address + static_cast<std::uint32_t>(at - found.begin()), *wanted, *at);
    }
}

/** All of a sector but, in the first one, the page that makes it bootable. */
void write_sector(FlashTarget &target, const Sector &sector, bool first)
{
    const std::uint32_t skip = first ? PAGE_BYTES : 0;
    const std::uint8_t *const bytes = sector.bytes.data() + skip;
    target.write(sector.address + skip, bytes, SECTOR_BYTES - skip);
    verify(target, sector.address + skip, bytes, SECTOR_BYTES - skip);
}

}  // namespace

void flash_write(FlashTarget &target, const Image &image, const Progress &progress)
{
    assert(!image.sectors.empty() && image.sectors.front().address == FLASH_START);
    const std::size_t total = 2 * image.sectors.size() + 1;
    std::size_t done = 0;
    const auto step = [&] { progress(++done, total); };
    for (const Sector &sector : image.sectors) {
        target.erase(sector.address, SECTOR_BYTES);
        step();
    }
    for (const Sector &sector : image.sectors) {
        write_sector(target, sector, &sector == &image.sectors.front());
        step();
    }
    /* The checksum covers all of this page: with a wrong bit in it the box stays a bootloader. */
    const Sector &first = image.sectors.front();
    target.write(first.address, first.bytes.data(), PAGE_BYTES);
    verify(target, first.address, first.bytes.data(), PAGE_BYTES);
    step();
}

}  // namespace opms::flash
