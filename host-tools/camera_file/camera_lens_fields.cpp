/* SPDX-License-Identifier: Apache-2.0 */
/* The lens, as all formats have it: a camera matrix and OpenCV's list of coefficients. */
#include <algorithm>

#include "camera_parts.hpp"

namespace opms_host {
namespace {

constexpr const char *COEFFICIENTS[] = {"k1", "k2", "p1", "p2", "k3",    "k4",   "k5",
                                        "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"};
constexpr std::size_t HELD = 4;
/* As OpenCV's models have them; ROS's plumb_bob is the second. */
constexpr std::size_t LENGTHS[] = {4, 5, 8, 12, 14};

}  // namespace

void camera_read_matrix(const Field &data, const std::vector<double> &k, opms_lens_t &lens)
{
    if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
        data.fail("must read [fx, 0, cx, 0, fy, cy, 0, 0, 1]; skew is not supported");
    }
    if (k[0] <= 0 || k[4] <= 0) {
        data.fail("has a focal length that is not positive");
    }
    lens.fx_px = k[0];
    lens.cx_px = k[2];
    lens.fy_px = k[4];
    lens.cy_px = k[5];
}

void camera_read_distortion(const Field &data, const std::vector<double> &d, opms_lens_t &lens)
{
    if (std::find(std::begin(LENGTHS), std::end(LENGTHS), d.size()) == std::end(LENGTHS)) {
        data.fail("has " + std::to_string(d.size()) +
                  " numbers; known are k1 k2 p1 p2, k3, k4 to k6, s1 to s4, tau_x tau_y: 4, 5, 8, "
                  "12 or 14 of them");
    }
    for (std::size_t i = HELD; i < d.size(); i++) {
        if (d[i] != 0) {
            const std::string name = COEFFICIENTS[i];
            data.fail("has " + name + " other than 0, which is not supported; calibrate again "
                      "with " + name + " fixed at 0");
        }
    }
    lens.k1 = d[0];
    lens.k2 = d[1];
    lens.p1 = d[2];
    lens.p2 = d[3];
}

}  // namespace opms_host
