/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures are taken one after the other, so labels of a picture whose marker is hidden come from
 * the one before it, or else from the one after it; never from one further away, where a move by a
 * whole pitch would look like none. */
#include <algorithm>

#include "calibrate_run.hpp"
#include "grid_reading_ahead.hpp"
#include "text_table.hpp"

namespace {

constexpr std::size_t NODES_LEAST = 4; /* that determine a view of a plane */

/** Carry labels over where that is certain. */
bool relabel(const GridPicture &known, GridPicture &picture)
{
    if (!known.labelled() || picture.summary.state != OPMS_GRID_UNLABELLED ||
        known.width_px != picture.width_px || known.height_px != picture.height_px) {
        return false;
    }
    uint32_t certain = 0;
    const opms_status_t status = opms_grid_relabel(
        known.nodes.data(), static_cast<uint32_t>(known.nodes.size()), picture.nodes.data(),
        static_cast<uint32_t>(picture.nodes.size()), &certain, nullptr);
    if (status != OPMS_OK || !certain) {
        return false;
    }
    picture.summary.state = OPMS_GRID_LABELLED;
    picture.labelled_from = known.image;
    return true;
}

std::string story_of(const GridPicture &picture)
{
    if (!picture.reason.empty()) {
        return picture.reason;
    }
    const std::string count = std::to_string(picture.nodes.size()) + " nodes";
    switch (picture.summary.state) {
    case OPMS_GRID_LABELLED:
        return picture.labelled_from.empty()
                   ? count
                   : count + ", marker hidden, labelled from " + picture.labelled_from;
    case OPMS_GRID_UNLABELLED:
        return count + ", marker hidden, not labelled yet";
    case OPMS_GRID_ABSENT:
        break;
    }
    return "no grid is seen";
}

bool same_nodes(const GridPicture &a, const GridPicture &b)
{
    return a.nodes.size() == b.nodes.size() && !a.nodes.empty() &&
           std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(),
                      [](const opms_node_t &m, const opms_node_t &n) {
                          return m.px[0] == n.px[0] && m.px[1] == n.px[1];
                      });
}

/** Why a picture cannot take part, by itself or beside those before it. */
std::string why_left_out(const std::vector<CalibratePicture> &pictures, std::size_t i)
{
    const GridPicture &picture = pictures[i].grid;
    if (!picture.reason.empty()) {
        return picture.reason;
    }
    if (picture.summary.state == OPMS_GRID_ABSENT) {
        return "no grid is seen";
    }
    if (!picture.labelled()) {
        return "the marker is hidden, and the pictures beside it do not label it with certainty";
    }
    if (picture.nodes.size() < NODES_LEAST) {
        return "too few nodes are seen";
    }
    for (std::size_t k = 0; k < i; k++) {
        if (pictures[k].left_out.empty() && same_nodes(pictures[k].grid, picture)) {
            return "is the same picture as " + pictures[k].grid.image;
        }
    }
    return std::string();
}

void label_backwards(std::vector<CalibratePicture> &pictures, const CalibrateTalk &talk)
{
    for (std::size_t i = pictures.size(); i-- > 1;) {
        if (relabel(pictures[i].grid, pictures[i - 1].grid)) {
            talk(pictures[i - 1].grid.image + ": labelled from " + pictures[i].grid.image);
        }
    }
}

}  // namespace

std::vector<CalibratePicture> calibrate_read(const CalibrateJob &job, const CalibrateTalk &talk)
{
    std::vector<CalibratePicture> pictures;
    GridReadingAhead reader(job.images, job.white_level);
    for (const std::string &image : job.images) {
        CalibratePicture picture;
        picture.grid = reader.next();
        if (!pictures.empty()) {
            relabel(pictures.back().grid, picture.grid);
        }
        talk(text_format("%zu/%zu ", pictures.size() + 1, job.images.size()) + image + ": " +
             story_of(picture.grid) +
             (picture.grid.colour ? " (in colour; its luma is used)" : ""));
        pictures.push_back(std::move(picture));
    }
    label_backwards(pictures, talk);
    for (std::size_t i = 0; i < pictures.size(); i++) {
        pictures[i].left_out = why_left_out(pictures, i);
        if (!pictures[i].left_out.empty() && pictures[i].grid.reason.empty()) {
            talk(pictures[i].grid.image + ": left out: " + pictures[i].left_out);
        }
    }
    return pictures;
}
