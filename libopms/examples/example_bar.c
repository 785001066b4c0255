/* SPDX-License-Identifier: Apache-2.0 */
/* From a picture to the labelled squares of the bar: example_bar PICTURE.pgm */
#include <stdio.h>
#include <stdlib.h>

#include <opms/bar.h>

#include "example_camera.h"
#include "example_pgm.h"

static void print_squares(const opms_bar_detector_t *detector)
{
    uint32_t count;
    const opms_square_t *squares = opms_bar_squares(detector, &count);
    for (uint32_t i = 0; i < count; ++i) {
        double u = 0.0, v = 0.0;
        for (int c = 0; c < 4; ++c) {
            u += 0.25 * squares[i].corners_px[c][0];
            v += 0.25 * squares[i].corners_px[c][1];
        }
        printf("square %2d near pixel (%6.1f, %6.1f), %u edges measured\n", squares[i].index, u, v,
               squares[i].edges);
    }
}

int main(int argc, char **argv)
{
    static const char *const states[] = {"absent", "located", "ambiguous"};
    const opms_camera_t camera = example_camera();
    opms_bar_detector_t *detector = NULL;
    opms_bar_summary_t summary;
    opms_image_t image;
    opms_error_t err;

    if (argc != 2 || example_pgm_read(argv[1], &image) != 0) {
        fprintf(stderr, "usage: example_bar PICTURE.pgm\n");
        return 2;
    }
    opms_status_t status = opms_bar_detector_create(&camera.lens, NULL, &detector, &err);
    if (status == OPMS_OK) {
        status = opms_bar_detect(detector, &image, NULL, NULL, &summary, &err);
    }
    if (status != OPMS_OK) {
        fprintf(stderr, "%s: %s: %s\n", argv[1], err.stage, err.message);
    } else {
        printf("the bar is %s: %u squares, %u edges\n", states[summary.state],
               summary.square_count, summary.edge_count);
        print_squares(detector);
    }
    opms_bar_detector_destroy(detector);
    free((void *)image.pixels);
    return status == OPMS_OK ? 0 : 1;
}
