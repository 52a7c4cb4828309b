// Healthiest: the living organisms that do best at a moment.
//
// Owner        none: a function.
// Threads      any.
#pragma once

#include "client/core/client_types.h"

#include <cstddef>
#include <vector>

namespace evod::viewer {

/// Returns the indices of the `count` healthiest organisms, or of all if there are fewer; the healthiest first, and those
/// with equal health by id.
std::vector<std::size_t> healthiest(const codec::Entities& organisms, std::size_t count);

} // namespace evod::viewer
