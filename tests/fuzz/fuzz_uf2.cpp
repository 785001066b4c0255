/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a UF2 file: refused with a text, or taken as sectors that lie in the flash. */
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "firmware_check.hpp"
#include "uf2_file.hpp"

using namespace opms::flash;

namespace {

void require(bool holds)
{
    if (!holds) {
        std::abort();
    }
}

/** What an image that was taken promises to who writes it. */
void check_taken(const Image &image)
{
    require(!image.sectors.empty());
    require(image.payload_bytes <= image.sectors.size() * SECTOR_BYTES);
    std::uint64_t free_from = FLASH_START;
    for (const Sector &sector : image.sectors) {
        require(sector.address % SECTOR_BYTES == 0 && sector.address >= free_from);
        free_from = std::uint64_t{sector.address} + SECTOR_BYTES;
    }
    require(free_from <= FLASH_START + FLASH_BYTES);
}

void check_text(const FileError &error)
{
    const std::string text = error.what();
    require(!text.empty() && text.find('\n') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, std::size_t size)
{
    try {
        const Image image = uf2_parse(data, size);
        check_taken(image);
        firmware_check(image);
        require(image.sectors.front().address == FLASH_START);
    } catch (const FileError &error) {
        check_text(error);
    }
    return 0;
}
