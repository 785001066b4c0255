/* SPDX-License-Identifier: Apache-2.0 */
/* A program of someone else, in C11: finds the bar in a picture that it holds in memory. */
#include <stdio.h>
#include <stdlib.h>

#include <opms/opms.h>

enum { WIDTH = 320, HEIGHT = 240 };

static int fail(const char *what, const opms_error_t *error)
{
    fprintf(stderr, "%s: %s: %s\n", what, opms_status_name(error->code), error->message);
    return EXIT_FAILURE;
}

int main(void)
{
    const opms_camera_t camera = {
        .lens = {.width_px = WIDTH, .height_px = HEIGHT,
                 .fx_px = 300, .fy_px = 300, .cx_px = 159.5, .cy_px = 119.5},
    };
    static unsigned char pixels[WIDTH * HEIGHT];
    const opms_image_t image = {.pixels = pixels, .width_px = WIDTH, .height_px = HEIGHT,
                                .stride_bytes = WIDTH, .format = OPMS_PIXEL_GREY8};
    opms_error_t error;
    opms_locator_t *locator = NULL;
    if (opms_locator_create(&camera, NULL, &locator, &error) != OPMS_OK) {
        return fail("create", &error);
    }
    opms_location_t location;
    if (opms_locator_locate(locator, &image, NULL, NULL, &location, &error) != OPMS_OK) {
        opms_locator_destroy(locator);
        return fail("locate", &error);
    }
    opms_locator_destroy(locator);
    printf("libopms %s: %s\n", opms_version(),
           location.state == OPMS_BAR_ABSENT ? "no bar" : "a bar");
    return location.state == OPMS_BAR_ABSENT ? EXIT_SUCCESS : EXIT_FAILURE;
}
