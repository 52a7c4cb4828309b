// Generation reader: reads whole generations of a run file, and simulates those that are not retained.
//
// Determinism  the same bits as the first time; the stored statistics of such a generation are compared.
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
    std::optional<run_file::GenerationEnded> ended; // nothing before its end
};

/// Whether a generation that has begun can be read: it is retained, or this program can simulate it again.
inline bool is_in_reach(run_file::RunFile& file, std::uint64_t generation) {
    return !file.other_model() || file.retention().at_or_before(generation) == generation;
}

class GenerationReader {
  public:
    /// file  with a pinned snapshot; file and executor outlive the reader.
    /// stop  cancels the simulation: read() is refused with UNAVAILABLE.
    GenerationReader(run_file::RunFile& file, base::Executor& executor, std::stop_token stop = {})
        : file_{file}, executor_{executor}, stop_{std::move(stop)} {}

    /// Reads a generation that has begun. Generations that are not retained are cheapest in order. Refused if the file is
    /// damaged there, or the generation is not retained and follows another model.
    base::Result<WholeGeneration> read(std::uint64_t generation);

  private:
    base::Result<WholeGeneration> simulate(std::uint64_t generation);
    base::Result<void> advance_to_generation(std::uint64_t generation);
    base::Result<void> advance_tick();
    base::Refusal damaged(std::uint64_t generation, const std::string& what) const;

    run_file::RunFile& file_;
    base::Executor& executor_;
    std::stop_token stop_;
    std::optional<std::vector<ParameterChange>> changes_; // of the run; read when first needed
    std::optional<Rerun> rerun_;                          // in the last simulated generation
};

} // namespace evod::replay
