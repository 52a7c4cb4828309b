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
        const auto line = 1 + std::ranges::count(text.substr(0, read), '\n');
        return base::refusal(base::RefusalCode::InvalidArgument,
                             "not JSON: line " + std::to_string(line) + ": " + error.message());
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
    return text == "-0" ? std::optional<std::uint64_t>{0} : number_in<std::uint64_t>(text);
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
