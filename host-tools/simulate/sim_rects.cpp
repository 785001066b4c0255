/* SPDX-License-Identifier: Apache-2.0 */
/* The borders of all rectangles cut the plane into a table of cells, each wholly inside or outside
 * of every rectangle. Cells that are left are joined into runs along Y, equal runs along X. */
#include "sim_rects.hpp"

#include <algorithm>
#include <cstddef>

namespace opms::simulate
{
namespace
{

constexpr double SAME_MM = 1e-9; /* borders this close are one */

std::vector<double> borders(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    std::vector<double> unique;
    for (const double value : values) {
        if (unique.empty() || value - unique.back() > SAME_MM) {
            unique.push_back(value);
        }
    }
    return unique;
}

std::size_t place(const std::vector<double> &unique, double value)
{
    return static_cast<std::size_t>(
        std::lower_bound(unique.begin(), unique.end(), value - SAME_MM) - unique.begin());
}

class CellTable
{
  public:
    CellTable(const std::vector<Rect> &a, const std::vector<Rect> &b)
    {
        std::vector<double> xs, ys;
        for (const auto *list : {&a, &b}) {
            for (const Rect &r : *list) {
                xs.insert(xs.end(), {r.x0, r.x1});
                ys.insert(ys.end(), {r.y0, r.y1});
            }
        }
        x_ = borders(xs);
        y_ = borders(ys);
        cells_.assign(x_.size() * y_.size(), 0);
    }

    void set(const std::vector<Rect> &rects, char value)
    {
        for (const Rect &r : rects) {
            const std::size_t j0 = place(y_, r.y0), j1 = place(y_, r.y1);
            for (std::size_t i = place(x_, r.x0); i < place(x_, r.x1); ++i) {
                std::fill(&cell(i, j0), &cell(i, j0) + (j1 - j0), value);
            }
        }
    }

    std::vector<Rect> rects()
    {
        std::vector<Rect> all, open;
        for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
            std::vector<Rect> runs = runs_of(i);
            const bool as_before =
                runs.size() == open.size() && std::equal(runs.begin(), runs.end(), open.begin(),
                                                         [](const Rect &p, const Rect &q) {
                                                             return p.y0 == q.y0 && p.y1 == q.y1;
                                                         });
            if (as_before) {
                for (Rect &r : open) {
                    r.x1 = x_[i + 1];
                }
            } else {
                all.insert(all.end(), open.begin(), open.end());
                open = std::move(runs);
            }
        }
        all.insert(all.end(), open.begin(), open.end());
        return all;
    }

  private:
    char &cell(std::size_t i, std::size_t j)
    {
        return cells_[i * y_.size() + j];
    }

    std::vector<Rect> runs_of(std::size_t i)
    {
        std::vector<Rect> runs;
        for (std::size_t j = 0; j + 1 < y_.size(); ++j) {
            if (cell(i, j) == 0) {
                continue;
            }
            if (j > 0 && cell(i, j - 1) != 0) {
                runs.back().y1 = y_[j + 1];
            } else {
                runs.push_back({x_[i], y_[j], x_[i + 1], y_[j + 1]});
            }
        }
        return runs;
    }

    std::vector<double> x_, y_;
    std::vector<char> cells_;
};

std::vector<Rect> grown(std::vector<Rect> rects, double mm)
{
    for (Rect &r : rects) {
        r = {r.x0 - mm, r.y0 - mm, r.x1 + mm, r.y1 + mm};
    }
    return rects;
}

Rect box_about(const std::vector<Rect> &rects, double margin)
{
    Rect box = rects.front();
    for (const Rect &r : rects) {
        box = {std::min(box.x0, r.x0), std::min(box.y0, r.y0), std::max(box.x1, r.x1),
               std::max(box.y1, r.y1)};
    }
    return grown({box}, margin).front();
}

} // namespace

std::vector<Rect> subtract(const std::vector<Rect> &a, const std::vector<Rect> &b)
{
    CellTable table(a, b);
    table.set(a, 1);
    table.set(b, 0);
    return table.rects();
}

std::vector<Rect> grow(const std::vector<Rect> &set, double mm)
{
    if (set.empty() || mm == 0) {
        return subtract(set, {});
    }
    if (mm > 0) {
        return subtract(grown(set, mm), {});
    }
    /* What is left when the surroundings grow. */
    const Rect box = box_about(set, 1 - mm);
    return subtract({box}, grown(subtract({box}, set), -mm));
}

} // namespace opms::simulate
