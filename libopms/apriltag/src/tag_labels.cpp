/* SPDX-License-Identifier: Apache-2.0 */
/* Two tags with their ids fix the homography of the whole bar, which says where every other tag
 * must be. Each pair votes; the pair that most tags agree with decides. So a wrong id, a stray tag
 * of the same family and a repeated id drop out, and a second bar shows as a rival that needs none
 * of the winner's tags. */
#include "tag_labels.h"

#include <algorithm>

#include <opms/lens.h>

namespace opms_tag {
namespace {

/** Most that a corner may be off, in sides of its tag. */
constexpr double CORNER_TOLERANCE = 0.2;

struct Candidate {
    const Sighting *tag;
    Point ray[4];
    double side; /**< mean side in rays */
};

bool to_rays(const opms_lens_t &lens, const Sighting &tag, Candidate &out)
{
    out = {&tag, {}, 0.0};
    for (int i = 0; i < 4; i++) {
        const double px[2] = {tag.corners_px[i].x, tag.corners_px[i].y};
        double ray[2];
        if (opms_lens_unproject(&lens, px, ray, nullptr, nullptr) != OPMS_OK) {
            return false;
        }
        out.ray[i] = {ray[0], ray[1]};
    }
    for (int i = 0; i < 4; i++) {
        out.side += 0.25 * length(out.ray[(i + 1) % 4] - out.ray[i]);
    }
    return true;
}

/** The plane through the outer corners of two tags, a with the smaller id. */
bool plane_of_pair(const Candidate &a, const Candidate &b, Plane &plane)
{
    const Point bar_m[4] = {tag_corner_m(a.tag->id, 0), tag_corner_m(a.tag->id, 1),
                            tag_corner_m(b.tag->id, 2), tag_corner_m(b.tag->id, 3)};
    const Point ray[4] = {a.ray[0], a.ray[1], b.ray[2], b.ray[3]};
    return plane_through(bar_m, ray, plane);
}

bool agrees(const Plane &plane, const Candidate &tag)
{
    for (int i = 0; i < 4; i++) {
        const Point expected = plane.map(tag_corner_m(tag.tag->id, i));
        if (!(length(tag.ray[i] - expected) < CORNER_TOLERANCE * tag.side)) {
            return false;
        }
    }
    return true;
}

/** Indices of the most candidates that agree with some pair of the free ones. */
std::vector<size_t> largest_agreement(const std::vector<Candidate> &all,
                                      const std::vector<bool> &taken)
{
    std::vector<size_t> best, members;
    for (size_t a = 0; a < all.size(); a++) {
        for (size_t b = a + 1; b < all.size(); b++) {
            Plane plane;
            if (taken[a] || taken[b] || all[a].tag->id == all[b].tag->id ||
                !plane_of_pair(all[a], all[b], plane) || !agrees(plane, all[a]) ||
                !agrees(plane, all[b])) {
                continue;
            }
            members.clear();
            for (size_t i = 0; i < all.size(); i++) {
                if (!taken[i] && agrees(plane, all[i])) {
                    members.push_back(i);
                }
            }
            if (members.size() > best.size()) {
                best = members;
            }
        }
    }
    return best;
}

} // namespace

opms_bar_state_t tags_of_one_bar(const opms_lens_t &lens, std::vector<Sighting> &tags)
{
    if (tags.empty()) {
        return OPMS_BAR_ABSENT;
    }
    std::sort(tags.begin(), tags.end(), [](const Sighting &a, const Sighting &b) {
        return a.id != b.id ? a.id < b.id : a.margin > b.margin;
    });
    std::vector<Candidate> candidates;
    for (const Sighting &tag : tags) {
        Candidate candidate;
        if (to_rays(lens, tag, candidate)) {
            candidates.push_back(candidate);
        }
    }
    std::vector<bool> taken(candidates.size(), false);
    const std::vector<size_t> winner = largest_agreement(candidates, taken);
    std::vector<Sighting> kept;
    for (size_t i : winner) {
        taken[i] = true;
        if (kept.empty() || kept.back().id != candidates[i].tag->id) {
            kept.push_back(*candidates[i].tag);
        }
    }
    const size_t rivals = largest_agreement(candidates, taken).size();
    if (kept.size() < 2 || 2 * rivals >= winner.size()) {
        tags.clear();
        return OPMS_BAR_AMBIGUOUS;
    }
    tags.swap(kept);
    return OPMS_BAR_LOCATED;
}

} // namespace opms_tag
