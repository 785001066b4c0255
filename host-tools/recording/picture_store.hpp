/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Stores pictures without loss of a grey level, durably, behind the back of who hands them over.
 *
 * Two threads in a row: one packs (PNG) and writes aside, one syncs and renames. So the processor
 * works while the disk does, and a picture that has its name is whole. Where a quarter of the queue
 * waits, pictures are no longer packed, only wrapped: room on the disk is given for time. */
#ifndef OPMS_RECORDING_PICTURE_STORE_HPP
#define OPMS_RECORDING_PICTURE_STORE_HPP

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "frame_source.hpp"
#include "grey_png.hpp"
#include "scan_files.hpp"

namespace opms_host {

/** A picture that is on the disk, under its name. */
struct StoredPicture {
    std::uint64_t number = 0; /**< of its frame */
    std::string path;         /**< within the scan's folder */
    std::uint64_t bytes = 0;
    std::uint32_t crc32 = 0;
};

/** "pictures/012/012345.png" */
std::string picture_path(std::uint64_t number);

class PictureStore {
public:
    struct Calls {
        std::function<void(const StoredPicture &)> stored;
        /** Something is wrong with the disk; no more will be stored. Called once at most. */
        std::function<void(const FileTrouble &)> trouble;
    };
    /** @param folder  Of the scan; its folder "pictures" is there. */
    PictureStore(const std::string &folder, std::uint32_t queue, Calls calls);
    ~PictureStore();

    /** Copies the picture, so that its buffer goes back to the camera at once.
     * @return False where there is no room, or nothing is stored any more. */
    bool add(std::uint64_t number, const opms_image_t &image);
    /** Store what waits, then end. */
    void finish();
    /** Store nothing more. Does not wait. */
    void abandon();
    std::uint64_t waiting() const;

private:
    struct Raw {
        std::uint64_t number = 0;
        std::int32_t width_px = 0, height_px = 0;
        bool is_16_bit = false;
        std::vector<std::uint8_t> pixels;
    };
    void pack_all();
    void sync_all();
    bool pack(const Raw &raw, PngEffort effort, StoredPicture &picture, FileTrouble &trouble);
    bool make_durable(const std::vector<StoredPicture> &batch, FileTrouble &trouble);
    bool make_shard(std::uint64_t number, FileTrouble &trouble);
    void give_up(const FileTrouble &trouble);

    const std::string folder_;
    const std::size_t most_;
    const Calls calls_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Raw> raw_;
    std::vector<StoredPicture> packed_;
    std::vector<std::vector<std::uint8_t>> spare_; /**< memory of pictures that are packed */
    std::size_t in_hand_ = 0;  /**< not in raw_: on the way in, or out of it and not yet stored */
    std::size_t copying_ = 0;  /**< of them, those on the way in */
    bool closing_ = false, packer_done_ = false, abandoned_ = false;
    std::uint64_t shard_ = UINT64_MAX; /**< the newest one made */
    std::thread packer_, syncer_;
};

}  // namespace opms_host
#endif
