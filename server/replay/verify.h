// Verify: simulates a run again and compares the result with everything in its file.
//
//   the run's parameters and seed → the first stored generation
//   each generation → its state hashes and checkpoints → fitness, deaths, statistics → the next stored generation
//
// The simulation of a retained generation starts from its stored beginning. That beginning is compared with the result
// of the previous generation. A stretch reaches from one retained generation to the next. It is one generation, or
// several if the retention excludes some. So each stretch can be verified independently of the previous one.
//
// Owner        one thread. It reads several stretches at a time; a limit bounds their memory.
// Threads      none of its own. The executor simulates the stretches in parallel. If there are fewer stretches than
//              threads, which is typical of large worlds, the stretches run one after another, each on all threads.
// Determinism  the result is the first difference in the run, for every executor.
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
    std::optional<StoredMoment> agrees; // the last moment without a difference; nullopt if the beginning differs
    std::string agreeing_part;          // the part that agreed there, such as "the state hash"
    StoredMoment differs;
    std::string part; // "the fitness of organism 3 on island 0"
    std::string stored, simulated;
};

/// What has been compared, and the result.
struct Verified {
    std::uint64_t generations = 0; // generations simulated from their beginnings; the last one may be unfinished
    std::uint64_t ticks = 0, hashes = 0, checkpoints = 0;
    double simulated_s = 0;
    std::optional<Difference> difference; // nullopt: the run agrees with its file
};

/// Progress of verify(). It first reads the whole file, then simulates the run.
struct VerifyProgress {
    std::uint64_t generations = 0, generations_in_all = 0; // read so far
    std::uint64_t ticks = 0, ticks_in_all = 0;             // simulated so far, in any order; 0 during reading
};

/// Refused if the file is damaged or follows another model. If a server writes to the file at the same time, verify()
/// uses the snapshot at its start.
///
/// progress  called from time to time by the threads of the executor, several at once.
base::Result<Verified> verify(run_file::RunFile& file, base::Executor& executor,
                              base::FunctionRef<void(const VerifyProgress&)> progress);

} // namespace evod::replay
