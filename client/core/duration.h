// Duration: formats a duration for the user; all programs use this format.
#pragma once

#include <string>

namespace evod::core {

/// Formats a duration: "12.3 s", "4:05 min", "2:00:00 h".
std::string duration(double seconds);

} // namespace evod::core
