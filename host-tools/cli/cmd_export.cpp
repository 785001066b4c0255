/* SPDX-License-Identifier: Apache-2.0 */
/* opms export: a recorded scan as CSV, MCAP, or pictures with their poses. */
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "export_scan.hpp"
#include "location_json.hpp"
#include "result_stream.hpp"
#include "scans_folder.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace opms_host;

struct ExportArguments {
    std::string scan, to;
    ExportRequest request;
    bool without_pictures = false;
    double most_gap_s = 1;
    bool json = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

std::string counted(std::uint64_t count, const char *one, const char *many)
{
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string report_json(const ExportArguments &arguments, const std::string &name,
                        const ExportReport &report)
{
    return json_line({{"schema", "opms.export/1"},
                      {"scan", name},
                      {"to", arguments.to},
                      {"files", report.files},
                      {"poses", report.poses},
                      {"sensor_samples", report.sensor_samples},
                      {"pictures", report.pictures},
                      {"events", report.events},
                      {"problems", report.problems}});
}

std::string report_text(const ExportReport &report)
{
    std::string files;
    for (const std::string &file : report.files) {
        files += (files.empty() ? "" : ", ") + file;
    }
    return files + ": " + counted(report.poses, "pose", "poses") + ", " +
           counted(report.pictures, "picture", "pictures") + ", " +
           counted(report.sensor_samples, "sensor sample", "sensor samples") + ", " +
           counted(report.events, "event", "events");
}

bool write(const ExportArguments &arguments, ScanReader &scan, ExportReport &report,
           std::string &error)
{
    if (arguments.to == "csv") {
        return export_csv(scan, arguments.request, report, error);
    }
    if (arguments.to == "mcap") {
        return export_mcap(scan, arguments.request, report, error);
    }
    return export_pictures(scan, arguments.request, report, error);
}

int run_export(ExportArguments &arguments)
{
    arguments.request.with_pictures = !arguments.without_pictures;
    arguments.request.most_gap_ns = static_cast<std::int64_t>(arguments.most_gap_s * 1e9);
    std::string error;
    const auto scan = ScanReader::open(scan_path(arguments.scan), error);
    if (!scan) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    if (scan->summary().being_recorded) {
        talk(scan->summary().name + ": is being recorded; what is on the disk by now is exported");
    }
    ExportReport report;
    if (!write(arguments, *scan, report, error)) {
        talk(error);
        return EXIT_CODE_INPUT;
    }
    for (const std::string &problem : report.problems) {
        talk(problem + "; it was left out");
    }
    ResultStream out;
    const bool written = out.write_line(
        arguments.json ? report_json(arguments, scan->summary().name, report)
                       : report_text(report));
    return written && report.problems.empty() ? EXIT_CODE_OK : EXIT_CODE_INPUT;
}

}  // namespace

void add_cmd_export(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<ExportArguments>();
    CLI::App *cmd = app.add_subcommand(
        "export", "A recorded scan as CSV, as MCAP for Foxglove, or as pictures with poses.");
    cmd->add_option("SCAN", arguments->scan, "Folder of a scan, or its name in $OPMS_SCANS")
        ->required()
        ->type_name("");
    cmd->add_option("--to", arguments->to, "csv, mcap or pictures")
        ->required()
        ->type_name("FORM")
        ->check(CLI::IsMember({"csv", "mcap", "pictures"}).description(""));
    cmd->add_option("--out", arguments->request.out, "File to write; to pictures: a new folder")
        ->required()
        ->type_name("PATH");
    cmd->add_flag("--force", arguments->request.may_replace, "Replace a file that is there");
    cmd->add_flag("--no-pictures", arguments->without_pictures, "MCAP without the pictures");
    cmd->add_option("--max-gap-s", arguments->most_gap_s,
                    "CSV: no pose of a sensor sample across a longer gap of poses [1]")
        ->type_name("S")
        ->check(CLI::Range(0.0, 3600.0).description(""));
    cmd->add_flag("--json", arguments->json, "One JSON object (schema opms.export/1)");
    cmd->callback([arguments, &exit_code] { exit_code = run_export(*arguments); });
}
