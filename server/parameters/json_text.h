// JSON text: what people write in files, with the line of what is wrong in it.
#pragma once

#include "server/base/result.h"

#include <boost/json/value.hpp>

#include <cstddef>
#include <string_view>

namespace evod::parameters {

/// Of the character at `offset`, from 1.
std::size_t line_of(std::string_view text, std::size_t offset);

/// The one value that the text holds. Refused, as an invalid argument, with the line: "not JSON: line 3: …".
base::Result<boost::json::value> parse_json(std::string_view text);

} // namespace evod::parameters
