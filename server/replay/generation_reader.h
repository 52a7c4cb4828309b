// Generation reader: reads whole generations of a run file. If a generation is not retained, simulates it again.
//
// Determinism  a simulated generation has the same bits as the original. Its stored statistics are compared.
#pragma once

#include "server/base/executor.h"
#include "server/base/stop_check.h"
#include "server/replay/rerun.h"
#include "server/run_file/run_file.h"

#include <optional>
#include <utility>
#include <vector>

namespace evod::replay {

struct WholeGeneration {
    // born includes the organisms that were placed or born during the generation. They come last and have no `parents`.
    run_file::GenerationBegun begun;
    std::optional<run_file::GenerationEnded> ended; // nullopt if the generation has not ended
    // Per island: the ticks of the generation after which the placed organisms were placed, in order of id.
    std::vector<std::vector<std::uint32_t>> placed = {};
    // With births: per island, the births of these organisms.
    std::vector<std::vector<simulation::Birth>> births = {};
};

/// What a reader does not need: a file contains no chromosomes of the organisms that are born during an interval, so
/// these need a simulation. Without them, they are 0.
enum class Chromosomes { OfAll, OfBeginning };

/// Whether a generation that has begun can be read without a simulation: it is retained. With births also: the
/// interval has ended, because only then its births are stored.
inline bool is_stored(run_file::RunFile& file, std::uint64_t generation, Chromosomes needed) {
    return file.retention().at_or_before(generation) == generation &&
           (!parameters::has_births(file.identity().parameters) ||
            (needed == Chromosomes::OfBeginning && generation <= file.generations().last_ended()));
}
/// Whether a generation that has begun can be read: it is stored, or this program can simulate it again.
inline bool can_be_read(run_file::RunFile& file, std::uint64_t generation,
                        Chromosomes needed = Chromosomes::OfBeginning) {
    return is_stored(file, generation, needed) || !file.other_model();
}

/// Refused if the file does not contain the beginning of a generation up to its last one. If the number of the last one
/// is damaged, it may be very large.
base::Result<void> expect_generation(run_file::RunFile& file, std::uint64_t generation);

class GenerationReader {
  public:
    /// file  must have a pinned snapshot. The file and the executor must outlive the reader.
    /// stop  stops the work; then read() is refused with UNAVAILABLE.
    GenerationReader(run_file::RunFile& file, base::Executor& executor, base::StopCheck stop = {},
                     Chromosomes needed = Chromosomes::OfBeginning)
        : file_{file}, executor_{executor}, stop_{std::move(stop)}, needed_{needed} {}

    /// Reads a generation that has begun. Reading generations that are not retained is fastest in ascending order.
    /// Refused if the file is damaged there, or if the generation is not retained and follows another model.
    base::Result<WholeGeneration> read(std::uint64_t generation);

  private:
    base::Result<WholeGeneration> read_stored(std::uint64_t generation);
    base::Result<WholeGeneration> simulate(std::uint64_t generation);
    bool has_births() const { return parameters::has_births(file_.identity().parameters); }
    base::Result<void> check_outcome(std::uint64_t generation, const WholeGeneration& whole);
    /// Adds the organisms that were placed during the generation.
    base::Result<void> add_placed(std::uint64_t generation, WholeGeneration& whole);
    /// With births: adds the organisms that were born or placed during the interval.
    base::Result<void> add_born(std::uint64_t generation, WholeGeneration& whole) const;
    /// Adds those of the simulated world.
    void add_simulated(WholeGeneration& whole);
    base::Result<void> read_changes();
    base::Result<void> advance_to_generation(std::uint64_t generation);
    base::Result<void> advance_tick();
    base::Refusal damaged(std::uint64_t generation, const std::string& what) const;

    run_file::RunFile& file_;
    base::Executor& executor_;
    const base::StopCheck stop_;
    const Chromosomes needed_;
    std::optional<std::vector<WorldChange>> changes_; // changes of the run; read at the first use
    std::optional<Rerun> rerun_;                      // a world in the generation that was simulated last
};

} // namespace evod::replay
