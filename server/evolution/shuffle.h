// Shuffle: puts items in a random order, every order equally likely. Many items are shuffled in parts, in parallel.
//
// Determinism  the parts depend on the number of items, not on threads.
// Source       Fisher & Yates (Durstenfeld 1964); for many items, Rao 1961 and Sandelius 1962: each item goes into one
//              of several buckets, each equally likely, and then each bucket is shuffled.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"

#include <cstdint>
#include <span>

namespace evod::evolution {

/// The maximum number of items that are shuffled as a whole, not in parts.
constexpr std::size_t shuffled_whole_max = 65536;

/// Shuffles `items`, drawing from `random`. More than shuffled_whole_max items draw from separate streams instead,
/// which are keyed by one number from `random`.
void shuffle(std::span<std::uint32_t> items, base::RandomStream& random, base::Executor& executor);

} // namespace evod::evolution
