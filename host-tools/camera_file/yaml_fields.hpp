/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * Typed access to the fields of a YAML mapping; every failure names the field and its line. */
#ifndef OPMS_HOST_YAML_FIELDS_HPP
#define OPMS_HOST_YAML_FIELDS_HPP

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace opms_host {

/** A field is missing or wrong; what() is for a person. Never leaves the camera file reader. */
class FieldError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/** One scalar or sequence of a mapping, with its full name. */
struct Field {
    std::string name;
    YAML::Node node;

    /** "line 7: camera_matrix.data", the start of every message. */
    std::string where() const;
    [[noreturn]] void fail(const std::string &what) const;
    std::string text() const;
    double number() const;
    long integer(long least, long most) const;
    /** A sequence of exactly @p count finite numbers. */
    std::vector<double> numbers(std::size_t count) const;
    std::vector<double> numbers() const;
};

/** A mapping whose keys are scalars and appear once each. */
class FieldMap {
public:
    /** @param name  Full name of the mapping, empty for the document. */
    FieldMap(const YAML::Node &node, const std::string &name);
    bool has(const std::string &key) const;
    /** Fails when the key is missing. */
    Field get(const std::string &key) const;
    FieldMap map(const std::string &key) const;
    const std::map<std::string, YAML::Node> &entries() const { return entries_; }

private:
    std::string full_name(const std::string &key) const;
    std::string name_;
    int line_;
    std::map<std::string, YAML::Node> entries_;
};

/** Parse one document. Anchors and aliases, which could make a node contain itself, and documents
 * nested deeper than a camera file ever is are refused before a tree is built.
 * Throws FieldError or YAML::Exception. */
YAML::Node yaml_load_plain(const std::string &text);

}  // namespace opms_host
#endif
