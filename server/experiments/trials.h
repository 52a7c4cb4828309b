// Trials: independent runs, several at a time, and the seeds of replicates.
//
// Threads      one thread does a trial from beginning to end. Independent runs on one thread each use all cores better
//              than one run on several threads.
// Determinism  the scheduler decides which thread does which trial, so the work of a trial may depend on its index
//              only.
#pragma once

#include "server/base/random.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace evod::experiments {

/// Calls work(index) for 0 … count − 1 on `jobs` threads, begun in order of index. Begins no further call after
/// stopped() has returned true. Returns when all calls have returned.
///
/// jobs     >= 1.
/// stopped  called on several threads at once.
void for_each_trial(std::size_t count, std::size_t jobs, const std::function<void(std::size_t index)>& work,
                    const std::function<bool()>& stopped);

/// The seed of a replicate, derived from the seed of the sweep or comparison. It is the same in every cell, so that
/// cells can be compared pair by pair (common random numbers).
base::Seed replicate_seed(base::Seed seed, std::uint32_t replicate);

} // namespace evod::experiments
