#include "server/parameters/json_text.h"

#include <boost/json.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

namespace evod::parameters {
namespace {

namespace json = boost::json;

json::string_view view_of(std::string_view text) {
    return {text.data(), text.size()};
}

/// Removes a byte order mark at the beginning, which editors and spreadsheet programs write.
std::string_view without_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

/// Returns what the author of a faulty text probably has to change; an empty text if the cause is unknown.
///
/// at  index of the first character that no JSON text can have there.
std::string likely_cause(std::string_view text, std::size_t at) {
    const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    const std::size_t before = text.substr(0, at).find_last_not_of(" \t\r\n");
    const bool after_comma = before != std::string_view::npos && text[before] == ',';
    const char c = at < text.size() ? text[at] : '\0';
    if ((c == '}' || c == ']') && after_comma) {
        return std::string{"remove the comma before "} + c;
    }
    if (c == '/' || c == '#') {
        return "JSON has no comments: remove the comment, or use \"description\"";
    }
    if (c == '\'' || text.substr(at).starts_with("\xe2\x80\x9c") || text.substr(at).starts_with("\xe2\x80\x9e")) {
        return "write names and texts in straight double quotes: \"selection\"";
    }
    if (is_digit(at) && after_comma && before > 0 && is_digit(before - 1)) {
        return "write a point in a decimal number: 0.5";
    }
    if (c == 'T' || c == 'F' || c == 'N') {
        return "write true, false and null in lower case, and names in double quotes";
    }
    if (c == '"' && before != std::string_view::npos && !after_comma && text[before] != ':') {
        return "a comma may be missing before it";
    }
    return c >= 'a' && c <= 'z' ? "write names and texts in double quotes: \"selection\"" : "";
}

/// Returns, for example, `line 3, column 7: syntax error at "}"; remove the comma before }`.
std::string json_fault(std::string_view text, std::size_t at, const std::string& error) {
    at = std::min(at, text.size());
    const std::string_view before = text.substr(0, at);
    const std::size_t line = 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
    const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1; // npos + 1 is 0
    std::string fault = "line " + std::to_string(line) + ", column " + std::to_string(column) + ": " + error;
    constexpr std::size_t shown_max = 20;
    std::string_view rest = text.substr(at);
    rest = rest.substr(0, rest.find_first_of("\r\n"));
    if (rest.size() > shown_max) {
        rest = rest.substr(0, shown_max);
        while (!rest.empty() && (static_cast<unsigned char>(text[at + rest.size()]) & 0xc0) == 0x80) {
            rest.remove_suffix(1); // a character is shown whole or not at all
        }
    }
    fault += rest.empty() ? "" : " at " + std::string{rest};
    const std::string cause = likely_cause(text, at);
    return fault + (cause.empty() ? "" : "; " + cause);
}

/// Checks the text with Boost.JSON, which also limits how deeply values are nested. JsonPlaces relies on both.
base::Result<void> check_json(std::string_view text) {
    json::stream_parser parser;
    boost::system::error_code error;
    const std::size_t read = parser.write_some(view_of(text), error);
    if (!error && read < text.size() && text.find_first_not_of(" \t\r\n", read) != std::string_view::npos) {
        error = json::error::extra_data;
    }
    if (!error) {
        parser.finish(error);
    }
    if (error) {
        return base::refusal(base::RefusalCode::InvalidArgument,
                             "not JSON: " + json_fault(text, read, error.message()));
    }
    return {};
}

std::string decoded(std::string_view string) {
    boost::system::error_code never;
    const json::value value = json::parse(view_of(string), never);
    return value.is_string() ? std::string{value.get_string()} : std::string{};
}

/// Finds the values of a valid text and their positions, because Boost.JSON returns values without positions.
class JsonPlaces {
  public:
    explicit JsonPlaces(std::string_view text) : text_{text} {}

    JsonNode value() {
        skip_space();
        JsonNode node;
        node.line = line_;
        const std::size_t begin = at_;
        if (const char c = text_[at_]; c == '{' || c == '[') {
            ++at_;
            for (skip_space(); text_[at_] != '}' && text_[at_] != ']'; skip_space()) {
                if (c == '[') {
                    node.elements.push_back(value());
                } else {
                    node.members.push_back(member());
                }
                skip_space();
                at_ += text_[at_] == ',';
            }
            ++at_;
        } else if (c == '"') {
            skip_string();
        } else {
            at_ = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
        }
        node.text = text_.substr(begin, at_ - begin);
        return node;
    }

  private:
    void skip_space() {
        for (; at_ < text_.size() && std::string_view{" \t\r\n"}.find(text_[at_]) != std::string_view::npos; ++at_) {
            line_ += text_[at_] == '\n';
        }
    }
    void skip_string() { // a JSON string contains no line breaks
        for (++at_; text_[at_] != '"';) {
            at_ += text_[at_] == '\\' ? 2 : 1;
        }
        ++at_;
    }
    JsonMember member() {
        const std::size_t begin = at_, line = line_;
        skip_string();
        std::string name = decoded(text_.substr(begin, at_ - begin));
        skip_space();
        ++at_; // the colon
        return {std::move(name), line, value()};
    }

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

template <class Number>
std::optional<Number> number_in(std::string_view text) {
    Number number{};
    const char* const end = text.data() + text.size();
    const auto [read_until, error] = std::from_chars(text.data(), end, number);
    return error == std::errc{} && read_until == end ? std::optional{number} : std::nullopt;
}

} // namespace

const JsonMember* JsonNode::find(std::string_view name) const {
    const auto found = std::ranges::find(members, name, &JsonMember::name);
    return found == members.end() ? nullptr : &*found;
}

std::string JsonNode::string() const {
    return decoded(text);
}

std::optional<std::uint64_t> JsonNode::whole_number() const {
    if (text == "-0") {
        return 0;
    }
    if (const auto digits = number_in<std::uint64_t>(text)) {
        return digits;
    }
    // Programs such as R and NumPy write 30.0 or 1e3. A double below 2^53 is exact.
    const auto number = is_number() ? number_in<double>(text) : std::nullopt;
    const bool whole = number && *number > 0 && *number < 0x1p53 && *number == std::floor(*number);
    return whole ? std::optional{static_cast<std::uint64_t>(*number)} : std::nullopt;
}

double JsonNode::real() const {
    // Boost.JSON does not guarantee the last bit of a number, so it is only used for numbers that no double can
    // represent.
    if (const auto exact = number_in<double>(text)) {
        return *exact;
    }
    boost::system::error_code error;
    const json::value value = json::parse(view_of(text), error);
    return value.is_number() ? value.to_number<double>() : HUGE_VAL;
}

std::string JsonNode::quoted() const {
    constexpr std::size_t bytes_max = 60;
    if (text.size() <= bytes_max) {
        return std::string{text};
    }
    return is_array() ? "a list" : is_object() ? "an object" : "a long string";
}

base::Result<JsonNode> parse_json(std::string_view text) {
    text = without_mark(text);
    if (const auto checked = check_json(text); !checked) {
        return checked.error();
    }
    return JsonPlaces{text}.value();
}

std::string with_line(std::string_view field, std::size_t line) {
    return std::string{field} + " (line " + std::to_string(line) + ")";
}

std::vector<const JsonMember*> unique_members(const JsonNode& object, std::string_view prefix,
                                              std::vector<base::Violation>& violations) {
    std::vector<const JsonMember*> members;
    std::set<std::string_view> seen;
    for (const JsonMember& member : object.members) {
        if (seen.insert(member.name).second) {
            members.push_back(&member);
        } else {
            violations.push_back(
                {with_line(std::string{prefix} + member.name, member.line), "given once", "given twice"});
        }
    }
    return members;
}

} // namespace evod::parameters
