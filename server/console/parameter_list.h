// The registry of parameters as a table: docs/PARAMETERS.md is what this prints.
#pragma once

#include <string>

namespace evod::console {

/// Markdown, one row a parameter.
std::string parameter_list();

} // namespace evod::console
