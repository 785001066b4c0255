/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of the simulated camera show the bar from where the truth says the detector is. */
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <opms/locate.h>
#include <unity.h>

#include "world_path.hpp"
#include "world_scene.hpp"

using namespace opms_host;

extern "C" void setUp(void) {}
extern "C" void tearDown(void) {}

static WorldOptions picture_options(const std::string &text)
{
    WorldOptions options =
        scene_options("frames=4,path_period=3.3,max_speed=0.6,pictures=rendered");
    TEST_ASSERT_EQUAL_STRING("", simulated_options_parse(text, options).c_str());
    return options;
}

/** Pictures of a run, each with the world's word on it. */
struct Taken {
    FramePtr frame;
    TrueFrame truth;
};

static std::vector<Taken> take(WorldScene &scene, double seconds)
{
    std::vector<Taken> taken;
    std::size_t came = 0;
    SceneListener listener;
    listener.on_source = [&](const SourceItem &item) {
        if (item.frame) {
            taken.push_back({item.frame, scene.world().true_frame(came++)});
        }
    };
    scene.listen(listener);
    scene.start_source();
    std::string error;
    TEST_ASSERT_TRUE(scene.box().arm(5, error));
    scene.run_for(0.35);
    TEST_ASSERT_TRUE(scene.box().press_start(error));
    scene.run_for(seconds);
    return taken;
}

static double mean_level(const opms_image_t &image)
{
    const auto *const pixels = static_cast<const std::uint8_t *>(image.pixels);
    const std::size_t total = static_cast<std::size_t>(image.width_px) *
                              static_cast<std::size_t>(image.height_px);
    double sum = 0;
    for (std::size_t i = 0; i < total; ++i) {
        sum += pixels[i];
    }
    return sum / static_cast<double>(total);
}

static void test_poses_of_the_pictures_are_the_true_ones(void)
{
    WorldScene scene(picture_options(""));
    const opms_camera_t camera = scene.world().camera();
    opms_locator_t *locator = nullptr;
    opms_error_t error = {};
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_locator_create(&camera, nullptr, &locator, &error),
                              error.message);
    const std::vector<Taken> taken = take(scene, 0.55);
    TEST_ASSERT_GREATER_THAN(7, taken.size());
    for (const Taken &one : taken) {
        opms_location_t location;
        TEST_ASSERT_EQUAL_MESSAGE(
            OPMS_OK,
            opms_locator_locate(locator, &one.frame->image, nullptr, nullptr, &location, &error),
            error.message);
        TEST_ASSERT_EQUAL(OPMS_BAR_LOCATED, location.state);
        const TruePose truth = scene.world().true_pose(one.truth.picture);
        double miss = 0;
        for (int i = 0; i < 3; ++i) {
            miss += std::pow(
                location.ground_detector.transform.t_m[i] - truth.ground_detector.t[i], 2);
        }
        TEST_ASSERT_TRUE(std::sqrt(miss) < 0.0004);
    }
    opms_locator_destroy(locator);
}

static void test_pictures_along_the_run_repeat_after_their_number(void)
{
    WorldScene scene(picture_options(""));
    const std::vector<Taken> taken = take(scene, 0.95);
    std::uint32_t first = 0;
    for (const Taken &one : taken) {
        const auto runs = scene.world().true_runs();
        first = runs.at(0).first_run_number;
        const bool is_run = one.truth.trigger_number >= first;
        TEST_ASSERT_EQUAL(is_run ? (one.truth.trigger_number - first) % 4 : 0, one.truth.picture);
    }
    TEST_ASSERT_EQUAL(4, first);
}

static void test_levels_follow_exposure_gain_and_light(void)
{
    WorldScene scene(picture_options("frames=1,noise=0,exposure_delay=0,light=0.15:-1"));
    std::string error;
    const std::vector<Taken> taken = take(scene, 0.42);
    TEST_ASSERT_TRUE(taken.size() >= 7);
    const double bright = mean_level(taken[3].frame->image);
    const double dim = mean_level(taken[6].frame->image);
    TEST_ASSERT_EQUAL_DOUBLE(1, taken[3].truth.light);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, taken[6].truth.light);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.5, dim / bright);

    WorldScene other(picture_options("frames=1,noise=0,exposure_us=500,gain_db=0"));
    const std::vector<Taken> as_usual = take(other, 0.02);
    TEST_ASSERT_TRUE(other.source().set_exposure(1000, 0, error));
    WorldScene longer(picture_options("frames=1,noise=0,exposure_delay=0"));
    TEST_ASSERT_TRUE(longer.source().set_exposure(500, 6.0206, error));
    const std::vector<Taken> amplified = take(longer, 0.02);
    TEST_ASSERT_DOUBLE_WITHIN(1, mean_level(as_usual[0].frame->image),
                              mean_level(amplified[0].frame->image));
}

static void test_a_hidden_bar_is_not_there(void)
{
    WorldScene scene(picture_options("frames=1,hidden=0.15+1"));
    const opms_camera_t camera = scene.world().camera();
    opms_locator_t *locator = nullptr;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_create(&camera, nullptr, &locator, nullptr));
    for (const Taken &one : take(scene, 0.45)) {
        opms_location_t location;
        TEST_ASSERT_EQUAL(OPMS_OK, opms_locator_locate(locator, &one.frame->image, nullptr,
                                                       nullptr, &location, nullptr));
        TEST_ASSERT_EQUAL(one.truth.is_hidden, location.state != OPMS_BAR_LOCATED);
    }
    opms_locator_destroy(locator);
}

static void test_the_path_is_smooth_periodic_and_no_faster_than_asked(void)
{
    const DetectorPath path(10, 1);
    constexpr double H = 1e-5;
    double fastest = 0;
    for (double t = 0.01; t < 10; t += 0.05) {
        const PathPoint before = path.at(t - H), now = path.at(t), after = path.at(t + H);
        for (int i = 0; i < 3; ++i) {
            const double rate =
                (after.ground_detector.t[i] - before.ground_detector.t[i]) / (2 * H);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, rate, now.velocity_m_s[i]);
        }
        // R' = [w]x R, so the skew part of R' R^T is w.
        const cv::Matx33d turn =
            (after.ground_detector.R - before.ground_detector.R) * now.ground_detector.R.t();
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, turn(2, 1) / (2 * H), now.rotation_rad_s[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, turn(0, 2) / (2 * H), now.rotation_rad_s[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, turn(1, 0) / (2 * H), now.rotation_rad_s[2]);
        fastest = std::max(fastest, cv::norm(now.velocity_m_s));
        const PathPoint again = path.at(t + 10);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, now.ground_detector.t[1], again.ground_detector.t[1]);
    }
    TEST_ASSERT_TRUE(fastest > 0.7 && fastest <= 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, cv::norm(path.at(0).velocity_m_s));
}

/** All pixels that a world of this text shows in its run. */
static std::vector<std::uint8_t> pixels_of(const std::string &text)
{
    WorldScene scene(picture_options("frames=2," + text));
    std::vector<std::uint8_t> pixels;
    for (const Taken &one : take(scene, 0.15)) {
        const auto *const from = static_cast<const std::uint8_t *>(one.frame->image.pixels);
        const std::ptrdiff_t size = one.frame->image.stride_bytes * one.frame->image.height_px;
        pixels.insert(pixels.end(), from, from + size);
    }
    return pixels;
}

static void test_kept_pictures_are_the_same_and_those_of_another_renderer_are_not_used(void)
{
    const std::string folder = "test_simulated_cache";
    std::filesystem::remove_all(folder);
    const std::vector<std::uint8_t> fresh = pixels_of(""), first = pixels_of("cache=" + folder);
    std::vector<std::filesystem::path> kept;
    for (const auto &entry : std::filesystem::directory_iterator(folder)) {
        kept.push_back(entry.path());
    }
    TEST_ASSERT_EQUAL(2, kept.size());
    TEST_ASSERT_TRUE(fresh == first);
    TEST_ASSERT_TRUE(fresh == pixels_of("cache=" + folder));
    for (const auto &path : kept) {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(100000);
        file.write("another renderer", 16);
    }
    TEST_ASSERT_TRUE(fresh == pixels_of("cache=" + folder));
    std::filesystem::resize_file(kept[0], 1000);
    TEST_ASSERT_TRUE(fresh == pixels_of("cache=" + folder));
    std::filesystem::remove_all(folder);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_poses_of_the_pictures_are_the_true_ones);
    RUN_TEST(test_pictures_along_the_run_repeat_after_their_number);
    RUN_TEST(test_levels_follow_exposure_gain_and_light);
    RUN_TEST(test_a_hidden_bar_is_not_there);
    RUN_TEST(test_the_path_is_smooth_periodic_and_no_faster_than_asked);
    RUN_TEST(test_kept_pictures_are_the_same_and_those_of_another_renderer_are_not_used);
    return UNITY_END();
}
