/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Locates the pictures of a scan once more, or solves once more from its reference points. */
#ifndef OPMS_CLI_REPLAY_LOCATOR_HPP
#define OPMS_CLI_REPLAY_LOCATOR_HPP

#include <memory>
#include <string>

#include "scan_records.hpp"

class ReplayLocator {
public:
    virtual ~ReplayLocator() = default;
    /** What the live system did with this picture: with the same hint, without one if it had none.
     * @param[in,out] again  Gets the location, squares, edges and residuals. False with @p error.
     */
    virtual bool from_picture(const std::string &path, const opms_host::FrameRecord &frame,
                              const opms_host::PoseRecord &recorded,
                              opms_host::PoseRecord &again, std::string &error) = 0;
    /** From the recorded edges. False with @p error. */
    virtual bool from_points(const opms_host::PoseRecord &recorded, opms_host::PoseRecord &again,
                             std::string &error) = 0;

    /** @return NULL with @p error where the bar or the camera cannot be used. */
    static std::unique_ptr<ReplayLocator> create(const opms_camera_t &camera,
                                                 const opms_host::ScanHeader &header,
                                                 std::string &error);
};

#endif
