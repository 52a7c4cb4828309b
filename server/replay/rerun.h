// Rerun: simulates a stored run again. Every moment follows from the beginning of its generation or a checkpoint, and
// from the journal.
//
// Threads      none of its own; the executor's.
// Determinism  the same bits as the first time. Callers compare the stored state hashes.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <span>
#include <vector>

namespace evod::replay {

/// A command of the journal that changes parameters, plans such a change, or cancels a planned one.
struct ParameterChange {
    std::uint64_t entry = 0; // its number in the journal
    std::uint64_t tick = 0;  // after which it was applied
    std::vector<parameters::Assignment> assignments;
    std::optional<parameters::PlannedMoment> at = std::nullopt; // when the change takes place; nothing: at once
    std::string by = {};                                        // the user who planned it
    std::optional<std::uint64_t> cancels = std::nullopt;        // the id of the planned change that it cancels
};

/// The changes in a file's journal, in order of ticks. Refused if an entry is no command, or its tick is before that of
/// the previous entry.
///
/// after_entry  entries up to this one are skipped.
base::Result<std::vector<ParameterChange>> parameter_changes(run_file::RunFile& file, std::uint64_t after_entry = 0);
/// The same for entries that have been read.
///
/// path  of their file, for error messages.
base::Result<std::vector<ParameterChange>> parameter_changes(const std::string& path,
                                                             std::span<const run_file::JournalEntry> journal);

/// The changes of a world's parameters from some moment on.
class ComingChanges {
  public:
    /// after_entry  the world contains the journal's entries up to this one.
    explicit ComingChanges(std::uint64_t after_entry) : last_entry_{after_entry} {}

    /// Restores the planned changes of a world that are not due yet. Refused if the journal cannot be right.
    ///
    /// world        contains the journal's entries up to `after_entry`, except planned changes.
    static base::Result<void> plan_again(const std::string& path, std::span<const ParameterChange> changes,
                                         std::uint64_t after_entry, simulation::World& world);

    /// Adds the changes that are new. Refused if one has values that no world can have.
    ///
    /// path  of their file, for error messages.
    base::Result<void> extend(const std::string& path, std::span<const ParameterChange> changes);
    /// Applies the changes up to the world's present tick and up to the journal's entry `last`; none after a fault.
    void make_due(simulation::World& world, std::uint64_t last = ~std::uint64_t{0});
    /// Number of the last journal entry that was added.
    std::uint64_t last_entry() const { return last_entry_; }
    /// Set when a change cannot have been accepted with the parameters of that moment: the file is damaged.
    const std::optional<base::Refusal>& fault() const { return fault_; }

  private:
    /// Applies one change as Laboratory did; false: Laboratory cannot have accepted it.
    static bool make(const ParameterChange& change, simulation::World& world);

    std::uint64_t last_entry_; // that was added
    std::string path_;         // of its file
    std::vector<ParameterChange> changes_;
    std::size_t next_ = 0; // of changes_
    std::optional<base::Refusal> fault_;
};

class Rerun {
  public:
    /// A rerun at the first moment of a generation. If its beginning is not retained, it is simulated from the last one
    /// before it that is. Refused if the file is damaged there, follows another model, or has no such generation.
    static base::Result<Rerun> at(run_file::RunFile& file, std::uint64_t generation, base::Executor& executor);
    /// A rerun at the last stored state up to a moment: a checkpoint, or the beginning of a generation. Refused as at()
    /// is.
    ///
    /// tick           since the run began; in that generation.
    /// history_count  the world gets the statistics of at most so many generations before.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                                      std::size_t history_count, base::Executor& executor);
    /// The same for a tick that the file contains; refused for any other.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t tick, base::Executor& executor);
    /// The same from changes that have been read.
    ///
    /// changes  all of the file, as parameter_changes() returns them; the run follows this program's model.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                                      std::span<const ParameterChange> changes, std::size_t history_count,
                                      base::Executor& executor);
    /// A rerun at the first moment of a generation, or at a checkpoint of it.
    ///
    /// generation     its beginning is retained.
    /// checkpoint     of that generation; nullptr: its beginning, or that of the file.
    /// changes        all of the file, as parameter_changes() returns them.
    /// history_count  as in before().
    static base::Result<Rerun> begun_at(run_file::RunFile& file, std::uint64_t generation,
                                        const run_file::StoredCheckpoint* checkpoint,
                                        std::span<const ParameterChange> changes, std::size_t history_count,
                                        base::Executor& executor);
    /// The same from records that have been read; of the file it uses only the identity.
    ///
    /// begun       a valid beginning of a generation; the run follows this program's model.
    /// checkpoint  of that generation, to start from; nullptr: its first tick.
    /// changes     in order of ticks; those that `begun` or `checkpoint` already contains are skipped.
    static base::Result<Rerun> from(const run_file::RunFile& file, const run_file::GenerationBegun& begun,
                                    const run_file::StoredCheckpoint* checkpoint,
                                    std::span<const ParameterChange> changes, simulation::World::History history,
                                    base::Executor& executor);

    const simulation::World& world() const { return world_; }
    const ComingChanges& changes() const { return changes_; }
    /// Ends the rerun: the world as it is.
    simulation::World take() && { return std::move(world_); }

    /// Breeds the next generation if one is over, as the next tick would.
    void turn_over(base::Executor& executor) { world_.turn_over(executor); }
    /// One tick, then the changes of parameters after it, up to the journal's entry `last`. The run is not over.
    void advance_tick(base::Executor& executor, std::uint64_t last = ~std::uint64_t{0});
    /// The remaining changes after the last tick.
    void make_changes(std::uint64_t last = ~std::uint64_t{0}) { changes_.make_due(world_, last); }
    /// Up to and including that tick, or the end of the run.
    void advance_to(std::uint64_t tick, base::Executor& executor);

  private:
    Rerun(simulation::World world, ComingChanges changes) : world_{std::move(world)}, changes_{std::move(changes)} {
        make_changes();
    }
    /// The changes of parameters of a run that this program can simulate.
    static base::Result<std::vector<ParameterChange>> changes_of(run_file::RunFile& file);
    /// after_entry  the world contains the journal's entries up to this one.
    static base::Result<Rerun> with_changes(const run_file::RunFile& file, simulation::World world,
                                            std::span<const ParameterChange> changes, std::uint64_t after_entry);

    simulation::World world_;
    ComingChanges changes_;
};

} // namespace evod::replay
