// Exact: formats a number without loss of precision.
#pragma once

#include <string>

namespace evod::core {

/// Returns the shortest text that parses to the same number: "0.15", "500000". Uses an exponent only if the text would
/// be long without it.
std::string exact(double value);

} // namespace evod::core
