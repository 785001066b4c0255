/* SPDX-License-Identifier: Apache-2.0 */
/* opms nodes: from pictures of the calibration grid to its labelled nodes. */
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "grid_reader.hpp"
#include "result_stream.hpp"
#include "text_table.hpp"

namespace {

using Json = nlohmann::ordered_json;

struct NodesArguments {
    std::string grid;
    unsigned white_level = 0;
    bool json = false;
    std::vector<std::string> images;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

/** Nodes whose labels are not certain are of no use to a reader, and are not given. */
Json json_nodes(const GridPicture &picture)
{
    Json list = Json::array();
    if (picture.labelled()) {
        for (const opms_node_t &node : picture.nodes) {
            list.push_back({{"label", {node.label[0], node.label[1]}},
                            {"px", {node.px[0], node.px[1]}},
                            {"sigma_px", node.sigma_px}});
        }
    }
    return list;
}

std::string json_row(const GridPicture &picture)
{
    Json row;
    row["schema"] = "opms.nodes/1";
    row["image"] = picture.image;
    row["state"] = picture.state_name();
    if (!picture.reason.empty()) {
        row["reason"] = picture.reason;
    } else {
        row["node_count"] = picture.nodes.size();
        row["nodes"] = json_nodes(picture);
    }
    /* A file's name may be any bytes. */
    return row.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string table_heading(std::size_t name_width)
{
    return text_padded("picture", name_width) +
           "  state       nodes   columns     rows  sigma px  blur px  contrast";
}

/** Smallest and largest label, columns along X and rows along Y. */
std::string label_span(const GridPicture &picture, int axis)
{
    int least = picture.nodes.front().label[axis], most = least;
    for (const opms_node_t &node : picture.nodes) {
        least = std::min(least, node.label[axis]);
        most = std::max(most, node.label[axis]);
    }
    return text_format("%d..%d", least, most);
}

double mean_sigma_px(const GridPicture &picture)
{
    double sum = 0;
    for (const opms_node_t &node : picture.nodes) {
        sum += node.sigma_px;
    }
    return sum / static_cast<double>(picture.nodes.size());
}

std::string table_line(const GridPicture &picture, std::size_t name_width)
{
    const std::string start =
        text_padded(picture.image, name_width) + text_format("  %-10s", picture.state_name());
    if (!picture.reason.empty()) {
        return start + "  " + picture.reason;
    }
    if (picture.nodes.empty()) {
        return start + text_format(" %6d", 0);
    }
    const bool labelled = picture.labelled();
    return start + text_format(" %6zu %9s %8s  %8.4f %8.2f %9.1f", picture.nodes.size(),
                               labelled ? label_span(picture, 0).c_str() : "?",
                               labelled ? label_span(picture, 1).c_str() : "?",
                               mean_sigma_px(picture), picture.summary.blur_px,
                               picture.summary.contrast);
}

void talk_about(const GridPicture &picture)
{
    if (!picture.reason.empty()) {
        talk(picture.image + ": " + picture.reason);
        return;
    }
    if (picture.colour) {
        talk(picture.image + ": is in colour; its luma is used");
    }
    if (picture.summary.state == OPMS_GRID_UNLABELLED) {
        talk(picture.image + ": the grid is seen, but not its marker: nodes cannot be labelled");
    }
}

int nodes(const NodesArguments &arguments)
{
    const std::size_t width = text_name_width(arguments.images);
    GridReader reader(static_cast<uint16_t>(arguments.white_level));
    ResultStream out;
    bool unread = false;
    if (!arguments.json) {
        out.write_line(table_heading(width));
    }
    for (const std::string &image : arguments.images) {
        const GridPicture picture = reader.read(image);
        talk_about(picture);
        unread |= !picture.reason.empty();
        if (!out.write_line(arguments.json ? json_row(picture) : table_line(picture, width))) {
            return EXIT_CODE_INPUT;
        }
    }
    return unread ? EXIT_CODE_INPUT : EXIT_CODE_OK;
}

}  // namespace

void add_cmd_nodes(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<NodesArguments>();
    CLI::App *cmd = app.add_subcommand(
        "nodes", "Pictures of the calibration grid in, its labelled nodes out.");
    cmd->add_option("--grid", arguments->grid, "Kind of grid: a0-25")
        ->required()
        ->type_name("KIND")
        ->check(CLI::IsMember({"a0-25"}).description(""));
    cmd->add_option("--white-level", arguments->white_level,
                    "Grey level at saturation, 4095 for 12 bit in 16 [255 or 65535]")
        ->type_name("N")
        ->check(CLI::Range(0, 65535).description(""));
    cmd->add_flag("--json", arguments->json, "One JSON object a line (schema opms.nodes/1)");
    cmd->add_option("IMAGE", arguments->images, "PNG, JPEG, TIFF, BMP or PGM, 8 or 16 bit")
        ->required()
        ->type_name("");
    cmd->callback([arguments, &exit_code] { exit_code = nodes(*arguments); });
}
