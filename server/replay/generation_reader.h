// Generation reader: generations of a run file, each whole. One that is not held any more is simulated again.
//
// Determinism  the same bits as the first time: what the file still tells of such a generation is compared.
#pragma once

#include "server/base/executor.h"
#include "server/replay/rerun.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

namespace evod::replay {

struct WholeGeneration {
    run_file::GenerationBegun begun;
    std::optional<run_file::GenerationEnded> ended; // nothing while it has not
};

/// Whether a generation that has begun can be told of: what is not held is simulated again, unless it follows another
/// model.
inline bool is_in_reach(run_file::RunFile& file, std::uint64_t generation) {
    return !file.other_model() || file.held_at_or_before(generation) == generation;
}

class GenerationReader {
  public:
    /// file  held still; outlives the reader, as does the executor.
    /// stop  when asked for, what is simulated again is given up: refused with UNAVAILABLE.
    GenerationReader(run_file::RunFile& file, base::Executor& executor, std::stop_token stop = {})
        : file_{file}, executor_{executor}, stop_{std::move(stop)} {}

    /// A generation that has begun; those that are not held are best read in order. Refused where the file is damaged
    /// there, and where what is not held follows another model.
    base::Result<WholeGeneration> read(std::uint64_t generation);

  private:
    base::Result<WholeGeneration> simulate(std::uint64_t generation);
    base::Result<void> stand_before(std::uint64_t generation);
    base::Result<void> advance_tick();
    base::Refusal damaged(std::uint64_t generation, const std::string& what) const;

    run_file::RunFile& file_;
    base::Executor& executor_;
    std::stop_token stop_;
    std::optional<std::vector<ParameterChange>> changes_; // the run's, once they were needed
    std::optional<Rerun> rerun_;                          // in the generation that was simulated last
};

} // namespace evod::replay
