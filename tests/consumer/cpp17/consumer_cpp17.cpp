// SPDX-License-Identifier: Apache-2.0
// A program of someone else, in C++17: the pose of a camera from edges that it measured itself.
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

#include <opms/opms.h>

namespace
{

// Squares 10 to 22 seen square on from a height of 0.5 m, as a perfect detector would measure.
std::vector<opms_edge_t> measured_edges(const opms_lens_t &lens)
{
    std::vector<opms_edge_t> edges;
    constexpr double half = OPMS_BAR_SQUARE_M / 2;
    constexpr std::array<std::array<double, 2>, 4> outward{{{-1, 0}, {0, -1}, {1, 0}, {0, 1}}};
    for (int square = 10; square <= 22; ++square) {
        for (int side = 0; side < 4; ++side) {
            const auto &n = outward[static_cast<std::size_t>(side)];
            for (const double along : {-0.5, 0.5}) {
                opms_edge_t edge{};
                edge.square = square;
                edge.side = side;
                edge.bar_m[0] = n[0] * half + n[1] * along * half;
                edge.bar_m[1] = n[1] * half + n[0] * along * half +
                                (square - OPMS_BAR_ORIGIN) * OPMS_BAR_PITCH_M;
                // The camera looks down on the bar: x is the bar's Y, y the bar's X, z is -Z.
                const double point_m[3] = {edge.bar_m[1], edge.bar_m[0], 0.5};
                if (opms_lens_project(&lens, point_m, edge.px, nullptr, nullptr, nullptr)) {
                    std::exit(EXIT_FAILURE);
                }
                edge.normal[0] = n[1];
                edge.normal[1] = n[0];
                edge.sigma_px = 0.01;
                edge.shift_gain = 1.0;
                edges.push_back(edge);
            }
        }
    }
    return edges;
}

} // namespace

int main()
{
    opms_lens_t lens{};
    lens.width_px = 1024;
    lens.height_px = 768;
    lens.fx_px = lens.fy_px = 585;
    lens.cx_px = 511.5;
    lens.cy_px = 383.5;

    const std::vector<opms_edge_t> edges = measured_edges(lens);
    opms_error_t error;
    opms_pose_result_t result;
    if (opms_pose_solve(&lens, edges.data(), static_cast<std::uint32_t>(edges.size()), nullptr,
                        &result, &error) != OPMS_OK) {
        std::cerr << error.message << '\n';
        return EXIT_FAILURE;
    }
    if (result.state != OPMS_POSE_FOUND) {
        std::cerr << "no pose\n";
        return EXIT_FAILURE;
    }
    const double height_m = result.bar_camera.transform.t_m[2];
    std::cout << "libopms " << opms_version() << ": camera " << height_m << " m above the bar\n";
    return std::abs(height_m - 0.5) < 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}
