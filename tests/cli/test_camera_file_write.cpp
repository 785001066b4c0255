/* SPDX-License-Identifier: Apache-2.0 */
/* What camera_file_write() writes is what camera_file_read() reads, to the last bit. */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include "camera_file.hpp"
#include "camera_file_write.hpp"

namespace {

namespace fs = std::filesystem;
using opms_host::CameraFile;

int failures = 0;

void expect(bool good, const char *what, const std::string &detail = "")
{
    if (!good) {
        std::fprintf(stderr, "FAILED: %s %s\n", what, detail.c_str());
        failures++;
    }
}

void fill_covariance(std::mt19937_64 &random, int n, double *covariance)
{
    std::normal_distribution<double> normal;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            const double value = 1e-3 * normal(random);
            covariance[i * n + j] = covariance[j * n + i] = value;
        }
        covariance[i * n + i] = 1.0 + std::fabs(normal(random));
    }
}

/** A camera whose numbers have no short decimal form. */
CameraFile random_camera(std::mt19937_64 &random)
{
    std::uniform_real_distribution<double> even(-1.0, 1.0);
    CameraFile file;
    opms_lens_t &lens = file.camera.lens;
    lens.width_px = 1024;
    lens.height_px = 768;
    lens.fx_px = 585 + even(random);
    lens.fy_px = 585 + even(random);
    lens.cx_px = 511 + even(random);
    lens.cy_px = 383 + even(random);
    lens.k1 = 0.01 * even(random);
    lens.k2 = 1e-7 * even(random);
    lens.p1 = -0.0;
    lens.p2 = std::numeric_limits<double>::denorm_min();
    const double angle = 3 * even(random), c = std::cos(angle), s = std::sin(angle);
    const double R[9] = {c, 0, s, 0, 1, 0, -s, 0, c};
    std::copy(R, R + 9, file.camera.detector_camera.R);
    for (double &t : file.camera.detector_camera.t_m) {
        t = even(random) / 3;
    }
    fill_covariance(random, 8, file.camera.covariance_intrinsics);
    fill_covariance(random, 6, file.camera.covariance_detector_camera);
    for (double &shared : file.camera.covariance_detector_camera_intrinsics) {
        shared = 1e-3 * even(random);
    }
    file.camera.has_covariance_detector_camera_intrinsics = 1;
    file.camera.has_covariance_intrinsics = 1;
    file.camera.has_detector_camera = 1;
    file.camera.has_covariance_detector_camera = 1;
    file.name = "cam\xc3\xa9ra \"one\"\\\t#: [";
    file.grid = "a0-25";
    file.footprint = opms_host::Footprint{0.35, even(random), even(random)};
    file.residual_rms_px = std::fabs(even(random));
    file.date = "2026-01-31T23:59:59Z";
    return file;
}

/** Bit by bit: -0.0 is not 0.0. */
bool same_bits(const void *a, const void *b, std::size_t size)
{
    return std::memcmp(a, b, size) == 0;
}

void check_same(const CameraFile &a, const CameraFile &b)
{
    const opms_camera_t &m = a.camera, &n = b.camera;
    expect(same_bits(&m.lens, &n.lens, sizeof m.lens), "the lens is the same");
    expect(same_bits(&m.detector_camera, &n.detector_camera, sizeof m.detector_camera),
           "the mounting is the same");
    expect(same_bits(m.covariance_intrinsics, n.covariance_intrinsics,
                     sizeof m.covariance_intrinsics), "the lens's covariance is the same");
    expect(same_bits(m.covariance_detector_camera, n.covariance_detector_camera,
                     sizeof m.covariance_detector_camera), "the mounting's covariance is the same");
    expect(same_bits(m.covariance_detector_camera_intrinsics,
                     n.covariance_detector_camera_intrinsics,
                     sizeof m.covariance_detector_camera_intrinsics),
           "what mounting and lens share is the same");
    expect(n.has_covariance_intrinsics && n.has_detector_camera &&
               n.has_covariance_detector_camera && n.has_covariance_detector_camera_intrinsics,
           "all parts are there");
    expect(a.name == b.name && a.grid == b.grid && a.date == b.date, "the texts are the same");
    expect(b.footprint && same_bits(&*a.footprint, &*b.footprint, sizeof *a.footprint),
           "the footprint is the same");
    expect(a.residual_rms_px == b.residual_rms_px, "the residual is the same");
    expect(b.notes.empty(), "nothing is unknown");
}

std::string bytes_of(const fs::path &path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}

void what_is_written_is_read_to_the_last_bit(const fs::path &folder)
{
    std::mt19937_64 random(20261);
    const std::string path = (folder / "camera.yaml").string();
    for (int i = 0; i < 50; i++) {
        const CameraFile file = random_camera(random);
        CameraFile again;
        std::string error;
        expect(opms_host::camera_file_write(path, file, error), "it is written", error);
        expect(opms_host::camera_file_read(path, again, error), "it is read", error);
        check_same(file, again);
    }
}

void a_camera_that_cannot_be_read_again_leaves_the_old_file(const fs::path &folder)
{
    std::mt19937_64 random(7);
    const std::string path = (folder / "camera.yaml").string();
    const std::string before = bytes_of(path);
    CameraFile file = random_camera(random);
    file.camera.detector_camera.R[0] = std::numeric_limits<double>::quiet_NaN();
    std::string error;
    expect(!opms_host::camera_file_write(path, file, error), "a NaN is refused");
    expect(error.find(path) == 0 && error.find("R_detector_camera") != std::string::npos,
           "the error names file and field", error);
    expect(!before.empty() && bytes_of(path) == before, "the old file is as it was");
}

void write_text(const fs::path &path, const std::string &text)
{
    std::ofstream(path, std::ios::binary) << text;
}

constexpr const char *COMMENTED = R"(# seen at the top
# twice
image_width: 1024   # of the picture
image_height: 768
vendor: {serial: "a # b", n: [1, 2]}  # by the maker
# above the matrix
camera_matrix:
  rows: 3
  cols: 3
  # within it
  data: [585.0, 0.0, 517.3, 0.0, 585.0, 379.6, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}
opms:
  # where it sits
  t_detector_camera_m: [-0.1, 0.0, 0.4]
  R_detector_camera: [0, 1, 0, 1, 0, 0, 0, 0, -1]
  shelf: 7   # in the store
# the end
)";

/** How often a text is in another. */
std::size_t count_of(const std::string &text, const std::string &what)
{
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
        count++;
    }
    return count;
}

void comments_and_unknown_keys_survive_any_number_of_rewrites(const fs::path &folder)
{
    std::mt19937_64 random(9);
    const std::string path = (folder / "commented.yaml").string();
    write_text(path, COMMENTED);
    std::string first;
    for (int i = 0; i < 3; i++) {
        std::string error;
        expect(opms_host::camera_file_write(path, random_camera(random), error), "rewritten",
               error);
        const std::string text = bytes_of(path);
        for (const char *line :
             {"# seen at the top\n# twice\n# of the picture\nimage_width: 1024\n",
              "# by the maker\nvendor: {serial: \"a # b\", n: [1, 2]}\n",
              "# above the matrix\n# within it\ncamera_matrix:\n",
              "  # where it sits\n  t_detector_camera_m: [", "  # in the store\n  shelf: 7\n"}) {
            expect(count_of(text, line) == 1, "a comment stays with its key", line + text);
        }
        expect(text.size() > 10 && text.rfind("# the end\n") == text.size() - 10,
               "the last comment stays the last", text);
        expect(count_of(text, "#") == 11, "no comment is doubled", text);
    }
    fs::remove(path);
}

void a_link_stays_a_link_and_nothing_is_left_beside(const fs::path &folder)
{
    std::mt19937_64 random(8);
    const fs::path link = folder / "link.yaml";
    fs::create_symlink("camera.yaml", link);
    const CameraFile file = random_camera(random);
    CameraFile again;
    std::string error;
    expect(opms_host::camera_file_write(link.string(), file, error), "through a link", error);
    expect(fs::is_symlink(link), "the link is still one");
    expect(opms_host::camera_file_read((folder / "camera.yaml").string(), again, error),
           "the file it leads to is read", error);
    check_same(file, again);
    expect(std::distance(fs::directory_iterator(folder), {}) == 2, "no part is left beside it");
}

}  // namespace

int main()
{
    const fs::path folder =
        fs::temp_directory_path() / ("opms-camera-" + std::to_string(std::random_device{}()));
    fs::create_directory(folder);
    what_is_written_is_read_to_the_last_bit(folder);
    a_camera_that_cannot_be_read_again_leaves_the_old_file(folder);
    comments_and_unknown_keys_survive_any_number_of_rewrites(folder);
    a_link_stays_a_link_and_nothing_is_left_beside(folder);
    fs::remove_all(folder);
    return failures == 0 ? 0 : 1;
}
