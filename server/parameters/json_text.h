// JSON text: parses files that people write. Each parsed value contains its line, so that errors can name it.
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

/// A value, and its place in the text that it was parsed from. Valid only while that text exists.
struct JsonNode {
    std::string_view text;           // text of the value
    std::size_t line = 1;            // line where the value begins
    std::vector<JsonMember> members; // members of an object, in order; a repeated name appears several times
    std::vector<JsonNode> elements;  // elements of an array

    bool is_object() const { return text.front() == '{'; }
    bool is_array() const { return text.front() == '['; }
    bool is_string() const { return text.front() == '"'; }
    bool is_number() const { return text.front() == '-' || (text.front() >= '0' && text.front() <= '9'); }

    /// The first member of this name; nullptr if there is none.
    const JsonMember* find(std::string_view name) const;
    /// The characters of a string, with escapes decoded.
    std::string string() const;
    /// The exact value of a number written in digits only; nullopt for other values and for numbers out of range.
    std::optional<std::uint64_t> whole_number() const;
    /// The nearest double of a number. A number beyond the range of double becomes infinite or 0.
    double real() const;
    /// The text of the value for an error message. A long text is replaced by a description.
    std::string quoted() const;
};
struct JsonMember {
    std::string name; // with escapes decoded
    std::size_t line = 1;
    JsonNode value;
};

/// Parses a text that must contain exactly one JSON value. Errors name the line: "not JSON: line 3: …".
base::Result<JsonNode> parse_json(std::string_view text);

/// "mutation_chance (line 4)"
std::string with_line(std::string_view field, std::size_t line);

/// The members of an object, without repeated names. Each repetition adds a violation of the field `prefix` + name.
std::vector<const JsonMember*> unique_members(const JsonNode& object, std::string_view prefix,
                                              std::vector<base::Violation>& violations);

} // namespace evod::parameters
