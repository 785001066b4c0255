/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What a scan holds, as JSON messages of the schemas in foxglove_schemas.hpp. */
#ifndef OPMS_EXPORTING_FOXGLOVE_MESSAGES_HPP
#define OPMS_EXPORTING_FOXGLOVE_MESSAGES_HPP

#include <cstdint>
#include <string>

#include <opms/types.h>

#include "scan_records.hpp"

namespace opms_host {

/** @param t_ns  Since 1970 UTC. */
std::string message_pose_in_frame(std::uint64_t t_ns, const char *frame,
                                  const opms_transform_t &pose);
std::string message_frame_transform(std::uint64_t t_ns, const char *parent, const char *child,
                                    const opms_transform_t &pose);
/** @param png  The file's bytes. */
std::string message_compressed_image(std::uint64_t t_ns, const std::string &png);
std::string message_camera_calibration(std::uint64_t t_ns, const opms_lens_t &lens);
std::string message_log(std::uint64_t t_ns, const EventRecord &event);
std::string message_sensor(std::uint64_t t_ns, const SensorRecord &sample);

}  // namespace opms_host
#endif
