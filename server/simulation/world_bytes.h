// World bytes: an estimate of the memory of a world in this process, to charge it to the client for whom the world
// exists.
#pragma once

#include "server/simulation/world.h"

#include <cstddef>

namespace evod::simulation {

/// Estimates the memory of a world from the numbers of its entities, genes and ended generations. It costs little. The
/// history of a fork or a replay counts fully, although it may share the rows with the original.
std::size_t estimated_bytes(const World& world);

} // namespace evod::simulation
