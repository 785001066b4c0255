/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a camera file says, for people and for programs. */
#ifndef OPMS_CLI_CAMERA_SHOW_HPP
#define OPMS_CLI_CAMERA_SHOW_HPP

#include <string>
#include <vector>

#include "camera_file.hpp"

/** Names of formats as `opms camera convert --to` takes them. */
const char *camera_format_name(opms_host::CameraFormat format);

/** A part that is not there, and what that means. */
struct CameraGap {
    const char *key, *meaning;
};

std::vector<CameraGap> camera_gaps(const opms_camera_t &camera);

/** Angles in sight between the middles of opposite borders, and between corners, in degrees. */
struct CameraView {
    double across_deg = 0, down_deg = 0, diagonal_deg = 0;
};

CameraView camera_view(const opms_lens_t &lens);

/** Lines for people. */
std::string camera_show_text(const std::string &path, const opms_host::CameraFile &file);

/** One object of schema opms.camera/1. */
std::string camera_show_json(const std::string &path, const opms_host::CameraFile &file);

#endif
