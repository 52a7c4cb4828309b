// A number as text from which nothing is lost.
#pragma once

#include <string>

namespace evod::core {

/// Shortest text that reads back as the same number, without an exponent where that is not long: "0.15", "500000".
std::string exact(double value);

} // namespace evod::core
