// JSON text: parses files that people write into values that know their line, so that errors can name it.
//
// Threads  none.
#pragma once

#include "server/base/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::parameters {

struct JsonMember;

/// A value, and its place in the text that it was parsed from. Valid as long as that text.
struct JsonNode {
    std::string_view text;           // of the value
    std::size_t line = 1;            // where it begins
    std::vector<JsonMember> members; // of an object, in order; a repeated name appears several times
    std::vector<JsonNode> elements;  // of an array

    bool is_object() const { return text.front() == '{'; }
    bool is_array() const { return text.front() == '['; }
    bool is_string() const { return text.front() == '"'; }
    bool is_number() const { return text.front() == '-' || (text.front() >= '0' && text.front() <= '9'); }

    /// The first member of this name; nullptr if there is none.
    const JsonMember* find(std::string_view name) const;
    /// The characters of a string, with escapes decoded.
    std::string string() const;
    /// The exact value of a number that is written as digits; nullopt for other values, and out of range.
    std::optional<std::uint64_t> whole_number() const;
    /// The nearest double of a number. A number beyond the range of double becomes infinite or 0.
    double real() const;
    /// The text for an error message; a long one is only described.
    std::string quoted() const;
};
struct JsonMember {
    std::string name; // with escapes decoded
    std::size_t line = 1;
    JsonNode value;
};

/// Parses the one value that the text contains. Refused as an invalid argument, with the line: "not JSON: line 3: …".
base::Result<JsonNode> parse_json(std::string_view text);

/// "mutation_chance (line 4)"
std::string with_line(std::string_view field, std::size_t line);

/// The members of an object, each name once. A repetition becomes a violation of the field `prefix` + name.
std::vector<const JsonMember*> unique_members(const JsonNode& object, std::string_view prefix,
                                              std::vector<base::Violation>& violations);

} // namespace evod::parameters
