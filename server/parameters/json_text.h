// JSON text: parses files that people write. Each parsed value contains its line, so that errors can name it.
//
// Threads  none of its own.
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

/// A JSON value, and its position in the text from which it was parsed. A JsonNode is valid only while that text
/// exists.
struct JsonNode {
    std::string_view text;           // text of the value
    std::size_t line = 1;            // line where the value begins
    std::vector<JsonMember> members; // members of an object, in order; a repeated name appears several times
    std::vector<JsonNode> elements;  // elements of an array

    bool is_object() const { return text.front() == '{'; }
    bool is_array() const { return text.front() == '['; }
    bool is_string() const { return text.front() == '"'; }
    bool is_number() const { return text.front() == '-' || (text.front() >= '0' && text.front() <= '9'); }

    /// Returns the first member with this name; nullptr if there is none.
    const JsonMember* find(std::string_view name) const;
    /// Returns the characters of a string, with escapes decoded.
    std::string string() const;
    /// Returns the exact value of a whole number. It may also be written as 30.0 or 1e3, then below 2^53. Returns
    /// nullopt for other values and for numbers out of range.
    std::optional<std::uint64_t> whole_number() const;
    /// Returns the double nearest to a number: infinity or 0 if the number is beyond the range of double.
    double real() const;
    /// Returns the text of the value for an error message; instead of a long text, a description.
    std::string quoted() const;
};
struct JsonMember {
    std::string name; // with escapes decoded
    std::size_t line = 1;
    JsonNode value;
};

/// Parses a text of one JSON value, after a byte order mark or none. Errors: "not JSON: line 3, column 1: … at }; …".
base::Result<JsonNode> parse_json(std::string_view text);

/// Returns, for example, "mutation_chance (line 4)".
std::string with_line(std::string_view field, std::size_t line);

/// Returns the members of an object without those that repeat a name. Each of these adds a violation of the field
/// `prefix` + name.
std::vector<const JsonMember*> unique_members(const JsonNode& object, std::string_view prefix,
                                              std::vector<base::Violation>& violations);

} // namespace evod::parameters
