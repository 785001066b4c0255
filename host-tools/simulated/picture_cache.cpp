/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_cache.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace opms_host {

namespace {

/** FNV-1a of 64 bit. */
std::uint64_t hash_of(const std::string &text)
{
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char letter : text) {
        hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x100000001b3U;
    }
    return hash;
}

}  // namespace

PictureCache::PictureCache(const std::string &folder, const std::string &what, std::size_t pixels)
    : bytes_(pixels * sizeof(std::uint16_t))
{
    if (!folder.empty()) {
        std::error_code ignored;
        std::filesystem::create_directories(folder, ignored);
        char name[32];
        std::snprintf(name, sizeof name, "%016llx",
                      static_cast<unsigned long long>(hash_of(what)));
        stem_ = folder + "/light-" + name + "-";
    }
}

std::string PictureCache::path(std::uint32_t index) const
{
    return stem_ + std::to_string(index) + ".u16";
}

bool PictureCache::read(std::uint32_t index, std::vector<std::uint16_t> &light) const
{
    if (!is_on()) {
        return false;
    }
    std::ifstream file(path(index), std::ios::binary);
    light.resize(bytes_ / sizeof(std::uint16_t));
    file.read(reinterpret_cast<char *>(light.data()), static_cast<std::streamsize>(bytes_));
    return file && file.peek() == std::ifstream::traits_type::eof();
}

/** By another name first, so that a file is whole or not there. */
void PictureCache::write(std::uint32_t index, const std::vector<std::uint16_t> &light) const
{
    if (!is_on()) {
        return;
    }
    const std::string name = path(index), unfinished = name + ".new";
    std::ofstream file(unfinished, std::ios::binary);
    file.write(reinterpret_cast<const char *>(light.data()), static_cast<std::streamsize>(bytes_));
    file.close();
    std::error_code ignored;
    if (file) {
        std::filesystem::rename(unfinished, name, ignored);
    } else {
        std::filesystem::remove(unfinished, ignored);
    }
}

void PictureCache::forget(std::uint32_t count) const
{
    std::error_code ignored;
    for (std::uint32_t index = 0; is_on() && index < count; ++index) {
        std::filesystem::remove(path(index), ignored);
    }
}

}  // namespace opms_host
