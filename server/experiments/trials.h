// Trials: many independent runs, several at a time, and the seeds of those that are repeated.
//
// Threads      each trial is the affair of one of them from beginning to end: runs that know nothing of each other need
//              no executor between them, and keep all cores busy until the last but `jobs` has ended.
// Determinism  which thread gets which trial is chance, so what a trial does may depend on its number alone.
#pragma once

#include "server/base/random.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace evod::experiments {

/// Calls work(index) for 0 … count − 1, at most `jobs` at a time, each on one of `jobs` threads, in order of index;
/// hands out no more once stopped() is true (asked on several threads). Returns when all that were begun have returned.
///
/// jobs  >= 1.
void for_each_trial(std::size_t count, std::size_t jobs, const std::function<void(std::size_t index)>& work,
                    const std::function<bool()>& stopped);

/// The seed of a replicate, derived from that of the whole; the same for every cell, so that cells can be compared
/// pairwise (common random numbers).
base::Seed replicate_seed(base::Seed seed, std::uint32_t replicate);

} // namespace evod::experiments
