/* SPDX-License-Identifier: Apache-2.0 */
/* An outside judge of the printed bar of AprilTags: libapriltag's own detector.
 *
 * Reads a binary PGM from the file named, prints one line a tag of family 36h11: its id, the number
 * of corrected bits, and the corners (u, v) top left, top right, bottom right, bottom left as the
 * tag stands upright, pixels from the upper left corner of the picture. */
#include <stdio.h>

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

int main(int argc, char **argv)
{
    image_u8_t *picture = argc == 2 ? image_u8_create_from_pnm(argv[1]) : NULL;
    if (!picture) {
        fprintf(stderr, "usage: apriltag_judge PICTURE.pgm\n");
        return 2;
    }
    apriltag_family_t *family = tag36h11_create();
    apriltag_detector_t *detector = apriltag_detector_create();
    apriltag_detector_add_family(detector, family);
    detector->quad_decimate = 1.0f;
    zarray_t *tags = apriltag_detector_detect(detector, picture);
    print_tags(tags);
    apriltag_detections_destroy(tags);
    apriltag_detector_destroy(detector);
    tag36h11_destroy(family);
    image_u8_destroy(picture);
    return 0;
}
