/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Overlay pictures: what was found, drawn over the picture, to be judged at a glance
 * (docs/locate.md says how to read them). */
#ifndef OPMS_CLI_OVERLAY_HPP
#define OPMS_CLI_OVERLAY_HPP

#include <memory>
#include <set>
#include <string>

#include <opencv2/core.hpp>

#include "locate_run.hpp"

/** All that an overlay is drawn from. */
struct OverlayScene {
    const cv::Mat &picture; /**< as picture_read() gave it */
    const opms_camera_t &camera;
    const LocateResult &result;
    uint16_t white_level;
};

/** Draw an overlay: 8 bit BGR, the picture enlarged and a panel at its right. */
cv::Mat overlay_draw(const OverlayScene &scene);

/** The folder that overlays go to, one PNG for each picture. */
class OverlayFolder {
public:
    /** Make the folder where it is missing and see that it can be written to.
     * @return NULL with @p error on failure. */
    static std::unique_ptr<OverlayFolder> open(const std::string &path, std::string &error);

    /** Draw and write STEM.overlay.png (STEM-2.overlay.png for a second picture of that name). */
    bool write(const OverlayScene &scene, std::string &error);

private:
    explicit OverlayFolder(const std::string &path) : path_(path) {}
    std::string file_for(const std::string &image);
    std::string path_;
    std::set<std::string> used_;
};

#endif
