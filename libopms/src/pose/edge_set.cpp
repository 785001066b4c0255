// SPDX-License-Identifier: Apache-2.0
#include "pose/edge_set.h"

#include <algorithm>

#include "lens/lens_wide.h"

namespace opms::pose
{

namespace
{

constexpr uint32_t SAMPLE_SIZE = 72;
constexpr uint32_t SAMPLE_FROM = 240; // fewer edges than this are all looked at
constexpr double UNREACHED = 1e9;     // residual in sigmas of an edge that no ray reaches
constexpr double NEAR_PX = 0.5;       // as near as this, a ray may stand for that of the pixel

using Four = wide_double_t;

/* Four edges as the caller has them, one a lane. */
struct FourEdges {
    double X[WIDE_DOUBLES], Y[WIDE_DOUBLES];
    double u[WIDE_DOUBLES], v[WIDE_DOUBLES], nu[WIDE_DOUBLES], nv[WIDE_DOUBLES];
    double sigma_px[WIDE_DOUBLES], gain[WIDE_DOUBLES];
};

/* What fills up the last lanes is the last edge once more. */
WIDE_INLINE void gather(const EdgeSet &set, const opms_edge_t *edges, uint32_t from, uint32_t to,
                        FourEdges &four)
{
    for (uint32_t lane = 0; lane < WIDE_DOUBLES; ++lane) {
        const opms_edge_t &edge = edges[set.order[std::min(from + lane, to - 1)]];
        four.X[lane] = edge.bar_m[0];
        four.Y[lane] = edge.bar_m[1];
        four.u[lane] = edge.px[0];
        four.v[lane] = edge.px[1];
        four.nu[lane] = edge.normal[0];
        four.nv[lane] = edge.normal[1];
        four.sigma_px[lane] = edge.sigma_px;
        four.gain[lane] = edge.shift_gain;
    }
}

/* The lines of four edges, their lens taken at the rays (x, y). */
struct RayLines {
    Four x, y;
    Four mx, my; // m = J^T n
    Four c;      // m.x_q
    Four off;    // from the ray's pixel to q, squared
};

WIDE_INLINE void find_lines(const opms_lens_t &lens, const FourEdges &four, RayLines &lines)
{
    const Four nu = wide_double_load(four.nu), nv = wide_double_load(four.nv);
    const lens_wide_line_t line = lens_line_wide(&lens, lines.x, lines.y, nu, nv);
    const Four eu = wide_double_load(four.u) - line.u, ev = wide_double_load(four.v) - line.v;
    lines.mx = line.mx;
    lines.my = line.my;
    lines.c = line.mx * lines.x + line.my * lines.y + eu * nu + ev * nv;
    lines.off = eu * eu + ev * ev;
}

/* Rare and long: once, not in every lane of either vector unit. */
[[gnu::noinline]] bool find_ray(const opms_lens_t &lens, const FourEdges &four, unsigned lane,
                                double ray[2])
{
    return lens_unproject_fast(&lens, four.u[lane], four.v[lane], &ray[0], &ray[1]) != 0;
}

/* Half a pixel off, the bend of the lens is below 1e-4 px and need not be followed to the ray of q
 * itself; farther off it is. A lane that no ray reaches is set in the result. */
WIDE_INLINE unsigned follow_lens(const opms_lens_t &lens, const FourEdges &four, RayLines &lines)
{
    unsigned unreached = 0, moved = 0;
    for (unsigned lane = 0; lane < WIDE_DOUBLES; ++lane) {
        if (lines.off[lane] < NEAR_PX * NEAR_PX) {
            continue;
        }
        double ray[2];
        moved = 1;
        if (find_ray(lens, four, lane, ray)) {
            lines.x[lane] = ray[0];
            lines.y[lane] = ray[1];
        } else {
            unreached |= 1u << lane;
        }
    }
    if (moved) {
        find_lines(lens, four, lines);
    }
    return unreached;
}

/* Where an edge is expected: the bar's axes and origin in the camera frame. Without a guess there
 * is none, and depth 0 makes every ray one to be followed. */
struct Expected {
    Mat3 into;
    Vec3 origin;
};

WIDE_INLINE void expect_rays(const Expected &at, const FourEdges &four, RayLines &lines)
{
    const Four X = wide_double_load(four.X), Y = wide_double_load(four.Y);
    const Mat3 &m = at.into;
    const Four nearness = 1.0 / (m(2, 0) * X + m(2, 1) * Y + at.origin.z());
    lines.x = (m(0, 0) * X + m(0, 1) * Y + at.origin.x()) * nearness;
    lines.y = (m(1, 0) * X + m(1, 1) * Y + at.origin.y()) * nearness;
}

WIDE_INLINE void store_lines(const FourEdges &four, const RayLines &lines, unsigned unreached,
                             uint32_t i, EdgeSet &set)
{
    const Four information = 1.0 / wide_double_load(four.sigma_px);
    wide_double_store(set.sigma_px + i, wide_double_load(four.sigma_px));
    wide_double_store(set.X + i, wide_double_load(four.X));
    wide_double_store(set.Y + i, wide_double_load(four.Y));
    wide_double_store(set.is + i, wide_double_load(four.gain) * information);
    wide_double_store(set.mx + i, lines.mx * information);
    wide_double_store(set.my + i, lines.my * information);
    wide_double_store(set.c + i, lines.c * information);
    for (uint32_t lane = 0; lane < WIDE_DOUBLES; ++lane) {
        if (unreached >> lane & 1u) {
            set.is[i + lane] = set.mx[i + lane] = set.my[i + lane] = 0.0;
            set.c[i + lane] = UNREACHED;
        }
    }
}

WIDE_INLINE void fill_lanes(EdgeSet &set, const opms_lens_t &lens, const opms_edge_t *edges,
                            uint32_t from, uint32_t to, const Expected &at)
{
    for (uint32_t i = from; i < to; i += WIDE_DOUBLES) {
        FourEdges four;
        RayLines lines;
        gather(set, edges, i, to, four);
        expect_rays(at, four, lines);
        find_lines(lens, four, lines);
        const unsigned unreached = follow_lens(lens, four, lines);
        store_lines(four, lines, unreached, i, set);
    }
}

WIDE_EITHER(fill,
            (EdgeSet & set, const opms_lens_t &lens, const opms_edge_t *edges, uint32_t from,
             uint32_t to, const Expected &at),
            (set, lens, edges, from, to, at))

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
    Expected at = {Mat3::Zero(), Vec3::Zero()};
    if (guess) {
        at.into = guess->R.transpose();
        at.origin = -(at.into * guess->t);
    }
    fill(set, lens, edges, from, to, at);
    // Empty edges fill up the last lanes: no residual, no gradient, a bar point that is in front.
    for (uint32_t i = to; i < to + 3; ++i) {
        set.X[i] = to > 0 ? set.X[to - 1] : 0.0;
        set.Y[i] = to > 0 ? set.Y[to - 1] : 0.0;
        set.mx[i] = set.my[i] = set.c[i] = set.is[i] = 0.0;
    }
}

} // namespace opms::pose
