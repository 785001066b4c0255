/* SPDX-License-Identifier: Apache-2.0 */
#include "grid/node_fit.h"

#include "algebra/median.h"
#include "grid/line_fit.h"

#define LINE_PART 0.08f    /* of the pitch: 2 mm of 25 mm */
#define ARM_END 0.5f       /* of the step: the other half belongs to the next node */
#define RUNGS 7            /* blurs that are tried at most, */
#define RUNG_START 2       /* and first: 0.7 px */
#define WHITE_PX 1.f       /* beyond the line's own blur: more meets the crossing line */
#define CLEAR 2.5f         /* blurs beyond the other line's edge, where an arm begins */
#define MOVED_PX 0.1f      /* beyond this the fit is not yet linear */
#define ROUNDS 3
#define ROWS_USUAL 6      /* of an arm: more add little and cost time, */
#define ROWS_MANY 10      /* but a blurred line has less to measure by */
#define BLUR_LARGE 1.1f   /* px */
#define SAMPLES 32
#define BLUR_SAMPLES 10
#define CONTRAST_LEAST 0.25f /* of the median: less is no line */
#define SIGMA_FLOOR_PX 0.002f
#define NOISE_PART 0.02f   /* of the contrast, roughly */
#define TURN_SIGMA 0.004f  /* rad, of a direction that neighbours tell */

/* One node's two lines. */
typedef struct crossing {
    line_stretch_t stretch[2];
    line_fit_t fit[2];
} crossing_t;

static vec2_t unit_of(vec2_t a)
{
    const float length = vec2_length(a);
    const vec2_t unit = {a.x / length, a.y / length};
    return unit;
}

/* From the neighbour before to the neighbour after, as far as they are found. */
static vec2_t chord(opms_grid_detector_t *d, int i, int j, int axis)
{
    const int di = axis == 0, dj = axis == 1;
    const lattice_node_t *node = node_at(d, i, j);
    const lattice_node_t *after = node_at(d, i + di, j + dj), *before = node_at(d, i - di, j - dj);
    const vec2_t to = after ? after->at : node->at, from = before ? before->at : node->at;
    const vec2_t along = {to.x - from.x, to.y - from.y};
    const float steps = (float)((after != NULL) + (before != NULL));
    if (steps == 0.f) {
        return node->step[axis];
    }
    const vec2_t step = {along.x / steps, along.y / steps};
    return step;
}

/* One arm alone knows where the line is, but not where it goes on to: offset and direction pull
 * each other. The next nodes inside tell the direction, bending included. */
static void lean_on_neighbours(opms_grid_detector_t *d, int i, int j, int axis,
                               line_stretch_t *stretch)
{
    const int side = stretch->plus ? 1 : -1;
    const int di = side * (axis == 0), dj = side * (axis == 1);
    const lattice_node_t *one = node_at(d, i + di, j + dj);
    const lattice_node_t *two = node_at(d, i + 2 * di, j + 2 * dj);
    const lattice_node_t *three = node_at(d, i + 3 * di, j + 3 * dj);
    if (!one || !two || !three) {
        return;
    }
    const vec2_t first = {two->at.x - one->at.x, two->at.y - one->at.y};
    const vec2_t second = {three->at.x - two->at.x, three->at.y - two->at.y};
    const vec2_t bend = {second.x - first.x, second.y - first.y};
    const vec2_t along = vec2_add(first, bend, -1.5f);
    const vec2_t ahead = {(float)side * along.x, (float)side * along.y};
    const float part = NOISE_PART / TURN_SIGMA;
    stretch->along = unit_of(ahead);
    stretch->turn_weight = part * part;
}

/* The two stretches of a node. 0 where they would be too short to see white. */
static int plan_node(opms_grid_detector_t *d, int i, int j, unsigned arms, crossing_t *crossing)
{
    const lattice_node_t *node = node_at(d, i, j);
    const vec2_t step[2] = {chord(d, i, j, 0), chord(d, i, j, 1)};
    const float area = fabsf(vec2_cross(step[0], step[1]));
    for (int axis = 0; axis < 2; ++axis) {
        line_stretch_t *stretch = &crossing->stretch[axis];
        const float length = vec2_length(step[axis]);
        const float pitch = area / length;                       /* to the parallel lines */
        const float cross_pitch = area / vec2_length(step[!axis]);
        const float slant = length / cross_pitch;                /* 1 where lines are square */
        const float cross_half = 0.5f * LINE_PART * cross_pitch + CLEAR * d->blur;
        stretch->at = node->at;
        stretch->along = unit_of(step[axis]);
        stretch->width = LINE_PART * pitch;
        stretch->blur = d->blur;
        stretch->profiles = &d->profiles;
        stretch->from = cross_half * slant;
        stretch->to = ARM_END * length;
        stretch->reach = fminf(0.5f * stretch->width + CLEAR * d->blur + WHITE_PX, 0.42f * pitch);
        stretch->rows = d->rows;
        stretch->turn_weight = 0.f;
        stretch->plus = (arms >> (2 * axis)) & 1;
        stretch->minus = (arms >> (2 * axis + 1)) & 1;
        if (!stretch->plus || !stretch->minus) {
            lean_on_neighbours(d, i, j, axis, stretch);
        }
        /* The reach across leans along: keep off the parallel of the other line. */
        stretch->from += stretch->reach * sqrtf(fmaxf(0.f, slant * slant - 1.f));
        if (stretch->to < stretch->from + 1.f) {
            return 0;
        }
    }
    return 1;
}

static int measure(opms_grid_detector_t *d, crossing_t *crossing)
{
    return fit_line(&d->view, &crossing->stretch[0], &crossing->fit[0]) &&
           fit_line(&d->view, &crossing->stretch[1], &crossing->fit[1]);
}

/* The point at `off[k]` from both lines' places. */
static vec2_t meet(const crossing_t *crossing, const float off[2])
{
    const vec2_t a = crossing->stretch[0].along, b = crossing->stretch[1].along;
    const float det = vec2_cross(a, b);
    /* With normals (-y, x): n_a . p = off_a, n_b . p = off_b. */
    const vec2_t move = {(off[0] * b.x - off[1] * a.x) / det, (off[0] * b.y - off[1] * a.y) / det};
    return move;
}

static float sigma_of(const crossing_t *crossing)
{
    const vec2_t a = crossing->stretch[0].along, b = crossing->stretch[1].along;
    const float det = vec2_cross(a, b);
    float variance = 0.f;
    for (int k = 0; k < 2; ++k) {
        const line_fit_t *fit = &crossing->fit[k];
        variance += fit->variance * fit->noise * fit->noise;
    }
    return sqrtf(0.5f * variance / (det * det)) + SIGMA_FLOOR_PX;
}

/* Curvature of a line at a node by the neighbours' places, 1/px, towards (-along.y, along.x). At
 * the grid's border that of the next node inside stands in. */
static float curvature(opms_grid_detector_t *d, int i, int j, int axis)
{
    const int di = axis == 0, dj = axis == 1;
    for (int inwards = 0; inwards < 3; ++inwards) {
        static const int shift[3] = {0, 1, -1};
        const int ci = i + shift[inwards] * di, cj = j + shift[inwards] * dj;
        const lattice_node_t *node = node_at(d, ci, cj);
        const lattice_node_t *after = node_at(d, ci + di, cj + dj);
        const lattice_node_t *before = node_at(d, ci - di, cj - dj);
        if (node && after && before) {
            const vec2_t along = {0.5f * (after->at.x - before->at.x),
                                  0.5f * (after->at.y - before->at.y)};
            const vec2_t bend = {after->at.x - 2.f * node->at.x + before->at.x,
                                 after->at.y - 2.f * node->at.y + before->at.y};
            const float length = vec2_length(along);
            return vec2_cross(along, bend) / (length * length * length);
        }
    }
    return 0.f;
}

/* Fit until the node does not move any more. 0 where it cannot be measured. */
static int fit_node(opms_grid_detector_t *d, int i, int j, unsigned arms, crossing_t *crossing)
{
    lattice_node_t *node = node_at(d, i, j);
    const vec2_t start = node->at;
    for (int round = 0; round < ROUNDS; ++round) {
        if (!plan_node(d, i, j, arms, crossing) || !measure(d, crossing)) {
            break;
        }
        const float off[2] = {crossing->fit[0].off, crossing->fit[1].off};
        const vec2_t move = meet(crossing, off);
        const float most = 0.3f * fminf(crossing->stretch[0].to, crossing->stretch[1].to) + 1.f;
        if (!(vec2_length(move) < most)) {
            break;
        }
        node->at = vec2_add(node->at, move, 1.f);
        if (vec2_length(move) < MOVED_PX) {
            return 1;
        }
    }
    node->at = start;
    return 0;
}

/* Nodes that tell the blur, and what each blur of a ladder leaves unexplained at them. */
typedef struct blur_trial {
    uint16_t samples[BLUR_SAMPLES];
    int sample_count;
    float misfit[RUNGS]; /* 0: not tried yet */
} blur_trial_t;

static const float LADDER[RUNGS] = {0.35f, 0.5f, 0.7f, 0.95f, 1.3f, 1.75f, 2.3f};

/* Median noise about the lines of the samples. A blur that is too wide for the arms fits nothing.
 * A node stays where a fit has moved it: the next fit begins nearer. */
static float misfit_of(opms_grid_detector_t *d, blur_trial_t *trial, int rung)
{
    float values[BLUR_SAMPLES];
    int count = 0;
    if (rung < 0 || rung >= RUNGS) {
        return HUGE_VALF;
    }
    if (trial->misfit[rung] > 0.f) {
        return trial->misfit[rung];
    }
    d->blur = LADDER[rung];
    for (int k = 0; k < trial->sample_count; ++k) {
        const int i = trial->samples[k] % LATTICE, j = trial->samples[k] / LATTICE;
        crossing_t crossing;
        if (fit_node(d, i, j, node_at(d, i, j)->arms, &crossing)) {
            values[count++] = crossing.fit[0].noise + crossing.fit[1].noise;
        }
    }
    trial->misfit[rung] = count >= 4 ? median_of(values, count) : HUGE_VALF;
    return trial->misfit[rung];
}

/* The rung that fits best: down, or else up, from one in the middle as long as that is better. */
static int best_rung(opms_grid_detector_t *d, blur_trial_t *trial)
{
    int best = RUNG_START;
    while (best > 0 && misfit_of(d, trial, best - 1) <= misfit_of(d, trial, best)) {
        --best;
    }
    while (best < RUNGS - 1 && misfit_of(d, trial, best + 1) < misfit_of(d, trial, best)) {
        ++best;
    }
    return best;
}

/* The best blur of the ladder, bettered by the parabola through it and its neighbours. */
static void estimate_blur(opms_grid_detector_t *d)
{
    blur_trial_t trial = {.sample_count = 0};
    const int every = d->queue_in / BLUR_SAMPLES + 1;
    for (int k = every / 2; k < d->queue_in && trial.sample_count < BLUR_SAMPLES; k += every) {
        trial.samples[trial.sample_count++] = d->queue[k];
    }
    d->rows = ROWS_MANY;
    const int best = best_rung(d, &trial);
    const float before = misfit_of(d, &trial, best - 1), at = misfit_of(d, &trial, best);
    const float after = misfit_of(d, &trial, best + 1);
    d->blur = LADDER[best];
    if (isfinite(before) && isfinite(after)) {
        const float bend = before - 2.f * at + after;
        const float part = 0.5f * (before - after) / fmaxf(bend, 1e-9f);
        d->blur *= powf(LADDER[best + 1] / LADDER[best], fminf(1.f, fmaxf(-1.f, part)));
    }
}

static void keep_fit(lattice_node_t *node, const crossing_t *crossing)
{
    const float first[2] = {crossing->fit[0].bend, 0.f}, second[2] = {0.f, crossing->fit[1].bend};
    node->bend[0] = meet(crossing, first);
    node->bend[1] = meet(crossing, second);
    node->sigma = sigma_of(crossing);
    node->contrast = fminf(crossing->fit[0].contrast, crossing->fit[1].contrast);
}

/* What the bending of the lines has done to the fit. */
static vec2_t bent_by(opms_grid_detector_t *d, const lattice_node_t *node, int i, int j)
{
    const vec2_t none = {0.f, 0.f};
    const vec2_t one = vec2_add(none, node->bend[0], curvature(d, i, j, 0));
    const vec2_t both = vec2_add(one, node->bend[1], curvature(d, i, j, 1));
    return vec2_length(both) < 1.f ? both : none;
}

void straighten_nodes(opms_grid_detector_t *d)
{
    /* All from where they are before any is moved; some in the queue were dropped since. */
    for (int k = 0; k < d->queue_in; ++k) {
        const int i = d->queue[k] % LATTICE, j = d->queue[k] / LATTICE;
        lattice_node_t *node = node_at(d, i, j);
        if (node) {
            node->bend[0] = bent_by(d, node, i, j);
        }
    }
    for (int k = 0; k < d->queue_in; ++k) {
        lattice_node_t *node = node_at(d, d->queue[k] % LATTICE, d->queue[k] / LATTICE);
        if (node) {
            node->at = vec2_add(node->at, node->bend[0], -1.f);
        }
    }
}

/* Nodes that could not be measured, or whose lines are too faint for this picture's. */
static void drop_unfit(opms_grid_detector_t *d)
{
    for (int k = 0; k < d->queue_in; ++k) {
        lattice_node_t *node = &d->lattice[d->queue[k]];
        if (!(node->sigma > 0.f) || node->contrast < CONTRAST_LEAST * d->contrast) {
            node->state = NODE_UNKNOWN;
            --d->found;
        }
    }
}

void fit_nodes(opms_grid_detector_t *d)
{
    float noises[SAMPLES], contrasts[SAMPLES];
    int count = 0;
    const int every = d->queue_in / SAMPLES + 1;
    estimate_blur(d);
    d->rows = d->blur < BLUR_LARGE ? ROWS_USUAL : ROWS_MANY;
    for (int k = 0; k < d->queue_in; ++k) {
        const int i = d->queue[k] % LATTICE, j = d->queue[k] / LATTICE;
        lattice_node_t *node = node_at(d, i, j);
        crossing_t crossing;
        if (!fit_node(d, i, j, node->arms, &crossing)) {
            continue;
        }
        keep_fit(node, &crossing);
        if (k % every == 0 && count < SAMPLES) {
            noises[count] = 0.5f * (crossing.fit[0].noise + crossing.fit[1].noise);
            contrasts[count++] = node->contrast;
        }
    }
    d->noise = count > 0 ? median_of(noises, count) : 0.f;
    d->contrast = count > 0 ? median_of(contrasts, count) : 0.f;
    drop_unfit(d);
}

void refit_node(opms_grid_detector_t *d, int i, int j, unsigned without_arms)
{
    lattice_node_t *node = node_at(d, i, j);
    crossing_t crossing;
    if (node && fit_node(d, i, j, node->arms & ~without_arms, &crossing)) {
        keep_fit(node, &crossing);
    }
}
