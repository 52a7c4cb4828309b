// Rerun: a run simulated again from its file: every moment follows from the beginning of its generation and the
// journal.
//
// Determinism  the same bits as the first time; whoever has a stored hash compares.
#pragma once

#include "server/base/executor.h"
#include "server/storage/run_file.h"

#include <vector>

namespace evod::storage {

class Rerun {
  public:
    /// At the first moment of a generation that the run has begun; if its beginning is not held any more, it is
    /// simulated from the last one before it that is. Refused if the file is damaged there, follows another model, or
    /// has no such generation.
    static base::Result<Rerun> at(RunFile& file, std::uint64_t generation, base::Executor& executor);

    const simulation::World& world() const { return world_; }
    /// Ends the rerun: the world as it is.
    simulation::World take() && { return std::move(world_); }

    /// One tick, then the changes of parameters that came after it. Not to be called where the run was over.
    void advance_tick(base::Executor& executor);
    /// Until that tick is over, or the run is.
    void advance_to(std::uint64_t tick, base::Executor& executor);

  private:
    struct Change {
        std::uint64_t tick; // after which it came
        simulation::SetParameters command;
    };
    Rerun(simulation::World world, std::vector<Change> changes)
        : world_{std::move(world)}, changes_{std::move(changes)} {}
    void make_changes();

    simulation::World world_;
    std::vector<Change> changes_; // in order, from next_ to come
    std::size_t next_ = 0;
};

/// A world as its file last tells of it.
struct Recovered {
    simulation::World world;
    simulation::RunControl control;
    std::vector<JournalEntry> journal;
};

/// Brings a world back at the last moment that the file tells of. Refused where Rerun::at is, and where the state hash
/// there is not the stored one.
base::Result<Recovered> recover(RunFile& file, base::Executor& executor);

} // namespace evod::storage
