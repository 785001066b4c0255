/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A reader of binary PGM pictures (P5), 8 or 16 bit; enough for the examples. */
#ifndef EXAMPLE_PGM_H
#define EXAMPLE_PGM_H

#include <opms/types.h>

/** Read a picture. @return 0, or -1 after a message on stderr. Free image->pixels after use. */
int example_pgm_read(const char *path, opms_image_t *image);

#endif
