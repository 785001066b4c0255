/* SPDX-License-Identifier: Apache-2.0 */
/* Stands in where Aravis was not there when this program was built. */
#include "aravis_source.hpp"

namespace opms_host {
namespace {

const char *const MISSING =
    "this program was built without Aravis (Debian: libaravis-dev): no GenICam cameras";

}  // namespace

std::unique_ptr<FrameSource> open_aravis_source(const AravisPlace &, bool,
                                                std::shared_ptr<HostClock>, std::string &error)
{
    error = MISSING;
    return nullptr;
}

std::vector<AravisEntry> list_aravis(std::string &problem)
{
    problem = MISSING;
    return {};
}

}  // namespace opms_host
