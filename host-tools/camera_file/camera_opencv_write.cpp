/* SPDX-License-Identifier: Apache-2.0 */
/* What OpenCV's FileStorage reads, as YAML and as XML. Its dialect of YAML is narrow: one line
 * before the document, its own tag for a matrix, lists in brackets, names of letters and digits. */
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "camera_parts.hpp"
#include "yaml_text.hpp"

namespace opms_host {
namespace {

constexpr std::size_t PER_LINE = 4;

YAML::Node matrix_node(int rows, int cols, const std::vector<double> &values)
{
    YAML::Node matrix(YAML::NodeType::Map), data(YAML::NodeType::Sequence);
    for (const double value : values) {
        data.push_back(yaml_number(value));
    }
    matrix["rows"] = std::to_string(rows);
    matrix["cols"] = std::to_string(cols);
    matrix["dt"] = "d";
    matrix["data"] = data;
    return matrix;
}

bool is_matrix(const YAML::Node &node)
{
    return node.IsMap() && node.size() == 4 && node["rows"] && node["cols"] && node["dt"] &&
           node["data"] && node["data"].IsSequence();
}

/** Letters, digits, '_' and '-' after a letter or '_'. */
bool is_name(const std::string &name)
{
    const auto good = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
    return !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
           name[0] != '-' && std::all_of(name.begin(), name.end(), good);
}

bool can_hold(const YAML::Node &node)
{
    if (node.IsScalar()) {
        return std::all_of(node.Scalar().begin(), node.Scalar().end(),
                           [](unsigned char c) { return c >= 0x20 && c != 0x7f; });
    }
    if (node.IsSequence()) {
        return node.size() != 0 && std::all_of(node.begin(), node.end(), [](const auto &item) {
            return !item.IsMap() && can_hold(item);
        });
    }
    return node.IsMap() && node.size() != 0 &&
           std::all_of(node.begin(), node.end(), [](const auto &entry) {
               return is_name(entry.first.Scalar()) && can_hold(entry.second);
           });
}

void add_extras(const std::vector<CameraExtra> &extras, const std::string &where, YAML::Node &to,
                std::vector<std::string> &notes)
{
    for (const CameraExtra &extra : extras) {
        const YAML::Node value = YAML::Load(extra.value);
        if (is_name(extra.name) && can_hold(value)) {
            to[extra.name] = value;
        } else {
            notes.push_back(camera_one_line(where + extra.name.substr(0, 60) +
                                            " cannot be told to OpenCV and is left out"));
        }
    }
}

/** The document as a tree of mappings, lists and scalars. */
YAML::Node tree_of(const CameraFile &file, std::vector<std::string> &notes)
{
    const opms_lens_t &lens = file.camera.lens;
    YAML::Node root(YAML::NodeType::Map);
    root["image_width"] = std::to_string(lens.width_px);
    root["image_height"] = std::to_string(lens.height_px);
    if (!file.name.empty()) {
        root["camera_name"] = camera_text_node(file.name);
    }
    root["camera_matrix"] =
        matrix_node(3, 3, {lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1});
    root["distortion_coefficients"] =
        matrix_node(5, 1, {lens.k1, lens.k2, lens.p1, lens.p2, 0});
    add_extras(file.extras, "", root, notes);
    CameraFile own = file;
    own.opms_extras.clear();
    YAML::Node opms = camera_opms_node(own);
    add_extras(file.opms_extras, "opms.", opms, notes);
    root["opms"] = opms;
    return root;
}

bool is_number(const YAML::Node &node)
{
    double value = 0;
    const std::string &text = node.Scalar();
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    return node.Tag() != "!" && status == std::errc() && end == text.data() + text.size() &&
           std::isfinite(value);
}

/** Bytes beyond ASCII go through as they are. */
std::string quoted(const std::string &text)
{
    std::string out = "\"";
    for (const char c : text) {
        out += c == '"' || c == '\\' ? "\\" : "";
        out += c;
    }
    return out + "\"";
}

std::string scalar(const YAML::Node &node)
{
    return is_number(node) ? node.Scalar() : quoted(node.Scalar());
}

std::string list_text(const YAML::Node &node, const std::string &indent)
{
    std::string text = "[ ";
    for (std::size_t i = 0; i < node.size(); i++) {
        text += i == 0 ? "" : i % PER_LINE == 0 ? ",\n" + indent + "   " : ", ";
        text += node[i].IsSequence() ? list_text(node[i], indent + "   ") : scalar(node[i]);
    }
    return text + " ]";
}

void write_yaml(const YAML::Node &map, const std::string &indent, std::string &text)
{
    for (const auto &entry : map) {
        const YAML::Node &value = entry.second;
        text += indent + entry.first.Scalar() + ":";
        if (value.IsMap()) {
            text += is_matrix(value) ? " !!opencv-matrix\n" : "\n";
            write_yaml(value, indent + "   ", text);
        } else if (value.IsSequence()) {
            text += " " + list_text(value, indent + "   ") + "\n";
        } else if (entry.first.Scalar() == "dt") {
            text += " " + value.Scalar() + "\n";
        } else {
            text += " " + scalar(value) + "\n";
        }
    }
}

std::string xml_scalar(const YAML::Node &node)
{
    if (is_number(node)) {
        return node.Scalar();
    }
    std::string out = "\"";
    for (const char c : node.Scalar()) {
        out += c == '<'    ? "&lt;"
               : c == '>'  ? "&gt;"
               : c == '&'  ? "&amp;"
               : c == '"'  ? "&quot;"
               : c == '\'' ? "&apos;"
                           : std::string(1, c);
    }
    return out + "\"";
}

std::string xml_list(const YAML::Node &node, const std::string &indent)
{
    std::string text = "\n" + indent;
    for (std::size_t i = 0; i < node.size(); i++) {
        text += i == 0 ? "" : i % PER_LINE == 0 ? "\n" + indent : " ";
        text += node[i].IsSequence() ? "<_>" + xml_list(node[i], indent + "  ") + "</_>"
                                     : xml_scalar(node[i]);
    }
    return text;
}

void write_xml(const YAML::Node &map, const std::string &indent, std::string &text)
{
    for (const auto &entry : map) {
        const std::string &name = entry.first.Scalar();
        const YAML::Node &value = entry.second;
        text += indent + "<" + name;
        if (value.IsMap()) {
            text += is_matrix(value) ? " type_id=\"opencv-matrix\">\n" : ">\n";
            write_xml(value, indent + "  ", text);
            text += indent;
        } else if (value.IsSequence()) {
            text += ">" + xml_list(value, indent + "  ");
        } else {
            text += ">" + (name == "dt" ? value.Scalar() : xml_scalar(value));
        }
        text += "</" + name + ">\n";
    }
}

}  // namespace

std::string camera_opencv_yaml_text(const CameraFile &file, std::vector<std::string> &notes)
{
    std::string text = "%YAML:1.0\n---\n";
    write_yaml(tree_of(file, notes), "", text);
    return text;
}

std::string camera_opencv_xml_text(const CameraFile &file, std::vector<std::string> &notes)
{
    std::string text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
    write_xml(tree_of(file, notes), "", text);
    return text + "</opencv_storage>\n";
}

}  // namespace opms_host
