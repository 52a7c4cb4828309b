// Exact: formats a number without loss.
#pragma once

#include <string>

namespace evod::core {

/// Returns the shortest text that parses to the same number, without an exponent unless it would be long: "0.15", "500000".
std::string exact(double value);

} // namespace evod::core
