/* SPDX-License-Identifier: Apache-2.0 */
#include <sstream>

#include "aravis_source.hpp"

namespace opms_host {

bool aravis_place_parse(const std::string &text, AravisPlace &place, std::string &error)
{
    place = AravisPlace();
    std::istringstream parts(text);
    std::getline(parts, place.name, ',');
    for (std::string option; std::getline(parts, option, ',');) {
        const std::size_t equals = option.find('=');
        const std::string key = option.substr(0, equals);
        const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
        if (key == "trigger" && !value.empty()) {
            place.trigger = value;
        } else if (key == "format" && (value == "Mono8" || value == "Mono10" ||
                                       value == "Mono12" || value == "Mono16")) {
            place.format = value;
        } else {
            error = option + " is no option of a GenICam camera; give trigger=LINE or "
                             "format=Mono8, Mono10, Mono12 or Mono16";
            return false;
        }
    }
    return true;
}

}  // namespace opms_host
