/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * The calls of the interface, one function each; ApiHandler finds the right one. */
#ifndef OPMS_CONSOLE_API_CALLS_HPP
#define OPMS_CONSOLE_API_CALLS_HPP

#include <nlohmann/json.hpp>

#include "api_handler.hpp"

namespace opms_host {

/** A request that was found good so far. */
struct ApiCall {
    const ApiContext &context;
    const HttpRequest &request;
    const HttpTarget &target;
    std::string name;     /**< the path's last part, of /scans/{name} */
    nlohmann::json body;  /**< null where the call takes none */
};

HttpResponse api_version(const ApiCall &call);
HttpResponse api_state(const ApiCall &call);
HttpResponse api_pose(const ApiCall &call);
HttpResponse api_picture(const ApiCall &call);
HttpResponse api_scan_start(const ApiCall &call);
HttpResponse api_scan_stop(const ApiCall &call);
HttpResponse api_press_start(const ApiCall &call);
HttpResponse api_scans(const ApiCall &call);
HttpResponse api_scan(const ApiCall &call);
HttpResponse api_samples(const ApiCall &call);

HttpResponse api_json(int status, const nlohmann::ordered_json &json);
HttpResponse api_failure(const ControlError &error);

/** Parse, place and hand over. @return The failure, or kind none and how many. */
ControlError api_take_samples(const ApiContext &context, const nlohmann::json &json,
                              std::size_t &taken);

}  // namespace opms_host
#endif
