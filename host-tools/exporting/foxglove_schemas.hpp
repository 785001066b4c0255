/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * JSON schemas of the messages in an exported MCAP file. Those named foxglove.* describe the fields
 * of Foxglove's schemas of these names, which its panels know; opms.* are the project's own rows.
 */
#ifndef OPMS_EXPORTING_FOXGLOVE_SCHEMAS_HPP
#define OPMS_EXPORTING_FOXGLOVE_SCHEMAS_HPP

#include "mcap_writer.hpp"

namespace opms_host {

McapSchema schema_pose_in_frame();
McapSchema schema_frame_transform();
McapSchema schema_compressed_image();
McapSchema schema_camera_calibration();
McapSchema schema_log();
/** opms.pose/1: all that is known of one picture, covariances and times included. */
McapSchema schema_opms_pose();
/** opms.sensor/1: a sample of another sensor. */
McapSchema schema_opms_sensor();

}  // namespace opms_host
#endif
