/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Text of YAML values, the same on every machine and in every locale. */
#ifndef OPMS_HOST_YAML_TEXT_HPP
#define OPMS_HOST_YAML_TEXT_HPP

#include <cstddef>
#include <string>

#include <yaml-cpp/yaml.h>

namespace opms_host {

/** 17 digits: reading it gives the same bits. Always with a point, which YAML 1.1 needs to see a
 * number in "1.0e-05". */
std::string yaml_number(double value);

/** "[1.0, 2.0]". */
std::string yaml_numbers(const double *values, std::size_t count);

/** A text in double quotes. */
std::string yaml_quoted(const std::string &text);

/** Any value on one line, in flow style. What is quoted stays so: "007" is no number. */
std::string yaml_flow(const YAML::Node &node);

}  // namespace opms_host
#endif
