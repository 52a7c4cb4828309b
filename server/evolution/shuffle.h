// Shuffle: every order of many equally likely, a large number of them in parts that run side by side.
//
// Determinism  the parts are a matter of the number of items, not of threads.
// Source       Fisher & Yates (Durstenfeld 1964); for many, Rao 1961 and Sandelius 1962: everyone goes into one of some
//              buckets, each equally likely, and then each bucket is shuffled.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"

#include <cstdint>
#include <span>

namespace evod::evolution {

/// As many as this are shuffled as a whole.
constexpr std::size_t shuffled_whole_max = 65536;

/// Shuffles, drawing from `random`; more than shuffled_whole_max draw from streams of their own, keyed by one number of
/// `random`.
void shuffle(std::span<std::uint32_t> items, base::RandomStream& random, base::Executor& executor);

} // namespace evod::evolution
