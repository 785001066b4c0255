/* SPDX-License-Identifier: Apache-2.0 */
/* From a point in front of the camera to its pixel, and from the pixel back to its ray. */
#include <stdio.h>

#include <opms/lens.h>

#include "example_camera.h"

int main(void)
{
    const opms_camera_t camera = example_camera();
    const double point_m[3] = {0.15, -0.10, 0.50};
    double px[2], ray[2], jac[6];
    opms_error_t err;

    if (opms_lens_check(&camera.lens, &err) != OPMS_OK ||
        opms_lens_project(&camera.lens, point_m, px, jac, NULL, &err) != OPMS_OK ||
        opms_lens_unproject(&camera.lens, px, ray, NULL, &err) != OPMS_OK) {
        fprintf(stderr, "%s: %s\n", err.stage, err.message);
        return 1;
    }
    printf("point (%.3f, %.3f, %.3f) m is at pixel (%.3f, %.3f)\n", point_m[0], point_m[1],
           point_m[2], px[0], px[1]);
    printf("a millimetre to the right moves it by %.3f px\n", 1e-3 * jac[0]);
    printf("the pixel's ray is (%.6f, %.6f, 1)\n", ray[0], ray[1]);
    return 0;
}
