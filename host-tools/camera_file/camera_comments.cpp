/* SPDX-License-Identifier: Apache-2.0 */
/* YAML's parser drops comments, so the text is looked through once more, line by line. Within a
 * text of several lines something may look like a comment and be none; it is then kept twice, which
 * harms no one. */
#include "camera_comments.hpp"

#include <algorithm>
#include <sstream>

namespace opms_host {
namespace {

/** A key, and where it stands. */
struct Place {
    int line, column;
    bool in_opms;
    std::string name;
};

void add_places(const YAML::Node &map, bool in_opms, std::vector<Place> &places)
{
    for (const auto &entry : map) {
        const YAML::Mark mark = entry.first.Mark();
        places.push_back({mark.line, mark.column, in_opms, entry.first.Scalar()});
        if (!in_opms && entry.first.Scalar() == "opms" && entry.second.IsMap()) {
            add_places(entry.second, true, places);
        }
    }
}

/** Where a comment begins in a line, or npos: a '#' after a blank and outside of quotes. */
std::size_t comment_start(const std::string &line)
{
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); i++) {
        const char c = line[i];
        const bool after_blank = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t';
        if (quote != 0) {
            i += quote == '"' && c == '\\' ? 1 : 0;
            quote = c == quote ? 0 : quote;
        } else if (c == '#' && after_blank) {
            return i;
        } else if ((c == '"' || c == '\'') &&
                   (after_blank || line[i - 1] == '[' || line[i - 1] == '{' ||
                    line[i - 1] == ',')) {
            quote = c; /* elsewhere it is an apostrophe */
        }
    }
    return std::string::npos;
}

/** @param column  Where a comment on a line of its own begins; further in than the next key, it is
 *                 still within the one before. Behind a value: -1. */
CameraComment owned(const std::vector<Place> &places, int line, int column)
{
    const Place *before = nullptr, *after = nullptr;
    for (const Place &place : places) {
        if (place.line <= line) {
            before = &place;
        } else {
            after = &place;
            break;
        }
    }
    const bool of_next = column >= 0 && (after == nullptr || column <= after->column) &&
                         (after != nullptr || column == 0);
    const Place *const owner = of_next ? after : before;
    return owner != nullptr ? CameraComment{owner->in_opms, owner->name, std::string()}
                            : CameraComment();
}

}  // namespace

std::vector<CameraComment> camera_read_comments(const std::string &text,
                                                const YAML::Node &document)
{
    std::vector<Place> places;
    add_places(document, false, places);
    std::stable_sort(places.begin(), places.end(),
                     [](const Place &a, const Place &b) { return a.line < b.line; });
    std::vector<CameraComment> comments;
    std::istringstream lines(text);
    std::string line;
    for (int number = 0; std::getline(lines, line); number++) {
        const std::size_t start = comment_start(line);
        if (start == std::string::npos) {
            continue;
        }
        const bool alone = line.find_first_not_of(" \t") == start;
        CameraComment comment = owned(places, number, alone ? static_cast<int>(start) : -1);
        comment.text = line.substr(start, line.find_last_not_of(" \t\r") + 1 - start);
        comments.push_back(comment);
    }
    return comments;
}

}  // namespace opms_host
