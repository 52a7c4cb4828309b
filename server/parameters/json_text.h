// JSON text: parses files that people write, and reports errors with their line.
#pragma once

#include "server/base/result.h"

#include <boost/json/value.hpp>

#include <cstddef>
#include <string_view>

namespace evod::parameters {

/// The number of the line, from 1, that contains the character at `offset`.
std::size_t line_of(std::string_view text, std::size_t offset);

/// Parses the one value that the text contains. Refused as an invalid argument, with the line: "not JSON: line 3: …".
base::Result<boost::json::value> parse_json(std::string_view text);

} // namespace evod::parameters
