/* SPDX-License-Identifier: Apache-2.0 */
#include "picture_store.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>
#include <utility>

namespace opms_host {

namespace {

constexpr std::uint64_t SHARD_PICTURES = 1000;
constexpr std::size_t BATCH_MOST = 16; /* pictures that share one sync of their folder */

std::string shard_path(std::uint64_t number)
{
    char name[48];
    std::snprintf(name, sizeof name, "pictures/%03llu",
                  static_cast<unsigned long long>(number / SHARD_PICTURES));
    return name;
}

/** Where a picture is until it is whole. */
std::string aside(const std::string &path)
{
    return path + ".part";
}

void copy_rows(const opms_image_t &image, std::size_t row_bytes, std::vector<std::uint8_t> &pixels)
{
    const auto *row = static_cast<const std::uint8_t *>(image.pixels);
    for (std::int32_t y = 0; y < image.height_px; y++, row += image.stride_bytes) {
        std::memcpy(pixels.data() + static_cast<std::size_t>(y) * row_bytes, row, row_bytes);
    }
}

}  // namespace

std::string picture_path(std::uint64_t number)
{
    char name[32];
    std::snprintf(name, sizeof name, "/%06llu.png", static_cast<unsigned long long>(number));
    return shard_path(number) + name;
}

PictureStore::PictureStore(const std::string &folder, std::uint32_t queue, Calls calls)
    : folder_(folder), most_(queue), calls_(std::move(calls))
{
    packer_ = std::thread([this] { pack_all(); });
    syncer_ = std::thread([this] { sync_all(); });
}

PictureStore::~PictureStore()
{
    abandon();
    finish();
}

bool PictureStore::add(std::uint64_t number, const opms_image_t &image)
{
    Raw raw;
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        if (closing_ || abandoned_ || raw_.size() + in_hand_ >= most_) {
            return false;
        }
        in_hand_++; /* its place is taken; the copy is made without the lock */
        copying_++;
        if (!spare_.empty()) {
            raw.pixels = std::move(spare_.back());
            spare_.pop_back();
        }
    }
    raw.number = number;
    raw.width_px = image.width_px;
    raw.height_px = image.height_px;
    raw.is_16_bit = image.format == OPMS_PIXEL_GREY16;
    const std::size_t pixel_bytes = raw.is_16_bit ? 2 : 1;
    const std::size_t row_bytes = static_cast<std::size_t>(image.width_px) * pixel_bytes;
    raw.pixels.resize(row_bytes * static_cast<std::size_t>(image.height_px));
    copy_rows(image, row_bytes, raw.pixels);
    const std::lock_guard<std::mutex> guard(mutex_);
    in_hand_--;
    copying_--;
    raw_.push_back(std::move(raw));
    changed_.notify_all();
    return true;
}

void PictureStore::finish()
{
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        closing_ = true;
        changed_.notify_all();
    }
    if (packer_.joinable()) {
        packer_.join();
    }
    if (syncer_.joinable()) {
        syncer_.join();
    }
}

void PictureStore::abandon()
{
    const std::lock_guard<std::mutex> guard(mutex_);
    abandoned_ = true;
    changed_.notify_all();
}

std::uint64_t PictureStore::waiting() const
{
    const std::lock_guard<std::mutex> guard(mutex_);
    return raw_.size() + in_hand_;
}

void PictureStore::give_up(const FileTrouble &trouble)
{
    {
        const std::lock_guard<std::mutex> guard(mutex_);
        if (abandoned_) {
            return;
        }
        abandoned_ = true;
        changed_.notify_all();
    }
    calls_.trouble(trouble);
}

void PictureStore::pack_all()
{
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] {
            return (closing_ && copying_ == 0) || abandoned_ || !raw_.empty();
        });
        if (abandoned_ || raw_.empty()) {
            break;
        }
        Raw raw = std::move(raw_.front());
        raw_.pop_front();
        in_hand_++;
        const auto effort = raw_.size() > most_ / 4 ? PngEffort::none : PngEffort::pack;
        lock.unlock();
        StoredPicture picture;
        FileTrouble trouble;
        const bool good = pack(raw, effort, picture, trouble);
        if (!good) {
            give_up(trouble);
        }
        lock.lock();
        spare_.push_back(std::move(raw.pixels));
        if (good) {
            packed_.push_back(std::move(picture));
            changed_.notify_all();
        }
    }
    packer_done_ = true;
    changed_.notify_all();
}

void PictureStore::sync_all()
{
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return packer_done_ || abandoned_ || !packed_.empty(); });
        if (abandoned_ || packed_.empty()) {
            return;
        }
        std::vector<StoredPicture> batch(packed_.begin(),
                                         packed_.begin() + static_cast<std::ptrdiff_t>(
                                             std::min(packed_.size(), BATCH_MOST)));
        packed_.erase(packed_.begin(),
                      packed_.begin() + static_cast<std::ptrdiff_t>(batch.size()));
        lock.unlock();
        FileTrouble trouble;
        if (make_durable(batch, trouble)) {
            for (const StoredPicture &picture : batch) {
                calls_.stored(picture);
            }
        } else {
            give_up(trouble);
        }
        lock.lock();
        in_hand_ -= batch.size();
    }
}

bool PictureStore::pack(const Raw &raw, PngEffort effort, StoredPicture &picture,
                        FileTrouble &trouble)
{
    const GreyPicture grey = {raw.width_px, raw.height_px, raw.is_16_bit, raw.pixels.data()};
    const std::vector<std::uint8_t> bytes = grey_png(grey, effort);
    if (bytes.empty()) {
        trouble.number = EINVAL;
        trouble.text = "picture " + std::to_string(raw.number) + " cannot be packed";
        return false;
    }
    picture.number = raw.number;
    picture.path = picture_path(raw.number);
    picture.bytes = bytes.size();
    picture.crc32 = crc32_of(bytes.data(), bytes.size());
    const std::string path = aside(folder_ + "/" + picture.path);
    if (make_shard(raw.number, trouble) && file_write(path, bytes, trouble)) {
        return true;
    }
    std::remove(path.c_str()); /* on a full disk what it took is needed for the last rows */
    return false;
}

bool PictureStore::make_shard(std::uint64_t number, FileTrouble &trouble)
{
    const std::uint64_t shard = number / SHARD_PICTURES;
    if (shard == shard_) {
        return true;
    }
    shard_ = shard;
    return folder_make(folder_ + "/" + shard_path(number), trouble) &&
           folder_sync(folder_ + "/pictures", trouble);
}

bool PictureStore::make_durable(const std::vector<StoredPicture> &batch, FileTrouble &trouble)
{
    std::set<std::string> shards;
    for (const StoredPicture &picture : batch) {
        const std::string path = folder_ + "/" + picture.path;
        if (!file_sync(aside(path), trouble) || !file_rename(aside(path), path, trouble)) {
            return false;
        }
        shards.insert(folder_ + "/" + shard_path(picture.number));
    }
    for (const std::string &shard : shards) {
        if (!folder_sync(shard, trouble)) {
            return false;
        }
    }
    return true;
}

}  // namespace opms_host
