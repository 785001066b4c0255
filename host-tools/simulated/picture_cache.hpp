/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Rendered light kept on the disk, because a minute of pictures takes a minute to render. */
#ifndef OPMS_SIMULATED_PICTURE_CACHE_HPP
#define OPMS_SIMULATED_PICTURE_CACHE_HPP

#include <cstdint>
#include <string>
#include <vector>

namespace opms_host {

/** A file for each picture; any thread, different indices. A file that cannot be read or written is
 * a picture that is rendered, no failure. */
class PictureCache {
public:
    /** @param folder  Made if missing; empty: nothing is kept.
     *  @param what  All that the pictures depend on, as text.
     *  @param pixels  Of a picture. */
    PictureCache(const std::string &folder, const std::string &what, std::size_t pixels);

    bool is_on() const { return !stem_.empty(); }
    bool read(std::uint32_t index, std::vector<std::uint16_t> &light) const;
    void write(std::uint32_t index, const std::vector<std::uint16_t> &light) const;
    /** Pictures turned out to be of another renderer: use none of them. */
    void forget(std::uint32_t count) const;

private:
    std::string path(std::uint32_t index) const;

    std::string stem_;
    std::size_t bytes_;
};

}  // namespace opms_host
#endif
