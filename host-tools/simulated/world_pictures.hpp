/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The pictures that the simulated camera takes: light rendered beforehand, exposed when it is asked
 * for. */
#ifndef OPMS_SIMULATED_WORLD_PICTURES_HPP
#define OPMS_SIMULATED_WORLD_PICTURES_HPP

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "picture_cache.hpp"
#include "simulate/simulate.hpp"
#include "world_options.hpp"
#include "world_path.hpp"

namespace opms_host {

/** What a picture is taken with. */
struct PictureExposure {
    std::uint32_t index = 0;  /**< along the path */
    bool is_hidden = false;   /**< the bar is covered */
    bool is_damaged = false;  /**< the lower part did not come */
    double factor = 1;        /**< of the light, against that of the look */
    double noise = 3;         /**< standard deviation in grey levels */
    std::uint64_t seed = 0;
};

/** Any thread, any time. */
class WorldPictures {
public:
    /** Renders all of them (PictureMode::rendered) or begins to.
     * Throws std::runtime_error where the camera's file does not read. */
    WorldPictures(const WorldOptions &options, double pulse_period_s);
    ~WorldPictures();

    int width_px() const { return scene_.camera.width; }
    int height_px() const { return scene_.camera.height; }
    const opms::simulate::Camera &camera() const { return scene_.camera; }
    const DetectorPath &path() const { return path_; }
    /** Where the detector is at the middle of picture @p index. */
    PathPoint point(std::uint32_t index) const;
    /** ... and its camera in the bar's frame. */
    opms::simulate::Pose bar_camera(std::uint32_t index) const;
    std::uint32_t count() const { return static_cast<std::uint32_t>(light_.size()); }
    /** Fill @p pixels, width x height of 8 bit. */
    void expose(const PictureExposure &exposure, std::uint8_t *pixels);

private:
    /** A picture's light on 16 bit, 256 a grey level. */
    struct Light {
        std::once_flag once;
        std::vector<std::uint16_t> pixels;
    };

    void render_all();
    const std::vector<std::uint16_t> &light(std::uint32_t index);
    std::vector<std::uint16_t> render(std::uint32_t index, bool is_hidden) const;
    void make_noise(std::uint64_t seed);
    std::string description(const WorldOptions &options) const;
    void check_cache() const;

    opms::simulate::Scene scene_; /**< all but where the camera is */
    const PictureMode mode_;
    const double pulse_period_s_, shutter_s_;
    const DetectorPath path_;
    std::vector<Light> light_;
    std::unique_ptr<PictureCache> cache_;
    Light hidden_;
    std::vector<std::int16_t> noise_; /**< of standard deviation 256 */
    std::atomic<std::uint32_t> next_{0};
    std::vector<std::thread> threads_;
};

}  // namespace opms_host
#endif
