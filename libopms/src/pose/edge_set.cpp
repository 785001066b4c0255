// SPDX-License-Identifier: Apache-2.0
#include "pose/edge_set.h"

#include "lens/lens_fast.h"

namespace opms::pose
{

namespace
{

constexpr uint32_t SAMPLE_SIZE = 72;
constexpr uint32_t SAMPLE_FROM = 240; // fewer edges than this are all looked at
constexpr double UNREACHED = 1e9;     // residual in sigmas of an edge that no ray reaches
constexpr double NEAR_PX = 0.5;       // as near as this, a ray may stand for that of the pixel

/* The line of an edge, its lens taken at the ray (x, y). */
struct RayLine {
    double mx, my; // m = J^T n
    double c;      // m.x_q
    double off;    // from the ray's pixel to q, squared
};

RayLine line_at(const opms_lens_t &lens, const opms_edge_t &edge, double x, double y)
{
    double u, v, jac[4];
    lens_project_ray_jac(&lens, x, y, &u, &v, jac);
    const double eu = edge.px[0] - u;
    const double ev = edge.px[1] - v;
    RayLine line;
    line.mx = jac[0] * edge.normal[0] + jac[2] * edge.normal[1];
    line.my = jac[1] * edge.normal[0] + jac[3] * edge.normal[1];
    line.c = line.mx * x + line.my * y + eu * edge.normal[0] + ev * edge.normal[1];
    line.off = eu * eu + ev * ev;
    return line;
}

/* Half a pixel off, the bend of the lens is below 1e-4 px and need not be followed to the ray of q
 * itself. */
bool line_of_edge(const opms_lens_t &lens, const opms_edge_t &edge, const Vec3 *guess,
                  RayLine &line)
{
    if (guess) {
        line = line_at(lens, edge, guess->x() / guess->z(), guess->y() / guess->z());
        if (line.off < NEAR_PX * NEAR_PX) {
            return true;
        }
    }
    double x, y;
    if (!lens_unproject_fast(&lens, edge.px[0], edge.px[1], &x, &y)) {
        return false;
    }
    line = line_at(lens, edge, x, y);
    return true;
}

} // namespace

void edge_set_init(EdgeSet &set, uint32_t count)
{
    set.count = count;
    set.sample = count < SAMPLE_FROM ? count : SAMPLE_SIZE;
    bool taken[EdgeSet::CAPACITY] = {};
    uint32_t place = 0;
    if (set.sample < count) {
        // Multiples of the golden ratio are evenly spread and in step with no period of the bar.
        double at = 0.5;
        while (place < set.sample) {
            at += 0.6180339887498949;
            at -= std::floor(at);
            const uint32_t index = static_cast<uint32_t>(at * count);
            if (!taken[index]) {
                taken[index] = true;
                set.order[place++] = static_cast<uint16_t>(index);
            }
        }
    }
    for (uint32_t index = 0; index < count; ++index) {
        if (!taken[index]) {
            set.order[place++] = static_cast<uint16_t>(index);
        }
    }
}

void edge_set_fill(EdgeSet &set, const opms_lens_t &lens, const opms_edge_t *edges, uint32_t from,
                   uint32_t to, const Placement *guess)
{
    Mat3 into = Mat3::Zero();
    Vec3 origin = Vec3::Zero();
    if (guess) {
        into = guess->R.transpose();
        origin = -(into * guess->t);
    }
    for (uint32_t i = from; i < to; ++i) {
        const opms_edge_t &edge = edges[set.order[i]];
        const Vec3 seen = into.col(0) * edge.bar_m[0] + into.col(1) * edge.bar_m[1] + origin;
        RayLine line;
        const bool reached = line_of_edge(lens, edge, guess ? &seen : nullptr, line);
        const double information = 1.0 / edge.sigma_px;
        set.sigma_px[i] = edge.sigma_px;
        set.X[i] = edge.bar_m[0];
        set.Y[i] = edge.bar_m[1];
        set.is[i] = reached ? edge.shift_gain * information : 0.0;
        set.mx[i] = reached ? line.mx * information : 0.0;
        set.my[i] = reached ? line.my * information : 0.0;
        set.c[i] = reached ? line.c * information : UNREACHED;
    }
    // Empty edges fill up the last lanes: no residual, no gradient, a bar point that is in front.
    for (uint32_t i = to; i < to + 3; ++i) {
        set.X[i] = to > 0 ? set.X[to - 1] : 0.0;
        set.Y[i] = to > 0 ? set.Y[to - 1] : 0.0;
        set.mx[i] = set.my[i] = set.c[i] = set.is[i] = 0.0;
    }
}

} // namespace opms::pose
