/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The small parts of the bar stage, one by one. */
#include <math.h>
#include <string.h>

#include <unity.h>

#include "bar/bar_code.h"
#include "bar/correlation.h"
#include "bar/edge_wide.h"
#include "bar/labels.h"
#include "bar/line_search.h"
#include "bar/map_refine.h"
#include "bar/plane_map_wide.h"
#include "bar/quad.h"
#include "bar/search_plan.h"
#include "bar/stretch_fit.h"
#include "bar/stretch_scatter.h"
#include "bar_scene.h"
#include "truth_project.h"

#define RAY_LIMIT 3.0

static uint8_t picture[BAR_SCENE_PIXELS];
static point_t points[QUAD_POINTS_MAX];

void setUp(void)
{
    memset(picture, 0, sizeof picture);
}

void tearDown(void)
{
}

static view_t view_8(int width, int height)
{
    const opms_image_t image = {picture, width, height, width, OPMS_PIXEL_GREY8, 0};
    return view_of(&image);
}

/* Corners */

static double normal_density(double z)
{
    return exp(-0.5 * z * z) / sqrt(2 * 3.14159265358979323846);
}

static double normal_part(double z)
{
    return 0.5 * erfc(-z / sqrt(2));
}

static void the_profile_of_eight_pixels_is_the_normal_distribution(void)
{
    for (int i = -4800; i <= 4800; i += WIDE) {
        wide_t z = {0};
        for (int k = 0; k < WIDE; ++k) {
            z[k] = (float)(i + k) / 1000.f;
        }
        const normal_wide_t profile = normal_wide(z);
        for (int k = 0; k < WIDE; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(4e-6, normal_part((double)z[k]), profile.step[k]);
            TEST_ASSERT_DOUBLE_WITHIN(4e-6, normal_density((double)z[k]), profile.pulse[k]);
        }
    }
    const wide_t beyond = {-1e6f, -60.f, 60.f, 1e6f, -6.f, 6.f, -1e3f, 1e3f};
    const normal_wide_t profile = normal_wide(beyond);
    for (int k = 0; k < WIDE; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, beyond[k] < 0 ? 0 : 1, profile.step[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, profile.pulse[k]);
    }
}

/** Part of a joint normal distribution that lies below a and b, by Simpson's rule. */
static double joint_part(double a, double b, double correlation)
{
    const int steps = 4000;
    const double from = -9, step = (a - from) / steps, rest = sqrt(1 - correlation * correlation);
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
        const double x = from + i * step;
        const double weight = i == 0 || i == steps ? 1 : i % 2 ? 4 : 2;
        sum += weight * normal_density(x) * normal_part((b - correlation * x) / rest);
    }
    return sum * step / 3;
}

static void a_corner_off_the_right_angle_covers_its_share(void)
{
    static const struct {
        double lean, error;
    } cases[] = {{0, 1e-6}, {0.2, 1e-5}, {-0.4, 3e-4}, {0.6, 2e-3}, {-0.6, 2e-3}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        for (double a = -2; a <= 2; a += 0.5) {
            for (double b = -2; b <= 2; b += 0.5) {
                const wide_t excess = corner_excess(
                    wide_of((float)cases[i].lean), wide_of((float)a),
                    wide_of((float)normal_density(a)), wide_of((float)b),
                    wide_of((float)normal_density(b)));
                TEST_ASSERT_DOUBLE_WITHIN(cases[i].error, joint_part(a, b, cases[i].lean),
                                          normal_part(a) * normal_part(b) + (double)excess[1]);
            }
        }
    }
}

/* Codes */

/** Bits in which `count` neighbours from square a on differ from those from b on, b read upside
 * down with `turn`. */
static int window_distance(int a, int b, int count, int turn)
{
    int distance = 0;
    for (int i = 0; i < count; ++i) {
        const int other = bar_codes[turn ? b + count - 1 - i : b + i];
        for (int bit = 0; bit < BAR_CELLS; ++bit) {
            distance +=
                (bar_codes[a + i] >> bit & 1) != (other >> (turn ? BAR_CELLS - 1 - bit : bit) & 1);
        }
    }
    return distance;
}

static void neighbouring_codes_tell_places_and_directions_apart(void)
{
    const int least[] = {3, 6, 8, 9}; /* for 2 to 5 neighbours */
    for (int count = 2; count <= 5; ++count) {
        int closest = 99;
        for (int a = 0; a + count <= OPMS_BAR_SQUARES; ++a) {
            for (int b = 0; b + count <= OPMS_BAR_SQUARES; ++b) {
                const int turned = window_distance(a, b, count, 1);
                const int straight = a == b ? 99 : window_distance(a, b, count, 0);
                closest = turned < closest ? turned : closest;
                closest = straight < closest ? straight : closest;
            }
        }
        TEST_ASSERT_EQUAL_INT(least[count - 2], closest);
    }
}

static void a_gap_holds_cells_of_both_its_squares(void)
{
    TEST_ASSERT_EQUAL_HEX(0x20, bar_gap_cells(0, -1)); /* 57: lower 001, no square before */
    TEST_ASSERT_EQUAL_HEX(0x07, bar_gap_cells(0, 1));  /* 57: upper 111; 8: lower 000 */
    TEST_ASSERT_EQUAL_HEX(0x1c, bar_gap_cells(1, 1));  /* 8: upper 001; 46: lower 110 */
    TEST_ASSERT_EQUAL_HEX(0x00, bar_gap_cells(32, 1)); /* 5: upper 000, no square after */
    for (int k = 1; k < OPMS_BAR_SQUARES; ++k) {
        TEST_ASSERT_EQUAL_HEX(bar_gap_cells(k - 1, 1), bar_gap_cells(k, -1));
    }
}

/* The map of the plane */

/** The map of a scene for a row whose place 0 is square `first`, or that runs against the bar. */
static plane_map_t true_map(const bar_scene_t *scene, int first, int turn)
{
    plane_map_t map;
    plane_pair_t pairs[20];
    for (int i = 0; i < 20; ++i) {
        const double x_mm = i % 2 ? 10.0 : -10.0, y_mm = 15.0 * (i / 2) - 10.0;
        const double bar_m[3] = {1e-3 * (turn ? -x_mm : x_mm),
                                 1e-3 * ((turn ? -y_mm : y_mm) + 30.0 * (first - 16)), 0.0};
        double camera_m[3];
        truth_apply_inverse(&scene->bar_camera, bar_m, camera_m);
        pairs[i] =
            (plane_pair_t){x_mm, y_mm, {camera_m[0] / camera_m[2], camera_m[1] / camera_m[2]}};
    }
    TEST_ASSERT_TRUE(plane_map_fit(&map, pairs, 20));
    return map;
}

static void a_fitted_map_projects_as_the_camera_does(void)
{
    const bar_scene_t scene = bar_scene();
    const plane_map_t map = true_map(&scene, 14, 0);
    for (int corner = 0; corner < 4; ++corner) {
        double truth[2], px[2], stepped[2], jac[4];
        const double x_mm = corner == 0 || corner == 3 ? -10.0 : 10.0;
        const double y_mm = 60.0 + (corner < 2 ? -10.0 : 10.0); /* square 16 */
        bar_scene_corner(&scene, 16, corner, truth);
        TEST_ASSERT_TRUE(plane_map_project(&map, &scene.lens, RAY_LIMIT, x_mm, y_mm, px, jac));
        for (int axis = 0; axis < 2; ++axis) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, truth[axis], px[axis]);
            plane_map_project(&map, &scene.lens, RAY_LIMIT, x_mm + 1e-4, y_mm, stepped, NULL);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, (stepped[axis] - px[axis]) / 1e-4, jac[2 * axis]);
            plane_map_project(&map, &scene.lens, RAY_LIMIT, x_mm, y_mm + 1e-4, stepped, NULL);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, (stepped[axis] - px[axis]) / 1e-4, jac[2 * axis + 1]);
        }
    }
}

static void the_gradient_of_a_map_is_its_slope(void)
{
    const bar_scene_t scene = bar_scene();
    plane_map_t map = true_map(&scene, 14, 0);
    const wide_double_t x_mm = {7, 7, -4, -4}, y_mm = {33, 33, -250, -250};
    const wide_double_t nu = {1, 0, 1, 0}, nv = {0, 1, 0, 1};
    wide_double_t row[8];
    plane_map_rows(&map, &scene.lens, x_mm, y_mm, nu, nv, row);
    for (int k = 0; k < 8; ++k) {
        const double at = map.h[k];
        for (int lane = 0; lane < WIDE_DOUBLES; ++lane) {
            double high[2], low[2];
            map.h[k] = at + 1e-6;
            plane_map_project(&map, &scene.lens, RAY_LIMIT, x_mm[lane], y_mm[lane], high, NULL);
            map.h[k] = at - 1e-6;
            plane_map_project(&map, &scene.lens, RAY_LIMIT, x_mm[lane], y_mm[lane], low, NULL);
            const int axis = nv[lane] > 0;
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, (high[axis] - low[axis]) / 2e-6, row[k][lane]);
        }
        map.h[k] = at;
    }
}

static void a_relabelled_map_is_the_same_map(void)
{
    const bar_scene_t scene = bar_scene();
    for (int turn = 0; turn < 2; ++turn) {
        plane_map_t map = true_map(&scene, 14, 0);
        double before[2], after[2];
        plane_map_project(&map, &scene.lens, RAY_LIMIT, 4.0, 50.0, before, NULL);
        plane_map_relabel(&map, turn, 90.0);
        TEST_ASSERT_TRUE(plane_map_project(&map, &scene.lens, RAY_LIMIT, turn ? -4.0 : 4.0,
                                           turn ? 40.0 : 140.0, after, NULL));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, before[0], after[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, before[1], after[1]);
    }
}

static void too_few_points_make_no_map(void)
{
    plane_map_t map;
    const plane_pair_t pairs[4] = {
        {-10, 0, {0, 0}}, {10, 0, {1, 0}}, {-5, 0, {2, 0}}, {5, 0, {3, 0}}};
    TEST_ASSERT_FALSE(plane_map_fit(&map, pairs, 3));
    TEST_ASSERT_FALSE(plane_map_fit(&map, pairs, 4)); /* all on one line */
}

/* Lines */

static void dark_runs_of_a_line_are_found_in_turn(void)
{
    uint16_t values[60];
    for (int i = 0; i < 60; ++i) {
        const int dark = (i >= 10 && i < 18) || (i >= 30 && i < 36) || i >= 50;
        values[i] = dark ? 40 : (uint16_t)(180 + i % 3);
    }
    dark_run_t run;
    int cursor = 0;
    TEST_ASSERT_TRUE(line_next_run(values, 60, 60, 4, 20, &cursor, &run));
    TEST_ASSERT_INT_WITHIN(1, 13, run.middle);
    TEST_ASSERT_EQUAL_INT(8, run.length);
    TEST_ASSERT_EQUAL_INT(40, run.black);
    TEST_ASSERT_INT_WITHIN(3, 180, run.white);
    TEST_ASSERT_TRUE(line_next_run(values, 60, 60, 4, 20, &cursor, &run));
    TEST_ASSERT_INT_WITHIN(1, 32, run.middle);
    TEST_ASSERT_EQUAL_INT(6, run.length);
    /* The last one has no light beyond it. */
    TEST_ASSERT_FALSE(line_next_run(values, 60, 60, 4, 20, &cursor, &run));
    TEST_ASSERT_FALSE(line_next_run(values, 60, 60, 4, 20, &cursor, &run));
    cursor = 0;
    TEST_ASSERT_TRUE(line_next_run(values, 60, 60, 4, 7, &cursor, &run));
    TEST_ASSERT_EQUAL_INT(6, run.length);
    cursor = 0;
    TEST_ASSERT_FALSE(line_next_run(values, 60, 60, 9, 20, &cursor, &run));
    cursor = 0;
    TEST_ASSERT_FALSE(line_next_run(values, 60, 160, 4, 20, &cursor, &run));
    cursor = 0;
    TEST_ASSERT_FALSE(line_next_run(values, 0, 60, 4, 20, &cursor, &run));
}

static void a_search_crosses_whatever_is_as_wide_as_its_pitch(void)
{
    const int sizes[][3] = {{640, 480, 7}, {5, 1000, 6}, {1, 1, 7}, {64, 63, 64}};
    for (int i = 0; i < 4; ++i) {
        static uint8_t seen[2][1024];
        memset(seen, 0, sizeof seen);
        const int size[2] = {sizes[i][1], sizes[i][0]}; /* rows, columns */
        search_plan_t plan;
        search_line_t line;
        search_plan_init(&plan, sizes[i][0], sizes[i][1], sizes[i][2]);
        while (search_plan_next(&plan, &line)) {
            TEST_ASSERT_TRUE(line.at >= 0 && line.at < size[line.upright]);
            TEST_ASSERT_EQUAL_INT(0, line.from);
            TEST_ASSERT_EQUAL_INT(size[!line.upright] - 1, line.to);
            TEST_ASSERT_EQUAL_UINT8(0, seen[line.upright][line.at]);
            seen[line.upright][line.at] = 1;
        }
        for (int upright = 0; upright < 2; ++upright) {
            int gap = 0;
            for (int at = 0; at < size[upright]; ++at) {
                gap = seen[upright][at] ? 0 : gap + 1;
                TEST_ASSERT_TRUE(gap < sizes[i][2] || size[upright] < sizes[i][2]);
            }
        }
    }
}

/* Quadrilaterals */

/** A dark square of half side `half` about (x, y), its border as soft as a pixel is wide. */
static void draw_square(double x, double y, double half, double angle)
{
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 100 * 100; ++i) {
        const double du = i % 100 - x, dv = i / 100 - y;
        const double out = fmax(fabs(c * du + s * dv), fabs(c * dv - s * du)) - half;
        picture[i] = (uint8_t)(40.0 + 150.0 * fmin(1.0, fmax(0.0, out + 0.5)));
    }
}

static void a_square_is_traced_to_its_corners(void)
{
    const view_t view = view_8(100, 100);
    const quad_limits_t limits = {1000, 5.f};
    for (int i = 0; i < 8; ++i) {
        quad_t quad;
        const double half = 5.0 + 3.0 * i, angle = 0.2 * i;
        draw_square(49.3, 51.6, half, angle);
        TEST_ASSERT_TRUE(quad_trace(&view, 50, 51, 115.f, &limits, points, &quad));
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 49.3f, quad.centre.x);
        TEST_ASSERT_FLOAT_WITHIN(0.1f, 51.6f, quad.centre.y);
        TEST_ASSERT_FLOAT_WITHIN(0.5f, (float)(2.0 * half), quad.shortest);
        TEST_ASSERT_FLOAT_WITHIN(0.5f, (float)(2.0 * half), quad.longest);
        double turned = 0.0;
        for (int k = 0; k < 4; ++k) {
            const point_t a = quad.corner[k], b = quad.corner[(k + 1) & 3];
            const double radius = hypot(a.x - 49.3, a.y - 51.6);
            TEST_ASSERT_DOUBLE_WITHIN(0.4, half * sqrt(2.0), radius);
            turned += a.x * b.y - a.y * b.x;
        }
        TEST_ASSERT_TRUE(turned > 0.0); /* clockwise as seen */
    }
}

static void what_is_no_closed_quadrilateral_is_refused(void)
{
    const view_t view = view_8(100, 100);
    quad_limits_t limits = {1000, 5.f};
    quad_t quad;
    draw_square(50.0, 50.0, 20.0, 0.3);
    TEST_ASSERT_FALSE(quad_trace(&view, 5, 5, 115.f, &limits, points, &quad)); /* light */
    limits.longest_contour = 100;
    TEST_ASSERT_FALSE(quad_trace(&view, 50, 50, 115.f, &limits, points, &quad));
    limits.longest_contour = 1000;
    limits.shortest_side = 45.f;
    TEST_ASSERT_FALSE(quad_trace(&view, 50, 50, 115.f, &limits, points, &quad));
    limits.shortest_side = 5.f;
    draw_square(10.0, 50.0, 20.0, 0.3); /* the border cuts it */
    TEST_ASSERT_FALSE(quad_trace(&view, 10, 50, 115.f, &limits, points, &quad));
    for (int i = 0; i < 100 * 100; ++i) { /* a disc */
        picture[i] = hypot(i % 100 - 50.0, i / 100 - 50.0) < 25.0 ? 40 : 190;
    }
    TEST_ASSERT_FALSE(quad_trace(&view, 50, 50, 115.f, &limits, points, &quad));
}

/* Labels */

static label_verdict_t decide(const bar_scene_t *scene, int first, int turn, int squares,
                              labels_t *labels)
{
    chain_t chain;
    memset(&chain, 0, sizeof chain);
    chain.count = squares;
    for (int i = 0; i < squares; ++i) {
        chain.square[i].place = i;
    }
    const view_t view = view_8(BAR_SCENE_WIDTH, BAR_SCENE_HEIGHT);
    const plane_map_t map = true_map(scene, first, turn);
    return labels_decide(&view, &chain, &map, &scene->lens, RAY_LIMIT, labels);
}

static void a_row_is_labelled_in_both_directions(void)
{
    const bar_scene_t scene = bar_scene();
    labels_t labels;
    bar_render8(&scene, picture);
    for (int squares = 3; squares <= 5; ++squares) {
        TEST_ASSERT_EQUAL(LABELS_CERTAIN, decide(&scene, 14, 0, squares, &labels));
        TEST_ASSERT_EQUAL_INT(0, labels.turn);
        TEST_ASSERT_EQUAL_INT(14, labels.offset);
        TEST_ASSERT_EQUAL(LABELS_CERTAIN, decide(&scene, 18, 1, squares, &labels));
        TEST_ASSERT_EQUAL_INT(1, labels.turn);
        TEST_ASSERT_EQUAL_INT(18, labels.offset);
    }
    TEST_ASSERT_EQUAL(LABELS_NOT_A_BAR, decide(&scene, 14, 0, 2, &labels));
}

static void a_row_without_cells_gets_no_labels(void)
{
    bar_scene_t scene = bar_scene();
    labels_t labels;
    memset(scene.codes, 0, sizeof scene.codes);
    bar_render8(&scene, picture);
    TEST_ASSERT_NOT_EQUAL(LABELS_CERTAIN, decide(&scene, 14, 0, 5, &labels));
}

/* Weights */

static double uniform(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return ((double)(*state >> 12) + 0.5) * 0x1p-52;
}

static double normal(uint64_t *state)
{
    const double r = sqrt(-2 * log(uniform(state)));
    return r * cos(2 * 3.14159265358979323846 * uniform(state));
}

/** Mean variance over `pixels` (even) residuals of a standard deviation of 1. */
static double scatter_of(int pixels, uint64_t *state)
{
    double product = 1; /* chi square with 2 n degrees of freedom */
    for (int i = 0; i < pixels / 2; ++i) {
        product *= uniform(state);
    }
    return -2 * log(product) / pixels;
}

static void stretches_weighed_by_their_scatter_promise_what_their_mean_keeps(void)
{
    enum { TRIALS = 60000, STRETCHES = 20, PIXELS = 20 };
    uint64_t state = 1713;
    double kept = 0;
    for (int t = 0; t < TRIALS; ++t) {
        double sum = 0, weights = 0;
        for (int i = 0; i < STRETCHES; ++i) {
            const float own = (float)scatter_of(PIXELS, &state);
            const double w = 1 / (double)stretch_scatter(own, PIXELS, 1.f);
            sum += w * normal(&state);
            weights += w;
        }
        kept += sum * sum / weights;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0, kept / TRIALS); /* 3.5 of its standard deviations */
}

/** What a standard deviation of 1 px becomes in a picture of shaped profiles. */
static float doubted(double way_mm, double still_px, double clip)
{
    static bar_fit_t fit;
    edge_scene_t scene = {0};
    scene.shaped = 1;
    scene.way_mm[0] = way_mm;
    scene.still_px = still_px;
    scene.clip = clip;
    fit.count = 1;
    fit.sigma[0] = 1;
    correlation_state(&scene, &fit);
    return fit.sigma[0];
}

static void what_the_model_cannot_tell_is_less_certain(void)
{
    TEST_ASSERT_EQUAL_FLOAT(1, doubted(0, 0.7, 0.5));
    TEST_ASSERT_EQUAL_FLOAT(1, doubted(0, 1.5, UNCUT));
    TEST_ASSERT_EQUAL_FLOAT(sqrtf(8), doubted(0, 1.5, 0.5)); /* defocus, or motion not found */
    TEST_ASSERT_EQUAL_FLOAT(1, doubted(5, 1.5, UNCUT));
    TEST_ASSERT_EQUAL_FLOAT(sqrtf(1.5f), doubted(5, 1.5, 0.5));
    TEST_ASSERT_EQUAL_FLOAT(2, doubted(-9, 0.7, UNCUT)); /* half a square across the bar */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(neighbouring_codes_tell_places_and_directions_apart);
    RUN_TEST(a_gap_holds_cells_of_both_its_squares);
    RUN_TEST(a_fitted_map_projects_as_the_camera_does);
    RUN_TEST(the_gradient_of_a_map_is_its_slope);
    RUN_TEST(a_relabelled_map_is_the_same_map);
    RUN_TEST(too_few_points_make_no_map);
    RUN_TEST(dark_runs_of_a_line_are_found_in_turn);
    RUN_TEST(a_search_crosses_whatever_is_as_wide_as_its_pitch);
    RUN_TEST(a_square_is_traced_to_its_corners);
    RUN_TEST(what_is_no_closed_quadrilateral_is_refused);
    RUN_TEST(the_profile_of_eight_pixels_is_the_normal_distribution);
    RUN_TEST(a_corner_off_the_right_angle_covers_its_share);
    RUN_TEST(a_row_is_labelled_in_both_directions);
    RUN_TEST(a_row_without_cells_gets_no_labels);
    RUN_TEST(stretches_weighed_by_their_scatter_promise_what_their_mean_keeps);
    RUN_TEST(what_the_model_cannot_tell_is_less_certain);
    return UNITY_END();
}
