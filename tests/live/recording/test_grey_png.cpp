/* SPDX-License-Identifier: Apache-2.0 */
/* PNG files by the recorder, read by OpenCV. */
#include <random>

#include <opencv2/imgcodecs.hpp>
#include <unity.h>

#include "grey_png.hpp"

using namespace opms_host;

void setUp(void) {}
void tearDown(void) {}

namespace {

/** Smooth with noise, as a camera sees it; or noise alone, which cannot be packed. */
std::vector<std::uint8_t> levels(std::size_t bytes, bool noise_alone, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> made(bytes);
    for (std::size_t i = 0; i < bytes; i++) {
        const std::size_t noise = random() % (noise_alone ? 256 : 5);
        made[i] = static_cast<std::uint8_t>(noise + (noise_alone ? 0 : i / 64));
    }
    return made;
}

std::size_t check(std::int32_t width_px, std::int32_t height_px, bool is_16_bit, PngEffort effort,
                  bool noise_alone)
{
    const std::size_t bytes = static_cast<std::size_t>(width_px) *
                              static_cast<std::size_t>(height_px) * (is_16_bit ? 2 : 1);
    const auto pixels = levels(bytes, noise_alone, bytes);
    const auto file = grey_png({width_px, height_px, is_16_bit, pixels.data()}, effort);
    const cv::Mat found = cv::imdecode(file, cv::IMREAD_UNCHANGED);
    TEST_ASSERT_EQUAL(is_16_bit ? CV_16UC1 : CV_8UC1, found.type());
    TEST_ASSERT_EQUAL(width_px, found.cols);
    TEST_ASSERT_EQUAL(height_px, found.rows);
    TEST_ASSERT_TRUE(found.isContinuous());
    TEST_ASSERT_EQUAL_MEMORY(pixels.data(), found.data, bytes);
    return file.size();
}

}  // namespace

static void test_every_size_and_depth_comes_back_as_it_was(void)
{
    const std::int32_t sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {63, 65}, {640, 480}, {2049, 33}};
    for (const auto &size : sizes) {
        for (const PngEffort effort : {PngEffort::pack, PngEffort::none}) {
            check(size[0], size[1], false, effort, false);
            check(size[0], size[1], true, effort, false);
            check(size[0], size[1], false, effort, true);
            check(size[0], size[1], true, effort, true);
        }
    }
}

static void test_packing_halves_a_cameras_picture(void)
{
    const std::size_t raw = 640 * 480;
    TEST_ASSERT_LESS_THAN(raw / 2, check(640, 480, false, PngEffort::pack, false));
    TEST_ASSERT_LESS_THAN(raw + raw / 50, check(640, 480, false, PngEffort::none, false));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_size_and_depth_comes_back_as_it_was);
    RUN_TEST(test_packing_halves_a_cameras_picture);
    return UNITY_END();
}
