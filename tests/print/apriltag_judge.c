/* SPDX-License-Identifier: Apache-2.0 */
/* An outside judge of the printed bar of AprilTags: libapriltag's own detector.
 *
 * Reads the grey bytes of a picture from stdin, prints one line a tag of family 36h11: its id, the
 * number of corrected bits, and the corners (u, v) top left, top right, bottom right, bottom left
 * as
 * the tag stands upright, pixels from the upper left corner of the picture. */
#include <stdio.h>
#include <stdlib.h>

#include <apriltag.h>
#include <common/image_u8.h>
#include <common/zarray.h>
#include <tag36h11.h>

static void print_tags(const zarray_t *tags)
{
    static const int upright[4] = {3, 2, 1, 0}; /* libapriltag begins bottom left, then right */
    for (int i = 0; i < zarray_size(tags); ++i) {
        apriltag_detection_t *tag;
        zarray_get(tags, i, &tag);
        printf("%d %d", tag->id, tag->hamming);
        for (int corner = 0; corner < 4; ++corner) {
            const double *p = tag->p[upright[corner]];
            printf(" %.3f %.3f", p[0], p[1]);
        }
        printf("\n");
    }
}

static void judge(image_u8_t *picture)
{
    apriltag_family_t *family = tag36h11_create();
    apriltag_detector_t *detector = apriltag_detector_create();
    apriltag_detector_add_family(detector, family);
    detector->quad_decimate = 1.0f;
    zarray_t *tags = apriltag_detector_detect(detector, picture);
    print_tags(tags);
    apriltag_detections_destroy(tags);
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
}

int main(int argc, char **argv)
{
    const int width = argc == 3 ? atoi(argv[1]) : 0;
    const int height = argc == 3 ? atoi(argv[2]) : 0;
    if (width < 1 || height < 1 || width > 65535 || height > 65535) {
        fprintf(stderr, "usage: apriltag_judge WIDTH HEIGHT < PIXELS\n");
        return 2;
    }
    const size_t size = (size_t)width * (size_t)height;
    uint8_t *pixels = malloc(size);
    if (!pixels || fread(pixels, 1, size, stdin) != size) {
        fprintf(stderr, "apriltag_judge: too few pixels\n");
        free(pixels);
        return 4;
    }
    image_u8_t picture = {.width = width, .height = height, .stride = width, .buf = pixels};
    judge(&picture);
    free(pixels);
    return 0;
}
