/* SPDX-License-Identifier: Apache-2.0 */
/* From pictures to the detector's pose: example_locate TILT_DEG PICTURE.pgm...
 *
 * TILT_DEG is how far the bar's printed face is turned away from the operator, 0 for a flat bar.
 * The pictures are a sequence: each pose is the hint for the next picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <opms/locate.h>

#include "example_camera.h"
#include "example_pgm.h"

static void print_location(const char *name, const opms_location_t *location)
{
    static const char *const states[] = {"absent", "located", "ambiguous"};
    printf("%s: %s", name, states[location->state]);
    if (location->state == OPMS_BAR_LOCATED) {
        const opms_pose_t *pose = &location->ground_detector;
        printf(", %u squares, detector at", location->bar.square_count);
        for (int i = 0; i < 3; ++i) {
            printf(" %.2f +- %.2f", 1e3 * pose->transform.t_m[i],
                   1e3 * sqrt(pose->covariance[7 * (3 + i)]));
        }
        printf(" mm");
    }
    printf("\n");
}

int main(int argc, char **argv)
{
    const opms_camera_t camera = example_camera();
    opms_locator_options_t options;
    opms_locator_t *locator = NULL;
    opms_transform_t last;
    const opms_transform_t *hint = NULL;
    opms_error_t err;
    int failures = 0;

    if (argc < 3) {
        fprintf(stderr, "usage: example_locate TILT_DEG PICTURE.pgm...\n");
        return 2;
    }
    opms_locator_options_init(&options);
    options.bar_tilt_rad = atof(argv[1]) * 0.017453292519943295;
    if (opms_locator_create(&camera, &options, &locator, &err) != OPMS_OK) {
        fprintf(stderr, "%s: %s\n", err.stage, err.message);
        return 1;
    }
    for (int i = 2; i < argc; ++i) {
        opms_image_t image;
        opms_location_t location;
        if (example_pgm_read(argv[i], &image) != 0) {
            ++failures;
            continue;
        }
        if (opms_locator_locate(locator, &image, NULL, hint, &location, &err) == OPMS_OK) {
            print_location(argv[i], &location);
            last = location.pose.bar_camera.transform;
            hint = location.state == OPMS_BAR_LOCATED ? &last : NULL;
        } else {
            fprintf(stderr, "%s: %s: %s\n", argv[i], err.stage, err.message);
            ++failures;
        }
        free((void *)image.pixels);
    }
    opms_locator_destroy(locator);
    return failures == 0 ? 0 : 1;
}
