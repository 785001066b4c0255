/* SPDX-License-Identifier: Apache-2.0 */
/* Four rows side by side, the same pixel of each at a time: what is done once a row, the weighting
 * by powers of s, then costs a quarter, and no lane is idle at the rows' ends. */
#include "grid/line_sums.h"

static inline lanes_t greys_at(const row_batch_t *batch, ptrdiff_t offset, int wide)
{
    if (wide) {
        uint16_t grey[LANES];
        for (int l = 0; l < LANES; ++l) {
            memcpy(&grey[l], batch->first[l] + offset, sizeof grey[l]);
        }
        return __builtin_convertvector((lanes_int_t){grey[0], grey[1], grey[2], grey[3]}, lanes_t);
    }
    const lanes_int_t grey = {batch->first[0][offset], batch->first[1][offset],
                              batch->first[2][offset], batch->first[3][offset]};
    return __builtin_convertvector(grey, lanes_t);
}

/* What depends on where the pixels lie, and not on what they hold. */
static void place_products(const raster_t *raster, const row_batch_t *batch, border_lanes_t ends,
                           lanes_t row[PRODUCTS])
{
    const float n = (float)raster->row_size, slope = raster->slope;
    const lanes_t middle = batch->x + 0.5f * (n - 1.f) * slope;
    row[ONE_ONE] = lanes_of(n);
    row[ONE_ACROSS] = n * middle;
    row[ACROSS_ACROSS] = n * (middle * middle + slope * slope * (n * n - 1.f) / 12.f);
    row[ONE_DEPTH] = ends.area / slope;
    row[ONE_SHIFT] = ends.level / slope;
}

/* Sum up each row by itself. A pixel sees the mean over its own width: what lies between its
 * borders. */
static inline void read_rows(const raster_t *raster, const row_batch_t *batch, int wide,
                             lanes_t row[PRODUCTS])
{
    const view_t *view = raster->view;
    const ptrdiff_t size = wide ? 2 : 1, step = raster->columns ? view->stride : size;
    const float per_width = 1.f / raster->slope;
    const border_lanes_t start =
        border_lanes_at(raster->profile, batch->x - 0.5f * raster->slope);
    border_lanes_t left = start;
    lanes_t x = batch->x, across_depth = {0.f}, across_shift = {0.f}, depth_depth = {0.f},
            depth_shift = {0.f}, shift_shift = {0.f}, one_grey = {0.f}, across_grey = {0.f},
            depth_grey = {0.f}, shift_grey = {0.f}, grey_grey = {0.f};
    for (int k = 0; k < raster->row_size; ++k) {
        const lanes_t grey = greys_at(batch, k * step, wide) - raster->origin;
        const border_lanes_t right = border_lanes_at(raster->profile, x + 0.5f * raster->slope);
        const lanes_t depth = (right.area - left.area) * per_width;
        const lanes_t shift = (right.level - left.level) * per_width;
        across_depth += x * depth;
        across_shift += x * shift;
        depth_depth += depth * depth;
        depth_shift += depth * shift;
        shift_shift += shift * shift;
        one_grey += grey;
        across_grey += x * grey;
        depth_grey += depth * grey;
        shift_grey += shift * grey;
        grey_grey += grey * grey;
        left = right;
        x += raster->slope;
    }
    const border_lanes_t ends = {left.area - start.area, left.level - start.level};
    place_products(raster, batch, ends, row);
    row[ACROSS_DEPTH] = across_depth;
    row[ACROSS_SHIFT] = across_shift;
    row[DEPTH_DEPTH] = depth_depth;
    row[DEPTH_SHIFT] = depth_shift;
    row[SHIFT_SHIFT] = shift_shift;
    row[ONE_GREY] = one_grey;
    row[ACROSS_GREY] = across_grey;
    row[DEPTH_GREY] = depth_grey;
    row[SHIFT_GREY] = shift_grey;
    row[GREY_GREY] = grey_grey;
}

/* Lanes without a row repeat another's pixels, */
static void fill_up(row_batch_t *batch)
{
    for (int l = batch->count; l < LANES; ++l) {
        batch->first[l] = batch->first[0];
        batch->x[l] = batch->x[0];
        batch->s[l] = 0.f;
    }
}

/* and count nothing. */
static void drop_filling(const row_batch_t *batch, lanes_t row[PRODUCTS])
{
    const lanes_int_t number = {0, 1, 2, 3}, counts = number < batch->count;
    for (int i = 0; i < PRODUCTS; ++i) {
        row[i] = (lanes_t)((lanes_int_t)row[i] & counts);
    }
}

static void add_powers(lanes_t row[PRODUCTS], lanes_t s, line_sums_t *sums)
{
    for (int i = 0; i < PRODUCTS; ++i) {
        sums->plain[i] += row[i];
    }
    for (int i = 0; i < PRODUCTS_ONCE; ++i) {
        row[i] *= s;
        sums->once[i] += row[i];
    }
    for (int i = 0; i < PRODUCTS_TWICE; ++i) {
        row[i] *= s;
        sums->twice[i] += row[i];
    }
    for (int i = 0; i < PRODUCTS_THRICE; ++i) {
        row[i] *= s;
        sums->thrice[i] += row[i];
    }
}

void add_rows(const raster_t *raster, row_batch_t *batch, line_sums_t *sums)
{
    lanes_t row[PRODUCTS];
    if (batch->count == 0) {
        return;
    }
    fill_up(batch);
    if (raster->view->wide) {
        read_rows(raster, batch, 1, row);
    } else {
        read_rows(raster, batch, 0, row);
    }
    drop_filling(batch, row);
    add_powers(row, batch->s, sums);
    sums->rows += batch->count;
    batch->count = 0;
}
