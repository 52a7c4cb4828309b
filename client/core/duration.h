// How long something lasted, as every program of ours tells it.
#pragma once

#include <string>

namespace evod::core {

/// "12.3 s", "4:05 min", "2:00:00 h".
std::string duration(double seconds);

} // namespace evod::core
