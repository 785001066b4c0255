/* SPDX-License-Identifier: Apache-2.0 */
/* Stands in where OpenCV's videoio was not there when this program was built. */
#include "preview_source.hpp"

namespace opms_host {

std::unique_ptr<FrameSource> open_preview_source(int, std::shared_ptr<HostClock>,
                                                 std::string &error)
{
    error = "this program was built without OpenCV's videoio: no preview";
    return nullptr;
}

}  // namespace opms_host
