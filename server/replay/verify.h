// Verify: a run simulated again, and everything that its file tells of it held against that.
//
//   the run's beginning → the first generation, as it is stored
//   each generation → its state hashes and checkpoints → fitness, deaths, statistics → the next generation, as it is
//   stored
//
// A generation that is held whole is simulated from what is stored, and is itself held against what the one before
// gives; so stretches from one such generation to the next need not wait for one another. A stretch is one generation,
// or, where a file has been thinned, several.
//
// Owner        one thread, which reads the file: some stretches at once, as many as memory should hold.
// Threads      none of its own. Those stretches go to the executor, each to one thread; where they are fewer than its
//              threads, as with large worlds, they are simulated one after another, each with the whole executor.
// Determinism  what is told is the first difference of all, whatever the executor.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::replay {

/// A moment that a file tells of.
struct StoredMoment {
    std::uint64_t generation = 0, tick = 0; // ticks since the run began
};

/// Where what is stored parts from what is simulated.
struct Difference {
    std::optional<StoredMoment> agrees; // the last before; nothing if not even the run's beginning does
    std::string agreeing_part;          // "the state hash"
    StoredMoment differs;
    std::string part; // "the fitness of organism 3 on island 0"
    std::string stored, simulated;
};

/// What has been held against a new simulation.
struct Verified {
    std::uint64_t generations = 0; // from their beginnings; the last may be unfinished
    std::uint64_t ticks = 0, hashes = 0, checkpoints = 0;
    double simulated_s = 0;
    std::optional<Difference> difference; // nothing: all agrees
};

/// First the file is read through, then its run is simulated again.
struct VerifyProgress {
    std::uint64_t generations = 0, generations_in_all = 0; // read by now
    std::uint64_t ticks = 0, ticks_in_all = 0;             // simulated by now, in whatever order; 0 while it is read
};

/// Refused where the file is damaged or follows another model. A server may go on writing to it: what was there at
/// first is verified.
///
/// told  called every now and then, by any of the executor's threads, several at once.
base::Result<Verified> verify(run_file::RunFile& file, base::Executor& executor,
                              base::FunctionRef<void(const VerifyProgress&)> told);

} // namespace evod::replay
