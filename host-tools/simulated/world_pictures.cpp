/* SPDX-License-Identifier: Apache-2.0 */
#include "world_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "world_random.hpp"

namespace opms_host {

namespace sim = opms::simulate;

namespace {

constexpr std::size_t NOISE_COUNT = 1U << 16U;
constexpr int STEPS_MAX = 24;
constexpr double FACTOR_MAX = 100; /* keeps the sums of expose() within 31 bit */

/** As many instants as make half a pixel each of the blur at the bar. */
int steps_of_blur(const sim::Scene &scene, double shutter_s)
{
    const double distance_m = std::max(0.1, scene.ground_camera.t[2]);
    const double speed = cv::norm(scene.motion.velocity_m_s) +
                         distance_m * cv::norm(scene.motion.rotation_rad_s);
    const double blur_px = speed * shutter_s * scene.camera.fx / distance_m;
    return std::clamp(static_cast<int>(std::ceil(2 * blur_px)), 1, STEPS_MAX);
}

}  // namespace

WorldPictures::WorldPictures(const WorldOptions &options, double pulse_period_s)
    : mode_(options.pictures), pulse_period_s_(pulse_period_s),
      shutter_s_(options.exposure_us * 1e-6),
      path_(pulse_period_s * options.frames, options.max_speed_m_s), light_(options.frames)
{
    if (!options.camera_file.empty()) {
        scene_.camera = sim::read_camera(options.camera_file);
    }
    scene_.pattern = sim::make_pattern(options.bar);
    scene_.tilt_rad = options.bar_tilt_deg * sim::RAD;
    scene_.look.white = options.white;
    scene_.look.black = options.black;
    scene_.look.noise_read = 0;
    scene_.seed = options.seed;
    make_noise(options.seed);
    if (mode_ == PictureMode::blank) {
        return;
    }
    const auto pixels =
        static_cast<std::size_t>(width_px()) * static_cast<std::size_t>(height_px());
    cache_ = std::make_unique<PictureCache>(options.cache_folder, description(options), pixels);
    check_cache();
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 16U);
    for (unsigned i = 0; i < std::min<unsigned>(threads, options.frames); ++i) {
        threads_.emplace_back([this] { render_all(); });
    }
    if (mode_ == PictureMode::rendered) {
        for (std::thread &thread : threads_) {
            thread.join();
        }
        threads_.clear();
    }
}

WorldPictures::~WorldPictures()
{
    next_ = count();
    for (std::thread &thread : threads_) {
        thread.join();
    }
}

/** All that the light depends on. */
std::string WorldPictures::description(const WorldOptions &options) const
{
    std::ostringstream text;
    text.precision(17);
    const sim::Camera &c = scene_.camera;
    const sim::Pose &mounting = c.detector_camera;
    for (const double value : {c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, options.white,
                               options.black, options.bar_tilt_deg, options.exposure_us,
                               options.max_speed_m_s, pulse_period_s_}) {
        text << value << ' ';
    }
    for (const double value : mounting.R.val) {
        text << value << ' ';
    }
    text << mounting.t << ' ' << c.width << ' ' << c.height << ' ' << options.bar << ' '
         << options.seed << ' ' << options.frames;
    return text.str();
}

/** One picture is rendered to see whether those on the disk are of this very renderer. */
void WorldPictures::check_cache() const
{
    const std::uint32_t probe = count() / 2;
    std::vector<std::uint16_t> kept;
    if (cache_->read(probe, kept) && kept != render(probe, false)) {
        cache_->forget(count());
    }
}

void WorldPictures::make_noise(std::uint64_t seed)
{
    WorldRandom random(seed, Chance::picture);
    noise_.resize(NOISE_COUNT + static_cast<std::size_t>(scene_.camera.width));
    for (std::int16_t &value : noise_) {
        value = static_cast<std::int16_t>(std::lround(256 * random.normal()));
    }
}

void WorldPictures::render_all()
{
    for (std::uint32_t index = next_++; index < count(); index = next_++) {
        light(index);
    }
}

const std::vector<std::uint16_t> &WorldPictures::light(std::uint32_t index)
{
    Light &light = light_[index];
    std::call_once(light.once, [&] {
        if (!cache_->read(index, light.pixels)) {
            light.pixels = render(index, false);
            cache_->write(index, light.pixels);
        }
    });
    return light.pixels;
}

PathPoint WorldPictures::point(std::uint32_t index) const
{
    return path_.at(index * pulse_period_s_);
}

sim::Pose WorldPictures::bar_camera(std::uint32_t index) const
{
    sim::Scene scene = scene_;
    scene.ground_camera = point(index).ground_detector * scene_.camera.detector_camera;
    return sim::bar_camera(scene);
}

std::vector<std::uint16_t> WorldPictures::render(std::uint32_t index, bool is_hidden) const
{
    const PathPoint now = point(index);
    sim::Scene scene = scene_;
    scene.ground_camera = now.ground_detector * scene.camera.detector_camera;
    scene.motion.velocity_m_s = now.velocity_m_s;
    scene.motion.rotation_rad_s = now.rotation_rad_s;
    scene.motion.shutter_s = shutter_s_;
    scene.motion.steps = steps_of_blur(scene, shutter_s_);
    if (is_hidden) {
        scene.pattern = sim::Pattern();
        scene.motion.steps = 1;
    }
    const cv::Mat levels = sim::render_light(scene);
    std::vector<std::uint16_t> pixels;
    pixels.reserve(levels.total());
    for (int y = 0; y < levels.rows; ++y) {
        const float *const row = levels.ptr<float>(y);
        for (int x = 0; x < levels.cols; ++x) {
            pixels.push_back(
                static_cast<std::uint16_t>(std::clamp(std::lround(row[x] * 256), 0L, 65535L)));
        }
    }
    return pixels;
}

void WorldPictures::expose(const PictureExposure &exposure, std::uint8_t *pixels)
{
    const auto width = static_cast<std::size_t>(scene_.camera.width);
    const auto height = static_cast<std::size_t>(scene_.camera.height);
    if (mode_ == PictureMode::blank) {
        std::fill_n(pixels, width * height, std::uint8_t{128});
        return;
    }
    if (exposure.is_hidden) {
        std::call_once(hidden_.once, [&] { hidden_.pixels = render(0, true); });
    }
    const std::uint16_t *from =
        (exposure.is_hidden ? hidden_.pixels : light(exposure.index)).data();
    // Sums in sixteenths of a grey level.
    const auto gain =
        static_cast<std::int32_t>(std::lround(std::clamp(exposure.factor, 0.0, FACTOR_MAX) * 256));
    const auto sigma = static_cast<std::int32_t>(std::lround(exposure.noise * 16));
    const std::size_t rows = exposure.is_damaged ? height / 2 : height;
    WorldRandom random(exposure.seed, Chance::picture);
    for (std::size_t y = 0; y < rows; ++y, from += width, pixels += width) {
        const std::int16_t *const noise = noise_.data() + random.bits() % NOISE_COUNT;
        for (std::size_t x = 0; x < width; ++x) {
            const std::int32_t level = ((from[x] * gain) >> 12) + ((noise[x] * sigma) >> 8);
            pixels[x] = static_cast<std::uint8_t>(std::clamp((level + 8) >> 4, 0, 255));
        }
    }
    std::fill_n(pixels, (height - rows) * width, std::uint8_t{0});
}

}  // namespace opms_host
