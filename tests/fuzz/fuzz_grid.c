/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as a picture of any size: whatever is seen in them, what comes out keeps the promises
 * of opms/grid.h, and a second call gives the same. What was found is then relabelled from itself.
 *
 * The first bytes set up the call (struct setup), the others are the pixels, over and over again
 * until the picture is full. make_grid_corpus.py writes seeds of this form. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <opms/grid.h>

#include "fuzz_picture.h"

/* All of one byte, so that a fuzzer's change of a byte is a change of one thing. */
struct setup {
    uint8_t width, height; /* less one */
    uint8_t flags;         /* enum flag */
    uint8_t min_pitch;     /* px */
    uint8_t padding;       /* bytes after each row */
    int8_t shift[2];       /* of the labels before they are sought again */
    uint8_t turn;          /* quarters */
};

enum flag { FLAG_16_BIT = 1, FLAG_WHITE_LEVEL = 2, FLAG_OTHER_SIZE = 4 };

static opms_node_t first[OPMS_GRID_NODES_MAX], second[OPMS_GRID_NODES_MAX];

static void check_summary(const opms_grid_summary_t *summary, uint32_t count)
{
    require(summary->state == OPMS_GRID_ABSENT || summary->state == OPMS_GRID_LABELLED ||
            summary->state == OPMS_GRID_UNLABELLED);
    require(summary->node_count == count && count <= OPMS_GRID_NODES_MAX);
    require((summary->state == OPMS_GRID_ABSENT) == (count == 0));
    require(isfinite(summary->noise) && isfinite(summary->contrast));
    require(isfinite(summary->blur_px) && isfinite(summary->marker_margin));
}

/* Each label once, in the order that is promised, and where the picture is. */
static void check_nodes(const opms_grid_summary_t *summary, const opms_node_t *nodes,
                        const opms_image_t *image)
{
    for (uint32_t i = 0; i < summary->node_count; ++i) {
        const opms_node_t *node = &nodes[i];
        require(isfinite(node->px[0]) && isfinite(node->px[1]));
        require(node->px[0] > -1.0 && node->px[0] < image->width_px);
        require(node->px[1] > -1.0 && node->px[1] < image->height_px);
        require(isfinite(node->sigma_px) && node->sigma_px > 0.0);
        if (i > 0) {
            const opms_node_t *before = &nodes[i - 1];
            require(node->label[1] > before->label[1] ||
                    (node->label[1] == before->label[1] && node->label[0] > before->label[0]));
        }
        if (summary->state == OPMS_GRID_LABELLED) {
            require(abs(node->label[0] - OPMS_GRID_CENTRE) <= OPMS_GRID_NODES_X / 2);
            require(abs(node->label[1] - OPMS_GRID_CENTRE) <= OPMS_GRID_NODES_Y / 2);
        }
    }
}

static uint32_t copy_nodes(const opms_grid_detector_t *detector, opms_node_t *nodes)
{
    uint32_t count = 0;
    const opms_node_t *found = opms_grid_nodes(detector, &count);
    require(count <= OPMS_GRID_NODES_MAX);
    if (count > 0) {
        memcpy(nodes, found, count * sizeof *nodes);
    }
    return count;
}

/* Labels that were moved and turned come back, or it is said that they are not certain. */
static void relabel(const struct setup *setup, uint32_t count)
{
    uint32_t certain = 7;
    for (uint32_t i = 0; i < count; ++i) {
        int32_t x = first[i].label[0], y = first[i].label[1];
        for (int quarter = setup->turn % 4; quarter > 0; --quarter) {
            const int32_t turned = -y;
            y = x;
            x = turned;
        }
        second[i].label[0] = x + setup->shift[0];
        second[i].label[1] = y + setup->shift[1];
    }
    require(opms_grid_relabel(first, count, second, count, &certain, NULL) == OPMS_OK);
    require(certain <= 1);
    for (uint32_t i = 0; certain && i < count; ++i) {
        require(second[i].label[0] == first[i].label[0]);
        require(second[i].label[1] == first[i].label[1]);
    }
}

static void detect_twice(opms_grid_detector_t *detector, const struct setup *setup,
                         const opms_image_t *image)
{
    opms_grid_summary_t summary, again;
    require(opms_grid_detect(detector, image, &summary, NULL) == OPMS_OK);
    const uint32_t count = copy_nodes(detector, first);
    check_summary(&summary, count);
    check_nodes(&summary, first, image);
    require(opms_grid_detect(detector, image, &again, NULL) == OPMS_OK);
    require(copy_nodes(detector, second) == count);
    require(memcmp(first, second, count * sizeof *first) == 0);
    if (count > 0) {
        relabel(setup, count);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct setup setup;
    opms_image_t image;
    opms_grid_options_t options;
    opms_grid_detector_t *detector = NULL;
    if (size < sizeof setup) {
        return 0;
    }
    memcpy(&setup, data, sizeof setup);
    opms_grid_options_init(&options);
    options.width_px = setup.width + 1;
    options.height_px = setup.height + 1;
    options.min_pitch_px = setup.min_pitch;
    if (opms_grid_detector_create(&options, &detector, NULL) != OPMS_OK) {
        return 0;
    }
    const struct fuzz_picture picture = {setup.width, setup.height, setup.padding,
                                         setup.flags & FLAG_16_BIT,
                                         setup.flags & FLAG_WHITE_LEVEL};
    void *pixels = make_pixels(&picture, data + sizeof setup, size - sizeof setup, &image);
    if (setup.flags & FLAG_OTHER_SIZE) {
        opms_grid_summary_t summary;
        --image.width_px;
        require(opms_grid_detect(detector, &image, &summary, NULL) == OPMS_ERR_ARG);
    } else {
        detect_twice(detector, &setup, &image);
    }
    free(pixels);
    opms_grid_detector_destroy(detector);
    return 0;
}
