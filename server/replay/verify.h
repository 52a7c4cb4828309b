// Verify: simulates a run again and compares everything in its file with the result.
//
//   the run's parameters and seed → the first stored generation
//   each generation → its state hashes and checkpoints → fitness, deaths, statistics → the next stored generation
//
// A retained generation is simulated from its stored beginning, and that beginning is compared with the result of the
// generation before. So a stretch, from one retained generation to the next, does not depend on the stretch before. A
// stretch is one generation, or several where the retention has excluded some.
//
// Owner        one thread. It reads several stretches at a time, within a bound on memory.
// Threads      none of its own. The executor simulates the stretches in parallel. If there are fewer stretches than
//              threads, as with large worlds, they run one after another, each with the whole executor.
// Determinism  the result is the first difference of the run, for every executor.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::replay {

/// A moment of the stored run.
struct StoredMoment {
    std::uint64_t generation = 0, tick = 0; // ticks since the run began
};

/// The first difference between the stored and the simulated run.
struct Difference {
    std::optional<StoredMoment> agrees; // the last equal moment; nothing if the beginning differs
    std::string agreeing_part;          // "the state hash"
    StoredMoment differs;
    std::string part; // "the fitness of organism 3 on island 0"
    std::string stored, simulated;
};

/// What has been compared.
struct Verified {
    std::uint64_t generations = 0; // simulated from their beginnings; the last may be unfinished
    std::uint64_t ticks = 0, hashes = 0, checkpoints = 0;
    double simulated_s = 0;
    std::optional<Difference> difference; // nothing: the run agrees with its file
};

/// verify() first reads the whole file, then simulates the run.
struct VerifyProgress {
    std::uint64_t generations = 0, generations_in_all = 0; // read so far
    std::uint64_t ticks = 0, ticks_in_all = 0;             // simulated so far, in any order; 0 while the file is read
};

/// Refused if the file is damaged or follows another model. If a server writes to the file meanwhile, the snapshot at the
/// beginning is verified.
///
/// progress  called now and then by any of the executor's threads, by several at once.
base::Result<Verified> verify(run_file::RunFile& file, base::Executor& executor,
                              base::FunctionRef<void(const VerifyProgress&)> progress);

} // namespace evod::replay
