/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Edges of cut white and in motion, against pictures that are summed up instant by instant. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "bar/stretch_fit.h"

#define WIDTH 24
#define LINES 5
#define EDGE_AT 11 /* pixel on which a side is expected */
#define INSTANTS 600
#define BLACK 6000.0
#define CONTRAST 40000.0

/** A square's side in the plane, and how it moves. */
typedef struct side {
    double off_px;           /**< from where it is expected, outwards */
    double sigma_px;
    double way_px, way_mm;   /**< across and along, while the shutter is open */
    double along_px;         /**< px per mm */
    double end_mm;           /**< the side ends at this and at minus this, beyond is white */
    double ground_px, drop;  /**< beyond the border the ground is darker by this part, 0: nowhere */
    double clip;             /**< white is cut at this part of the contrast */
    double from_mm;          /**< of the first line along the side; a line is 1 px wide */
} side_t;

static uint16_t grey[LINES * WIDTH];

void setUp(void)
{
}

void tearDown(void)
{
}

static double normal_part(double z)
{
    return 0.5 * erfc(-z * 0.70710678118654752);
}

/** White coverage at `s` px beyond the expected edge and `along` mm from the side's middle. */
static double coverage(const side_t *side, double s, double along)
{
    double sum = 0;
    for (int k = 0; k < INSTANTS; ++k) {
        const double t = (k + 0.5) / INSTANTS - 0.5;
        const double out = s - side->off_px - t * side->way_px;
        const double to_end = side->end_mm - fabs(along - t * side->way_mm);
        const double dark = (1 - normal_part(out / side->sigma_px)) *
                            normal_part(to_end * side->along_px / side->sigma_px);
        const double ground =
            side->ground_px > 0 ? normal_part((out - side->ground_px) / side->sigma_px) : 0;
        sum += 1 - dark - side->drop * ground;
    }
    return sum / INSTANTS;
}

static double along_of(const side_t *side, int line)
{
    return side->from_mm + line / side->along_px;
}

static fit_lines_t draw(const side_t *side)
{
    fit_lines_t lines = {.count = LINES, .wide = 1, .pixel_bytes = sizeof grey[0]};
    for (int i = 0; i < LINES; ++i) {
        for (int k = 0; k < WIDTH; ++k) {
            const double light = coverage(side, k - EDGE_AT, along_of(side, i));
            grey[i * WIDTH + k] =
                (uint16_t)lround(BLACK + CONTRAST * fmin(light, fmin(1.5, side->clip)));
        }
        lines.line[i] = (fit_line_t){.first = (const uint8_t *)&grey[i * WIDTH],
                                     .count = WIDTH,
                                     .s_first = -EDGE_AT,
                                     .s_step = 1,
                                     .along_first = (float)along_of(side, i)};
    }
    return lines;
}

/** What the detector would know of a side. */
static side_model_t model_of(const side_t *side)
{
    const double whole = hypot(side->way_px, side->way_mm * side->along_px);
    side_model_t model;
    memset(&model, 0, sizeof model);
    model.blur = edge_blur_boxed(side->sigma_px, fabs(side->way_px));
    model.sigma = (float)side->sigma_px;
    model.per_sigma = (float)(1 / side->sigma_px);
    model.end_at = (float)side->end_mm;
    model.along_scale = (float)(side->along_px / side->sigma_px);
    model.per_cut_noise = 500.f;
    model.way_px = (float)side->way_px;
    model.way_by = 1.f;
    model.way_mm = (float)side->way_mm;
    model.panels = whole > 0 ? 1 + (int)(whole / (3.2 * side->sigma_px)) : 0;
    model.ground = (float)side->ground_px;
    model.ground_drop = (float)side->drop;
    model.clip = (float)side->clip;
    model.white_level = model.cut_level =
        (float)fmin(65535, lround(BLACK + CONTRAST * side->clip));
    return model;
}

static side_t plain_side(void)
{
    const side_t side = {.sigma_px = 0.7, .along_px = 1.1, .end_mm = 10, .clip = 2, .from_mm = -1};
    return side;
}

/** Fit the picture of `is` with the model of `assumed`. */
static stretch_t fit(const side_t *is, const side_t *assumed, shape_info_t *shape)
{
    const fit_lines_t lines = draw(is);
    const side_model_t model = model_of(assumed);
    stretch_t found;
    memset(&found, 0, sizeof found);
    TEST_ASSERT_TRUE(stretch_kernel(0)->fit_shaped(&model, &lines, &found, shape));
    return found;
}

/** A fit with the true shape finds the edge and leaves nothing of the picture unexplained. */
static void explained(side_t side)
{
    shape_info_t shape;
    side.off_px = 0.01;
    const stretch_t found = fit(&side, &side, &shape);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, side.off_px, found.offset_px);
    TEST_ASSERT_FLOAT_WITHIN(1e-3 * CONTRAST, BLACK, found.black);
    TEST_ASSERT_FLOAT_WITHIN(2e-3 * CONTRAST, CONTRAST * fmin(1, side.clip), found.contrast);
    TEST_ASSERT_FLOAT_WITHIN(1.5e-3 * CONTRAST, 0, sqrtf(found.variance));
}

static void a_moving_edge_is_the_mean_of_still_ones(void)
{
    for (double way = -5; way <= 5; way += 2.5) {
        side_t side = plain_side();
        side.way_px = way;
        explained(side);
        side.from_mm = 6.5; /* the side's end in sight, which moves along */
        for (double along = -4; along <= 4; along += 4) {
            side.way_mm = along;
            explained(side);
        }
    }
}

static void ground_beyond_the_border_is_dark_in_motion_too(void)
{
    side_t side = plain_side();
    side.ground_px = 5;
    for (double way = -3; way <= 3; way += 3) {
        side.way_px = way;
        side.clip = 2;
        side.drop = 0; /* where white is not cut its brightness is solved for */
        explained(side);
        side.clip = 0.7;
        side.drop = 0.6;
        explained(side);
    }
}

static void a_moving_edge_is_found_in_what_saturation_left_of_it(void)
{
    for (double clip = 0.3; clip < 0.95; clip += 0.3) {
        side_t side = plain_side();
        side.clip = clip;
        explained(side);
        side.way_px = 3;
        explained(side);
        side.from_mm = 6.5;
        side.way_mm = -3;
        explained(side);
    }
}

/** What a fit with slightly wrong shape says is missing of one of its unknowns. */
static double told(const side_t *is, const side_t *assumed, int unknown)
{
    shape_info_t shape;
    fit(is, assumed, &shape);
    return (double)(shape.slope[unknown] / shape.weight[unknown][unknown]);
}

static void a_fit_with_a_wrong_shape_says_what_is_missing(void)
{
    side_t side = plain_side();
    side.way_px = -3;
    side.way_mm = 3;
    side.from_mm = 6.5;
    side_t wrong = side;
    wrong.sigma_px -= 0.02;
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.02, told(&side, &wrong, SHAPE_STILL));
    wrong = side;
    wrong.way_px += 0.1;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -0.1, told(&side, &wrong, SHAPE_WAY));
    wrong = side;
    wrong.way_mm -= 0.1;
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.1, told(&side, &wrong, SHAPE_WAY + 1));
    side = plain_side();
    side.way_px = 3;
    side.clip = 0.6;
    side.ground_px = 4;
    side.drop = 0.6;
    wrong = side;
    wrong.drop -= 0.05;
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.05, told(&side, &wrong, SHAPE_GROUND));
    /* The level at which grey is cut is known; of the true contrast it is a smaller part. */
    side.drop = wrong.drop = side.ground_px = wrong.ground_px = 0;
    wrong = side;
    wrong.clip *= 1.03;
    const fit_lines_t lines = draw(&side);
    side_model_t model = model_of(&wrong);
    model.white_level = model.cut_level = model_of(&side).cut_level;
    stretch_t found;
    shape_info_t shape;
    memset(&found, 0, sizeof found);
    TEST_ASSERT_TRUE(stretch_kernel(0)->fit_shaped(&model, &lines, &found, &shape));
    TEST_ASSERT_DOUBLE_WITHIN(0.003, -log(1.03),
                              (double)(shape.slope[SHAPE_CLIP] /
                                       shape.weight[SHAPE_CLIP][SHAPE_CLIP]));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_moving_edge_is_the_mean_of_still_ones);
    RUN_TEST(ground_beyond_the_border_is_dark_in_motion_too);
    RUN_TEST(a_moving_edge_is_found_in_what_saturation_left_of_it);
    RUN_TEST(a_fit_with_a_wrong_shape_says_what_is_missing);
    return UNITY_END();
}
