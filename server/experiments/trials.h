// Trials: executes independent runs, several at a time, and derives the seeds of replicates.
//
// Threads      one thread executes a trial from beginning to end. Many independent runs with one thread each use all
//              cores better than one run with many threads.
// Determinism  the scheduler decides which thread executes a trial, so the work of a trial may depend only on its
//              index.
#pragma once

#include "server/base/random.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace evod::experiments {

/// Calls work(index) for 0 … count − 1 on `jobs` threads. The calls begin in order of index. After stopped() has
/// returned true, no further call begins. Returns when all calls have returned.
///
/// jobs     >= 1.
/// stopped  may be called by several threads at the same time.
void for_each_trial(std::size_t count, std::size_t jobs, const std::function<void(std::size_t index)>& work,
                    const std::function<bool()>& stopped);

/// The seed of a replicate, derived from the seed of the sweep or comparison. It is the same in every cell, so that
/// cells can be compared pair by pair (common random numbers). It is below 2^53 (base::portable_seed()).
base::Seed replicate_seed(base::Seed seed, std::uint32_t replicate);

} // namespace evod::experiments
