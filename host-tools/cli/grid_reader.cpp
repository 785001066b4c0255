/* SPDX-License-Identifier: Apache-2.0 */
#include "grid_reader.hpp"

#include "picture_file.hpp"

const char *GridPicture::state_name() const
{
    if (!reason.empty()) {
        return "error";
    }
    switch (summary.state) {
    case OPMS_GRID_LABELLED:
        return "labelled";
    case OPMS_GRID_UNLABELLED:
        return "unlabelled";
    case OPMS_GRID_ABSENT:
        break;
    }
    return "absent";
}

bool GridPicture::labelled() const
{
    return reason.empty() && summary.state == OPMS_GRID_LABELLED;
}

bool GridReader::fit_detector(GridPicture &picture)
{
    if (detector_ && width_px_ == picture.width_px && height_px_ == picture.height_px) {
        return true;
    }
    detector_.reset();
    opms_grid_options_t options;
    opms_grid_options_init(&options);
    options.width_px = picture.width_px;
    options.height_px = picture.height_px;
    opms_grid_detector_t *detector = nullptr;
    opms_error_t error = {};
    if (opms_grid_detector_create(&options, &detector, &error) != OPMS_OK) {
        picture.reason = error.message;
        return false;
    }
    detector_.reset(detector);
    width_px_ = picture.width_px;
    height_px_ = picture.height_px;
    return true;
}

GridPicture GridReader::read(const std::string &image)
{
    GridPicture picture;
    picture.image = image;
    const cv::Mat pixels = picture_read_any(image, picture.reason);
    if (pixels.empty()) {
        return picture;
    }
    picture.width_px = pixels.cols;
    picture.height_px = pixels.rows;
    picture.colour = pixels.channels() > 1;
    if (!fit_detector(picture)) {
        return picture;
    }
    const cv::Mat grey = picture_grey(pixels);
    const opms_image_t view = picture_view(grey, white_level_);
    opms_error_t error = {};
    if (opms_grid_detect(detector_.get(), &view, &picture.summary, &error) != OPMS_OK) {
        picture.reason = error.message;
        return picture;
    }
    uint32_t count = 0;
    const opms_node_t *nodes = opms_grid_nodes(detector_.get(), &count);
    picture.nodes.assign(nodes, nodes + count);
    return picture;
}
