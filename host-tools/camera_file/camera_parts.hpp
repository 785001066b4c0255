/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Parts of the camera file's readers and writers, one a format; all throw FieldError or
 * YAML::Exception. */
#ifndef OPMS_HOST_CAMERA_PARTS_HPP
#define OPMS_HOST_CAMERA_PARTS_HPP

#include <string>
#include <vector>

#include "camera_file.hpp"
#include "yaml_fields.hpp"

namespace opms_host {

/** A message may quote what the file says: one line, short, and harmless to a terminal. */
std::string camera_one_line(const std::string &message);

/** Keys that the programs write themselves; all others are extras. */
bool camera_root_key(const std::string &name);
bool camera_opms_key(const std::string &name);

/** fx 0 cx, 0 fy cy, 0 0 1. */
void camera_read_matrix(const Field &data, const std::vector<double> &k, opms_lens_t &lens);

/** k1 k2 p1 p2, then OpenCV's k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y, which must be 0. */
void camera_read_distortion(const Field &data, const std::vector<double> &d, opms_lens_t &lens);

/** The mapping `opms` of @p parent, if it is there. */
void camera_read_opms(const FieldMap &parent, CameraFile &file);

/** What is none of ours in the mapping that holds the lens. */
void camera_read_extras(const YAML::Node &map, bool (*ours)(const std::string &),
                        std::vector<CameraExtra> &extras);

bool camera_is_kalibr(const FieldMap &root);
bool camera_is_opencv(const FieldMap &root);
void camera_read_kalibr(const FieldMap &root, const std::string &which, CameraFile &file);
void camera_read_opencv(const YAML::Node &document, const FieldMap &root, CameraFile &file);
void camera_read_ros(const YAML::Node &document, const FieldMap &root, CameraFile &file);

/** OpenCV's XML storage as the tree that its YAML would give. */
YAML::Node camera_load_xml(const std::string &text);

/** The value of a quoted scalar that stays one. */
YAML::Node camera_text_node(const std::string &text);

/** All that the mapping `opms` holds, in the order in which it is written. */
YAML::Node camera_opms_node(const CameraFile &file);

/** The file in a format; what that format cannot hold is told in @p notes. */
std::string camera_ros_text(const CameraFile &file);
std::string camera_kalibr_text(const CameraFile &file);
std::string camera_opencv_yaml_text(const CameraFile &file, std::vector<std::string> &notes);
std::string camera_opencv_xml_text(const CameraFile &file, std::vector<std::string> &notes);

}  // namespace opms_host
#endif
