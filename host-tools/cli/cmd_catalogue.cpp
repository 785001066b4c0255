/* SPDX-License-Identifier: Apache-2.0 */
/* opms catalogue: which scans there are, whether they are sound, and away with those not wanted. */
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "catalogue_delete.hpp"
#include "catalogue_state.hpp"
#include "catalogue_verify.hpp"
#include "commands.hpp"
#include "location_json.hpp"
#include "result_stream.hpp"
#include "scan_json.hpp"
#include "scans_folder.hpp"
#include "text_table.hpp"

namespace {

using Json = nlohmann::ordered_json;
using namespace opms_host;

struct CatalogueArguments {
    std::string folder, from, to;
    CatalogueSearch search;
    std::vector<std::string> scans;
    bool json = false, mend = false, yes = false;
};

void talk(const std::string &line)
{
    std::fprintf(stderr, "opms: %s\n", line.c_str());
}

std::string folder_of(const CatalogueArguments &arguments)
{
    return arguments.folder.empty() ? scans_folder() : arguments.folder;
}

int show_list(const CatalogueArguments &arguments, const std::vector<ScanSummary> &scans,
              bool failed)
{
    std::vector<std::string> names;
    for (const ScanSummary &scan : scans) {
        names.push_back(catalogue_name(scan.folder));
    }
    const std::size_t width = text_name_width(names);
    ResultStream out;
    if (!arguments.json && !scans.empty()) {
        out.write_line(catalogue_heading(width));
    }
    for (const ScanSummary &scan : scans) {
        out.write_line(arguments.json ? json_line(catalogue_row(scan))
                                      : catalogue_line(scan, width));
    }
    return out.failed() || failed ? EXIT_CODE_INPUT : EXIT_CODE_OK;
}

/** @return False where some could not be read; they are told. */
bool read_scans(const CatalogueArguments &arguments, std::vector<ScanSummary> &scans)
{
    std::error_code ignored;
    if (arguments.folder.empty() && !std::filesystem::exists(scans_folder(), ignored)) {
        return true; /* nothing was recorded yet */
    }
    std::vector<std::string> failed;
    scans = list_scans(folder_of(arguments), failed);
    for (const std::string &line : failed) {
        talk(line);
    }
    return failed.empty();
}

int run_list(const CatalogueArguments &arguments)
{
    std::vector<ScanSummary> scans;
    const bool read = read_scans(arguments, scans);
    if (read && scans.empty() && !arguments.json) {
        talk("no scans in " + folder_of(arguments));
    }
    return show_list(arguments, scans, !read);
}

bool take_time(const std::string &text, bool is_end, std::optional<std::int64_t> &wall_ns)
{
    std::int64_t begin_ns = 0, length_ns = 0;
    if (text.empty()) {
        return true;
    }
    if (!catalogue_parse_time(text, begin_ns, length_ns)) {
        talk(text + " is no date: 2026-11-22 or 2026-11-22T14:03:07 (UTC)");
        return false;
    }
    wall_ns = is_end ? begin_ns + length_ns : begin_ns; /* the day named last is within */
    return true;
}

int run_search(CatalogueArguments &arguments)
{
    CatalogueSearch &search = arguments.search;
    if (!take_time(arguments.from, false, search.from_wall_ns) ||
        !take_time(arguments.to, true, search.to_wall_ns)) {
        return EXIT_CODE_USAGE;
    }
    std::vector<ScanSummary> scans, found;
    bool read = read_scans(arguments, scans);
    for (const ScanSummary &scan : scans) {
        bool fits = catalogue_fits(scan, search);
        if (fits && !search.text.empty()) {
            std::string error;
            const auto reader = ScanReader::open(scan.folder, error);
            fits = reader && catalogue_has_text(*reader, search.text, error);
            if (!error.empty()) {
                talk(error);
                read = false;
            }
        }
        if (fits) {
            found.push_back(scan);
        }
    }
    return show_list(arguments, found, !read);
}

bool show_events(ScanReader &scan, const CatalogueArguments &arguments, ResultStream &out,
                 std::string &error)
{
    const std::int64_t begun_ns = scan.summary().header.begun_host_ns;
    return scan.each_event(
        [&](const EventRecord &event) {
            return out.write_line(
                arguments.json
                    ? json_line(event_json(event))
                    : text_format("%10.3f s  %-7s  ",
                                  static_cast<double>(event.t_host_ns - begun_ns) * 1e-9,
                                  severity_name(event.severity)) +
                          event.code + ": " + event.text);
        },
        error);
}

int run_show(const CatalogueArguments &arguments)
{
    ResultStream out;
    std::string error;
    bool failed = false;
    for (const std::string &name : arguments.scans) {
        const auto scan = ScanReader::open(scan_path(name, arguments.folder), error);
        if (!scan) {
            talk(error);
            failed = true;
            continue;
        }
        out.write_line(arguments.json ? json_line(catalogue_page_row(scan->summary()))
                                      : catalogue_page(scan->summary()));
        if (!show_events(*scan, arguments, out, error) && !out.failed()) {
            talk(error);
            failed = true;
        }
    }
    return failed || out.failed() ? EXIT_CODE_INPUT : EXIT_CODE_OK;
}

/** What recover_scan() did, or that it was not needed. False with words on stderr. */
bool mend(const std::string &folder, const CatalogueArguments &arguments, ResultStream &out)
{
    ScanRecovery recovery;
    std::string error;
    if (!recover_scan(folder, recovery, error)) {
        talk(error);
        return false;
    }
    if (arguments.json) {
        out.write_line(json_line({{"schema", "opms.catalogue.mend/1"},
                                  {"folder", folder},
                                  {"needed", recovery.needed},
                                  {"rows", recovery.rows},
                                  {"pictures_lost", recovery.pictures_lost},
                                  {"pictures_loose", recovery.pictures_loose},
                                  {"words", recovery.words}}));
    } else if (!recovery.needed) {
        out.write_line(folder + ": was closed in order; nothing to mend");
    }
    for (const std::string &words : recovery.words) {
        talk(folder + ": " + words);
    }
    return true;
}

void show_verdict(const VerifyOutcome &outcome, const std::string &folder,
                  const CatalogueArguments &arguments, ResultStream &out)
{
    if (arguments.json) {
        out.write_line(json_line({{"schema", "opms.catalogue.verify/1"},
                                  {"name", outcome.name},
                                  {"folder", folder},
                                  {"sound", outcome.sound()},
                                  {"pictures", outcome.pictures},
                                  {"problem_count", outcome.problem_count},
                                  {"problems", outcome.problems},
                                  {"notes", outcome.notes}}));
        return;
    }
    out.write_line(outcome.name + ": " +
                   (outcome.sound() ? "sound"
                                    : std::to_string(outcome.problem_count) + " problem(s)") +
                   ", " + std::to_string(outcome.pictures) + " pictures looked at");
    for (const std::string &problem : outcome.problems) {
        out.write_line("  " + problem);
    }
    for (const std::string &note : outcome.notes) {
        out.write_line("  " + note);
    }
}

int run_verify(CatalogueArguments &arguments)
{
    std::vector<ScanSummary> scans;
    bool failed = false, sound = true;
    if (arguments.scans.empty()) {
        failed = !read_scans(arguments, scans);
    }
    for (const ScanSummary &scan : scans) {
        arguments.scans.push_back(scan.folder);
    }
    ResultStream out;
    for (const std::string &name : arguments.scans) {
        const std::string folder = scan_path(name, arguments.folder);
        failed |= arguments.mend && !mend(folder, arguments, out);
        const VerifyOutcome outcome = catalogue_verify(folder);
        show_verdict(outcome, folder, arguments, out);
        failed |= !outcome.readable;
        sound &= outcome.sound();
    }
    if (failed || out.failed()) {
        return EXIT_CODE_INPUT;
    }
    return sound ? EXIT_CODE_OK : EXIT_CODE_RESULT;
}

/** @return Whether a person said yes. */
bool is_wanted(const std::string &folder)
{
    std::fprintf(stderr, "Delete %s for good? Type 'yes': ", folder.c_str());
    std::string answer;
    std::getline(std::cin, answer);
    return answer == "yes";
}

int run_delete(const CatalogueArguments &arguments)
{
    if (!arguments.yes && !::isatty(STDIN_FILENO)) {
        talk("nobody is there to ask: --yes deletes without a question");
        return EXIT_CODE_USAGE;
    }
    ResultStream out;
    bool failed = false;
    for (const std::string &name : arguments.scans) {
        const std::string folder = scan_path(name, arguments.folder);
        std::string error;
        if (!catalogue_may_delete(folder, error)) {
            talk(error);
            failed = true;
        } else if (!arguments.yes && !is_wanted(folder)) {
            talk(folder + ": is kept");
        } else if (!catalogue_delete(folder, error)) {
            talk(error);
            failed = true;
        } else {
            out.write_line(arguments.json ? json_line({{"schema", "opms.catalogue.delete/1"},
                                                       {"folder", folder},
                                                       {"deleted", true}})
                                          : folder + ": deleted");
        }
    }
    return failed || out.failed() ? EXIT_CODE_INPUT : EXIT_CODE_OK;
}

using Arguments = std::shared_ptr<CatalogueArguments>;

CLI::App *add_action(CLI::App &cmd, const char *name, const char *what, const Arguments &arguments)
{
    CLI::App *action = cmd.add_subcommand(name, what);
    action
        ->add_option("--folder", arguments->folder,
                     "Of all scans [$OPMS_SCANS, else ~/opms-scans]")
        ->type_name("DIR");
    action->add_flag("--json", arguments->json, "One JSON object a line");
    return action;
}

CLI::Option *add_scans(CLI::App &action, const Arguments &arguments)
{
    return action.add_option("SCAN", arguments->scans, "Names of scans, or their folders")
        ->type_name("");
}

void add_search_options(CLI::App &search, const Arguments &arguments)
{
    search.add_option("--name", arguments->search.name, "Part of the name")->type_name("TEXT");
    search.add_option("--from", arguments->from, "Begun on this day (UTC) or later")
        ->type_name("DATE");
    search.add_option("--to", arguments->to, "Begun on this day or earlier")->type_name("DATE");
    search.add_option("--text", arguments->search.text,
                      "Part of an event, of the settings, of the names of box or camera")
        ->type_name("TEXT");
}

}  // namespace

void add_cmd_catalogue(CLI::App &app, int &exit_code)
{
    const auto arguments = std::make_shared<CatalogueArguments>();
    CLI::App *cmd =
        app.add_subcommand("catalogue", "Recorded scans: list, search, verify, delete.");
    cmd->require_subcommand(1);
    CLI::App *list = add_action(*cmd, "list", "All scans, by their beginning", arguments);
    list->callback([arguments, &exit_code] { exit_code = run_list(*arguments); });
    CLI::App *search = add_action(*cmd, "search", "Scans that fit all that is given", arguments);
    add_search_options(*search, arguments);
    search->callback([arguments, &exit_code] { exit_code = run_search(*arguments); });
    CLI::App *show = add_action(*cmd, "show", "All that is known of a scan", arguments);
    add_scans(*show, arguments)->required();
    show->callback([arguments, &exit_code] { exit_code = run_show(*arguments); });
    CLI::App *verify =
        add_action(*cmd, "verify", "Are scans sound? All of them, or those named", arguments);
    add_scans(*verify, arguments);
    verify->add_flag("--mend", arguments->mend, "First bring those in order that were cut off");
    verify->callback([arguments, &exit_code] { exit_code = run_verify(*arguments); });
    CLI::App *del = add_action(*cmd, "delete", "Delete scans; asks first", arguments);
    add_scans(*del, arguments)->required();
    del->add_flag("--yes", arguments->yes, "Do not ask");
    del->callback([arguments, &exit_code] { exit_code = run_delete(*arguments); });
}
