/* SPDX-License-Identifier: Apache-2.0 */
/* Times opms_locator_locate() from outside, and prints what it found.
 *
 *   bench_locate REPEATS FOLLOW < scene
 *
 * scene: one line "width height fx fy cx cy k1 k2 p1 p2 tilt_rad", then the path of a raw 8-bit
 * picture a line. All pictures are in memory before the first call. One JSON object a picture:
 * its pose, and the times of its calls in us: cold (another picture every call), warm (the same
 * again), and with FOLLOW 1 those where the pose of the picture before is given as a hint. */
#define _POSIX_C_SOURCE 200809L

#include <opms/opms.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MAX_PICTURES = 4096, MAX_REPEATS = 1000, PATH_BYTES = 4096 };

typedef struct bench {
    opms_lens_t lens;
    double tilt_rad;
    unsigned char *pixels[MAX_PICTURES];
    int count;
    int repeats;
    opms_locator_t *locator;
    double *times_us; /* count x repeats */
} bench_t;

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "bench_locate: %s: %s\n", what, why);
    return 4;
}

static int read_lens(bench_t *bench)
{
    opms_lens_t *lens = &bench->lens;
    int got = scanf("%d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf ", &lens->width_px, &lens->height_px,
                    &lens->fx_px, &lens->fy_px, &lens->cx_px, &lens->cy_px, &lens->k1, &lens->k2,
                    &lens->p1, &lens->p2, &bench->tilt_rad);
    return got == 11 && lens->width_px > 0 && lens->height_px > 0 ? 0
                                                                  : fail("scene", "no lens line");
}

static int read_picture(const char *path, unsigned char *pixels, size_t size)
{
    FILE *file = fopen(path, "rb");
    size_t got;

    if (!file)
        return fail(path, strerror(errno));
    got = fread(pixels, 1, size, file);
    fclose(file);
    return got == size ? 0 : fail(path, "shorter than the lens says");
}

static int read_pictures(bench_t *bench)
{
    size_t size = (size_t)bench->lens.width_px * (size_t)bench->lens.height_px;
    char path[PATH_BYTES];

    while (bench->count < MAX_PICTURES && fgets(path, sizeof path, stdin)) {
        unsigned char *pixels;

        path[strcspn(path, "\n")] = '\0';
        if (!path[0])
            continue;
        pixels = malloc(size);
        if (!pixels)
            return fail(path, "out of memory");
        bench->pixels[bench->count++] = pixels;
        if (read_picture(path, pixels, size))
            return 4;
    }
    return bench->count ? 0 : fail("scene", "no pictures");
}

static int create_locator(bench_t *bench)
{
    opms_locator_options_t options;
    opms_camera_t camera;
    opms_error_t error;

    memset(&camera, 0, sizeof camera);
    camera.lens = bench->lens;
    opms_locator_options_init(&options);
    options.bar_tilt_rad = bench->tilt_rad;
    if (opms_locator_create(&camera, &options, &bench->locator, &error))
        return fail("opms_locator_create", error.message);
    bench->times_us = calloc((size_t)bench->count * (size_t)bench->repeats, sizeof(double));
    return bench->times_us ? 0 : fail("times", "out of memory");
}

/** One timed call; the time goes to the picture's next place. */
static int locate(bench_t *bench, int picture, int repeat, const opms_transform_t *hint,
                  opms_location_t *location)
{
    opms_error_t error;
    opms_status_t status;
    opms_image_t image;
    double start;

    memset(&image, 0, sizeof image);
    image.pixels = bench->pixels[picture];
    image.width_px = bench->lens.width_px;
    image.height_px = bench->lens.height_px;
    image.stride_bytes = image.width_px;
    image.format = OPMS_PIXEL_GREY8;
    start = now_us();
    status = opms_locator_locate(bench->locator, &image, NULL, hint, location, &error);
    bench->times_us[picture * bench->repeats + repeat] = now_us() - start;
    return status ? fail("opms_locator_locate", error.message) : 0;
}

static void print_numbers(const char *name, const double *values, int count)
{
    printf(",\"%s\":[", name);
    for (int i = 0; i < count; i++)
        printf("%s%.17g", i ? "," : "", values[i]);
    printf("]");
}

static void print_row(const bench_t *bench, const char *mode, int picture,
                      const opms_location_t *location)
{
    printf("{\"mode\":\"%s\",\"picture\":%d,\"state\":%d,\"followed\":%d", mode, picture,
           (int)location->state, (int)location->followed);
    if (location->state == OPMS_BAR_LOCATED) {
        print_numbers("R", location->pose.bar_camera.transform.R, 9);
        print_numbers("t", location->pose.bar_camera.transform.t_m, 3);
        print_numbers("covariance", location->pose.bar_camera.covariance, 36);
    }
    print_numbers("us", bench->times_us + picture * bench->repeats, bench->repeats);
    printf("}\n");
}

/** Another picture every call: what is in the caches is not what is needed. */
static int run_cold(bench_t *bench)
{
    static opms_location_t last[MAX_PICTURES];

    for (int repeat = 0; repeat < bench->repeats; repeat++)
        for (int i = 0; i < bench->count; i++)
            if (locate(bench, i, repeat, NULL, &last[i]))
                return 4;
    for (int i = 0; i < bench->count; i++)
        print_row(bench, "cold", i, &last[i]);
    return 0;
}

static int run_warm(bench_t *bench)
{
    opms_location_t location;

    for (int i = 0; i < bench->count; i++) {
        if (locate(bench, i, 0, NULL, &location))
            return 4;
        for (int repeat = 0; repeat < bench->repeats; repeat++)
            if (locate(bench, i, repeat, NULL, &location))
                return 4;
        print_row(bench, "warm", i, &location);
    }
    return 0;
}

/** The pictures are a sequence; the last pose that was found is the hint. */
static int run_follow(bench_t *bench)
{
    static opms_location_t last[MAX_PICTURES];

    for (int repeat = 0; repeat < bench->repeats; repeat++) {
        const opms_transform_t *hint = NULL;

        for (int i = 0; i < bench->count; i++) {
            if (locate(bench, i, repeat, hint, &last[i]))
                return 4;
            hint = last[i].state == OPMS_BAR_LOCATED ? &last[i].pose.bar_camera.transform : NULL;
        }
    }
    for (int i = 0; i < bench->count; i++)
        print_row(bench, "follow", i, &last[i]);
    return 0;
}

static void release(bench_t *bench)
{
    opms_locator_destroy(bench->locator);
    free(bench->times_us);
    for (int i = 0; i < bench->count; i++)
        free(bench->pixels[i]);
}

int main(int argc, char **argv)
{
    static bench_t bench;
    int status;

    bench.repeats = argc == 3 ? atoi(argv[1]) : 0;
    if (bench.repeats < 1 || bench.repeats > MAX_REPEATS) {
        fprintf(stderr, "usage: bench_locate REPEATS FOLLOW < scene\n");
        return 2;
    }
    status = read_lens(&bench);
    if (!status)
        status = read_pictures(&bench);
    if (!status)
        status = create_locator(&bench);
    if (!status)
        status = run_cold(&bench);
    if (!status)
        status = run_warm(&bench);
    if (!status && atoi(argv[2]))
        status = run_follow(&bench);
    release(&bench);
    return status;
}
