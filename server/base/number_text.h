// Converts numbers to text for messages, errors and exports.
//
// Threads      any; no state.
// Determinism  independent of the locale.
#pragma once

#include <string>

namespace evod::base {

/// The shortest text that parses back to the same number: "0.1", "1e+20", "nan".
std::string number_text(double value);

} // namespace evod::base
