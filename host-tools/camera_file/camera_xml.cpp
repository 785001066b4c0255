/* SPDX-License-Identifier: Apache-2.0 */
/* The XML that OpenCV's FileStorage writes, and no more of XML: elements, comments, character
 * references. An element with children is a mapping (children named "_": a list); one with text
 * alone is a quoted text, a number, or a list of what blanks divide. */
#include <algorithm>
#include <cstring>

#include "camera_parts.hpp"

namespace opms_host {
namespace {

constexpr int DEPTH_MAX = 8;
constexpr unsigned long CODE_MAX = 0x7f; /* character references beyond ASCII are not written */

class XmlReader {
public:
    explicit XmlReader(const std::string &text) : text_(text) {}

    YAML::Node document()
    {
        skip_prolog();
        std::string name;
        const YAML::Node root = element(name, 0);
        if (name != "opencv_storage") {
            fail("is <" + name.substr(0, 40) + ">, not OpenCV's <opencv_storage>");
        }
        skip_prolog();
        if (at_ != text_.size()) {
            fail("something follows the end of the document");
        }
        return root;
    }

private:
    [[noreturn]] void fail(const std::string &what) const
    {
        const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size()));
        throw FieldError("line " + std::to_string(1 + std::count(text_.begin(), end, '\n')) +
                         ": " + what);
    }

    static bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

    bool ahead(const char *what) const
    {
        return text_.compare(at_, std::strlen(what), what) == 0;
    }

    void skip_blanks()
    {
        while (at_ < text_.size() && blank(text_[at_])) {
            at_++;
        }
    }

    void skip_past(const char *end)
    {
        const std::size_t found = text_.find(end, at_);
        if (found == std::string::npos) {
            fail(std::string("has no '") + end + "'");
        }
        at_ = found + std::strlen(end);
    }

    /** Blanks, comments, "<?xml ...?>", a byte order mark. */
    void skip_prolog()
    {
        if (at_ == 0 && ahead("\xef\xbb\xbf")) {
            at_ = 3;
        }
        for (skip_blanks(); ahead("<?") || ahead("<!--"); skip_blanks()) {
            skip_past(ahead("<?") ? "?>" : "-->");
        }
        if (ahead("<!")) {
            fail("document types are not read");
        }
    }

    std::string tag_name()
    {
        const std::size_t start = at_;
        while (at_ < text_.size() && !blank(text_[at_]) && text_[at_] != '>' &&
               text_[at_] != '/' && text_[at_] != '<') {
            at_++;
        }
        if (at_ == start) {
            fail("a tag without a name");
        }
        return text_.substr(start, at_ - start);
    }

    /** To the end of an opening tag. @return Whether it closes itself. */
    bool skip_attributes()
    {
        char quote = 0;
        for (; at_ < text_.size(); at_++) {
            const char c = text_[at_];
            if (quote != 0) {
                quote = c == quote ? 0 : quote;
            } else if (c == '"' || c == '\'') {
                quote = c;
            } else if (c == '>') {
                at_++;
                return text_[at_ - 2] == '/';
            } else if (c == '<') {
                break;
            }
        }
        fail("a tag has no end");
    }

    YAML::Node element(std::string &name, int depth)
    {
        if (depth > DEPTH_MAX) {
            fail("nested too deeply for a camera file");
        }
        if (!ahead("<")) {
            fail("is no XML");
        }
        at_++;
        name = tag_name();
        if (skip_attributes()) {
            return YAML::Node(YAML::NodeType::Null);
        }
        YAML::Node map(YAML::NodeType::Map), list(YAML::NodeType::Sequence);
        std::string words;
        bool has_children = false;
        while (!ahead("</")) {
            if (ahead("<!--")) {
                skip_past("-->");
            } else if (ahead("<")) {
                std::string child_name;
                const YAML::Node child = element(child_name, depth + 1);
                has_children = true;
                if (child_name == "_") {
                    add_pieces(words, list);
                    words.clear();
                    list.push_back(child);
                } else {
                    map.force_insert(child_name, child); /* twice: the fields' reader refuses */
                }
            } else {
                add_character(words);
            }
        }
        at_ += 2;
        if (tag_name() != name) {
            fail("<" + name.substr(0, 40) + "> is closed by another name");
        }
        skip_blanks();
        if (!ahead(">")) {
            fail("a tag has no end");
        }
        at_++;
        return has_children ? children(map, list, words) : value(words);
    }

    YAML::Node children(const YAML::Node &map, YAML::Node list, const std::string &words) const
    {
        add_pieces(words, list);
        if (map.size() != 0 && list.size() != 0) {
            fail("an element mixes keys and values");
        }
        return list.size() != 0 ? list : map;
    }

    /** A quote that stands for itself, and a backslash, are marked by a backslash before them. */
    void add_character(std::string &words)
    {
        if (at_ >= text_.size()) {
            fail("ends within an element");
        }
        const bool referred = text_[at_] == '&';
        const char c = text_[at_++];
        const char meant = referred ? reference() : c;
        words += meant == '\\' || (referred && meant == '"') ? "\\" : "";
        words += meant;
    }

    char reference()
    {
        const std::size_t end = text_.find(';', at_);
        if (end == std::string::npos || end - at_ > 8) {
            fail("an '&' begins no character reference");
        }
        const std::string name = text_.substr(at_, end - at_);
        static const struct {
            const char *name;
            char c;
        } known[] = {{"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
        for (const auto &one : known) {
            if (name == one.name) {
                at_ = end + 1;
                return one.c;
            }
        }
        const bool hex = name.size() > 1 && name[1] == 'x';
        char *rest = nullptr;
        const unsigned long code =
            name.size() > 1 && name[0] == '#'
                ? std::strtoul(name.c_str() + (hex ? 2 : 1), &rest, hex ? 16 : 10)
                : 0;
        if (rest == nullptr || *rest != 0 || code == 0 || code > CODE_MAX) {
            fail("'&" + name + ";' is not known");
        }
        at_ = end + 1;
        return static_cast<char>(code);
    }

    /** One piece of an element's text: quoted, or up to the next blank. */
    YAML::Node piece(const std::string &words, std::size_t &i) const
    {
        const bool is_quoted = words[i] == '"';
        std::string text;
        for (i += is_quoted ? 1 : 0; i < words.size(); i++) {
            if (is_quoted ? words[i] == '"' : blank(words[i])) {
                break;
            }
            i += words[i] == '\\' && i + 1 < words.size() ? 1 : 0;
            text += words[i];
        }
        if (is_quoted && i++ >= words.size()) {
            fail("a quoted text has no end");
        }
        return is_quoted ? camera_text_node(text) : YAML::Node(text);
    }

    void add_pieces(const std::string &words, YAML::Node &list) const
    {
        for (std::size_t i = 0; i < words.size();) {
            if (blank(words[i])) {
                i++;
            } else {
                list.push_back(piece(words, i));
            }
        }
    }

    YAML::Node value(const std::string &words) const
    {
        YAML::Node list(YAML::NodeType::Sequence);
        add_pieces(words, list);
        if (list.size() == 0) {
            return YAML::Node(YAML::NodeType::Null);
        }
        return list.size() == 1 ? list[0] : list;
    }

    const std::string &text_;
    std::size_t at_ = 0;
};

}  // namespace

YAML::Node camera_load_xml(const std::string &text)
{
    return XmlReader(text).document();
}

}  // namespace opms_host
