/* SPDX-License-Identifier: Apache-2.0 */
/* Real pictures that nobody of this project took: OpenCV's calibration pictures, with the corners
 * that OpenCV found and what its calibrateCamera makes of them (tests/data/chessboard). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <unity.h>

#include <opms/calib.h>

#include "../truth_chi2.h"
#include "../truth_project.h"

#define PICTURES_MAX 20
#define CORNERS_MAX 100
/* What a corner may be off by; the stated covariance follows the residuals, not this. */
#define SIGMA_PX 0.15

typedef struct board_list {
    int32_t width_px, height_px;
    double lens[8], rms_px; /* OpenCV's */
    uint32_t pictures, corners;
    opms_calib_point_t points[PICTURES_MAX][CORNERS_MAX];
} board_list_t;

static board_list_t list;
static opms_calib_result_t result;
static opms_error_t err;

void setUp(void)
{
    memset(&list, 0, sizeof list);
    memset(&result, 0, sizeof result);
    memset(&err, 0, sizeof err);
}

void tearDown(void)
{
}

static void read_head(FILE *file)
{
    char line[256];
    do {
        TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    } while (line[0] == '#');
    TEST_ASSERT_EQUAL(2, sscanf(line, "size %d %d", &list.width_px, &list.height_px));
}

static void read_opencv(FILE *file)
{
    TEST_ASSERT_EQUAL(0, fscanf(file, "opencv"));
    for (int i = 0; i < 8; ++i)
        TEST_ASSERT_EQUAL(1, fscanf(file, "%lf", &list.lens[i]));
    TEST_ASSERT_EQUAL(1, fscanf(file, "%lf ", &list.rms_px));
}

static void read_corners(FILE *file, int columns, double square_m)
{
    opms_calib_point_t *points = list.points[list.pictures++];
    for (int i = 0; i < (int)list.corners; ++i) {
        points[i].target_m[0] = square_m * (i % columns);
        points[i].target_m[1] = square_m * (i / columns);
        points[i].sigma_px = SIGMA_PX;
        TEST_ASSERT_EQUAL(2, fscanf(file, "%lf %lf ", &points[i].px[0], &points[i].px[1]));
    }
}

static void read_list(const char *name)
{
    const char *folder = getenv("OPMS_TEST_DATA");
    char path[1024], picture[32];
    int columns = 0, rows = 0;
    double square_m = 0.0;
    TEST_ASSERT_NOT_NULL_MESSAGE(folder, "OPMS_TEST_DATA names the folder tests/data");
    snprintf(path, sizeof path, "%s/chessboard/%s", folder, name);
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    read_head(file);
    TEST_ASSERT_EQUAL(3, fscanf(file, "board %d %d %lf ", &columns, &rows, &square_m));
    list.corners = (uint32_t)(columns * rows);
    TEST_ASSERT_TRUE(list.corners <= CORNERS_MAX);
    read_opencv(file);
    while (list.pictures < PICTURES_MAX && fscanf(file, "picture %31s ", picture) == 1)
        read_corners(file, columns, square_m);
    TEST_ASSERT_TRUE_MESSAGE(feof(file), path);
    fclose(file);
}

static opms_calibrator_t *solve(void)
{
    opms_calib_options_t options;
    opms_calibrator_t *calibrator = NULL;
    opms_calib_options_init(&options);
    options.width_px = list.width_px;
    options.height_px = list.height_px;
    TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_create(&options, &calibrator, &err));
    for (uint32_t k = 0; k < list.pictures; ++k)
        TEST_ASSERT_EQUAL(OPMS_OK, opms_calibrator_add(calibrator, list.points[k], list.corners,
                                                       NULL, &err));
    TEST_ASSERT_EQUAL_MESSAGE(OPMS_OK, opms_calibrator_solve(calibrator, &result, &err),
                              err.message);
    return calibrator;
}

/* RMS length of the residuals of all corners, those that count less included. */
static double rms_of_all_px(const opms_calibrator_t *calibrator)
{
    double sum = 0.0, residuals[2 * CORNERS_MAX];
    for (uint32_t k = 0; k < list.pictures; ++k) {
        TEST_ASSERT_EQUAL(OPMS_OK,
                          opms_calibrator_residuals(calibrator, k, residuals, NULL, &err));
        for (uint32_t i = 0; i < 2 * list.corners; ++i)
            sum += residuals[i] * residuals[i];
    }
    return sqrt(sum / (list.pictures * list.corners));
}

static void agrees_with_opencv(const char *name)
{
    double off[8];
    read_list(name);
    TEST_ASSERT_EQUAL_UINT32(13, list.pictures);
    opms_calibrator_t *calibrator = solve();
    for (int i = 0; i < 8; ++i)
        off[i] = *truth_intrinsic(&result.lens, i) - list.lens[i];
    const double chi2 = truth_chi2(result.covariance, 8, off, 8);
    const double all_px = rms_of_all_px(calibrator);
    printf("%s: chi2 to OpenCV %.3f, RMS %.4f px (all corners %.4f), OpenCV's %.4f, %u outliers\n",
           name, chi2, result.residual_rms_px, all_px, list.rms_px, result.outliers);
    TEST_ASSERT_EQUAL_UINT32(list.pictures, result.pictures_used);
    TEST_ASSERT_EQUAL_UINT32(list.pictures * list.corners, result.points_used + result.outliers);
    /* Same corners, same noise: much nearer than two independent calibrations would be (15.5). */
    TEST_ASSERT_TRUE(chi2 < 2.0);
    for (int i = 0; i < 2; ++i) /* and no wonder of a covariance that allows everything */
        TEST_ASSERT_TRUE(sqrt(result.covariance[9 * i]) < 0.003 * list.lens[i]);
    /* OpenCV's is the least there is over all corners; that of a robust solution is hardly more,
     * and over the corners that agree the same or less. */
    TEST_ASSERT_TRUE(all_px < 1.005 * list.rms_px);
    TEST_ASSERT_TRUE(result.residual_rms_px < 1.002 * list.rms_px);
    opms_calibrator_destroy(calibrator);
}

static void the_left_camera_agrees_with_opencv(void)
{
    agrees_with_opencv("left.txt");
}

static void the_right_camera_agrees_with_opencv(void)
{
    agrees_with_opencv("right.txt");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_left_camera_agrees_with_opencv);
    RUN_TEST(the_right_camera_agrees_with_opencv);
    return UNITY_END();
}
