/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * All of libopms, in data-flow order. */
#ifndef OPMS_OPMS_H
#define OPMS_OPMS_H

#include <opms/version.h>
#include <opms/status.h>
#include <opms/types.h>
#include <opms/wire.h>
#include <opms/clock.h>
#include <opms/pair.h>
#include <opms/lens.h>
#include <opms/bar.h>
#include <opms/exposure.h>
#include <opms/blur.h>
#include <opms/pose.h>
#include <opms/locate.h>
#include <opms/grid.h>
#include <opms/calib.h>
#include <opms/expect.h>

#endif
