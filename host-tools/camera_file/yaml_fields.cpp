/* SPDX-License-Identifier: Apache-2.0 */
#include "yaml_fields.hpp"

#include <charconv>
#include <cmath>
#include <sstream>
#include <system_error>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/parser.h>

namespace opms_host {
namespace {

constexpr int DEPTH_MAX = 8;

std::string line_text(int line_from_0)
{
    return line_from_0 < 0 ? std::string() : "line " + std::to_string(line_from_0 + 1) + ": ";
}

/** A value as it appears in a message: short and printable. */
std::string quoted(const std::string &value)
{
    std::string out = "'";
    for (const char c : value.substr(0, 40)) {
        const auto byte = static_cast<unsigned char>(c);
        out += byte < 0x20 || byte == 0x7f ? '?' : c;
    }
    return out + (value.size() > 40 ? "...'" : "'");
}

/** Looks at the events of a document before anything is built from it. */
class Gate : public YAML::EventHandler {
public:
    void OnDocumentStart(const YAML::Mark &) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark &mark, YAML::anchor_t anchor) override { refuse(mark, anchor); }
    void OnAlias(const YAML::Mark &mark, YAML::anchor_t) override { refuse(mark, 1); }
    void OnScalar(const YAML::Mark &mark, const std::string &, YAML::anchor_t anchor,
                  const std::string &) override
    {
        refuse(mark, anchor);
    }
    void OnSequenceStart(const YAML::Mark &mark, const std::string &, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override
    {
        enter(mark, anchor);
    }
    void OnSequenceEnd() override { depth_--; }
    void OnMapStart(const YAML::Mark &mark, const std::string &, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override
    {
        enter(mark, anchor);
    }
    void OnMapEnd() override { depth_--; }

private:
    static void refuse(const YAML::Mark &mark, YAML::anchor_t anchor)
    {
        if (anchor != YAML::NullAnchor) {
            throw FieldError(line_text(mark.line) + "anchors and aliases are not allowed");
        }
    }
    void enter(const YAML::Mark &mark, YAML::anchor_t anchor)
    {
        refuse(mark, anchor);
        if (++depth_ > DEPTH_MAX) {
            throw FieldError(line_text(mark.line) + "nested too deeply for a camera file");
        }
    }
    int depth_ = 0;
};

/** Locale-free; false when the text is not one number and nothing else. NaN and infinity in YAML's
 * spelling count as numbers, so that the message can say what is wrong with them. */
bool parse_double(const std::string &text, double &value)
{
    std::string t = text;
    if (!t.empty() && t[0] == '+') {
        t.erase(0, 1);
    }
    const std::size_t sign = !t.empty() && t[0] == '-' ? 1 : 0;
    if (t.size() == sign + 4 && t[sign] == '.' && (t[sign + 1] | 0x20) >= 'i') {
        t.erase(sign, 1);
    }
    const auto [end, status] = std::from_chars(t.data(), t.data() + t.size(), value);
    if (status == std::errc::result_out_of_range) {
        value = HUGE_VAL;
        return true;
    }
    return status == std::errc() && end == t.data() + t.size();
}

}  // namespace

std::string Field::where() const
{
    return line_text(node.Mark().line) + name;
}

void Field::fail(const std::string &what) const
{
    throw FieldError(where() + " " + what);
}

std::string Field::text() const
{
    if (!node.IsScalar()) {
        fail("must be a text");
    }
    return node.Scalar();
}

double Field::number() const
{
    double value = 0;
    if (!node.IsScalar() || !parse_double(node.Scalar(), value)) {
        fail(node.IsScalar() ? "is not a number: " + quoted(node.Scalar()) : "must be a number");
    }
    if (!std::isfinite(value)) {
        fail("is not finite: " + quoted(node.Scalar()));
    }
    return value;
}

long Field::integer(long least, long most) const
{
    const double value = number();
    if (value != std::floor(value) || value < static_cast<double>(least) ||
        value > static_cast<double>(most)) {
        fail("must be a whole number from " + std::to_string(least) + " to " +
             std::to_string(most) + ", is " + quoted(node.Scalar()));
    }
    return static_cast<long>(value);
}

std::vector<double> Field::numbers() const
{
    if (!node.IsSequence()) {
        fail("must be a list of numbers");
    }
    std::vector<double> values;
    values.reserve(node.size());
    for (const auto &item : node) {
        values.push_back(Field{name + "[" + std::to_string(values.size()) + "]", item}.number());
    }
    return values;
}

std::vector<double> Field::numbers(std::size_t count) const
{
    if (node.IsSequence() && node.size() != count) {
        fail("has " + std::to_string(node.size()) + " numbers, must have " +
             std::to_string(count));
    }
    return numbers();
}

FieldMap::FieldMap(const YAML::Node &node, const std::string &name)
    : name_(name), line_(node.Mark().line)
{
    if (!node.IsMap()) {
        throw FieldError(name.empty() ? "is not a camera file: no 'key: value' lines"
                                      : line_text(line_) + name + " must be a mapping");
    }
    for (const auto &entry : node) {
        if (!entry.first.IsScalar()) {
            throw FieldError(line_text(entry.first.Mark().line) + "a key must be a plain word");
        }
        const std::string &key = entry.first.Scalar();
        if (!entries_.emplace(key, entry.second).second) {
            throw FieldError(line_text(entry.first.Mark().line) + full_name(key) +
                             " appears twice");
        }
    }
}

std::string FieldMap::full_name(const std::string &key) const
{
    return name_.empty() ? key : name_ + "." + key;
}

bool FieldMap::has(const std::string &key) const
{
    return entries_.count(key) != 0;
}

Field FieldMap::get(const std::string &key) const
{
    const auto found = entries_.find(key);
    if (found == entries_.end()) {
        throw FieldError((name_.empty() ? std::string() : line_text(line_)) + full_name(key) +
                         " is missing");
    }
    return Field{full_name(key), found->second};
}

FieldMap FieldMap::map(const std::string &key) const
{
    return FieldMap(get(key).node, full_name(key));
}

YAML::Node yaml_load_plain(const std::string &text)
{
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    Gate gate;
    parser.HandleNextDocument(gate);
    return YAML::Load(text);
}

}  // namespace opms_host
