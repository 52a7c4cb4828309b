// World names: chooses a name for a new world.
//
// Owner        none: a function.
// Threads      any.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace evod::viewer {

/// Returns a name that `used` does not contain: `base` itself, or `base` with the smallest number from 2 that is free:
/// "default-2". A number at the end of `base` is replaced: "default-2" leads to "default-3", not to "default-2-2".
std::string unused_name(std::string_view base, std::span<const std::string> used);

} // namespace evod::viewer
