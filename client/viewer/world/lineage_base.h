// Lineage base: chooses the generation from which the lineages of each generation are counted.
//
// At first, lineages are counted from the first known generation. After some generations one lineage takes over: it
// contains `taken_over_share` of the organisms of the island or more. From then on, lineages are counted from a later
// generation, until one of the new lineages takes over. The new generation is the earliest one, at most
// `generations_back` before the takeover, from which no lineage has taken over.
//
// Threads      none; pure functions.
#pragma once

#include "client/viewer/world/lineage.h"

#include <cstdint>
#include <vector>

namespace evod::viewer {

constexpr double taken_over_share = 0.9;
constexpr std::uint64_t generations_back = 10;

/// Returns, for every known generation from the first one on, the generation from which the lineages of an island are
/// counted.
std::vector<std::uint64_t> lineage_bases(const Lineage& lineage, std::uint32_t island);

} // namespace evod::viewer
