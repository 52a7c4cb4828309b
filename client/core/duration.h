// Duration: formats a duration, the same in every program.
#pragma once

#include <string>

namespace evod::core {

/// "12.3 s", "4:05 min", "2:00:00 h".
std::string duration(double seconds);

} // namespace evod::core
