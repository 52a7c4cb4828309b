// Rerun: a run simulated again from its file: every moment follows from the beginning of its generation, or a
// checkpoint, and the journal.
//
// Determinism  the same bits as the first time; whoever has a stored hash compares.
#pragma once

#include "server/base/executor.h"
#include "server/run_file/run_file.h"

#include <span>
#include <vector>

namespace evod::replay {

/// A change of parameters that a journal tells of, made there or planned; or that one is not to be made any more.
struct ParameterChange {
    std::uint64_t entry = 0; // its number in the journal
    std::uint64_t tick = 0;  // after which it came
    std::vector<parameters::Assignment> assignments;
    std::optional<parameters::PlannedMoment> at = std::nullopt; // when it is to be made; nothing: there
    std::string by = {};                                        // who plans it
    std::optional<std::uint64_t> cancels = std::nullopt;        // what is not to be made; nothing: it is a change
};

/// Those of a file's journal, in order of ticks. Refused where an entry is no command, or earlier than the one before.
///
/// after_entry  the entries up to this one are not read.
base::Result<std::vector<ParameterChange>> parameter_changes(run_file::RunFile& file, std::uint64_t after_entry = 0);
/// The same for entries that have been read.
///
/// path  of their file, for error messages.
base::Result<std::vector<ParameterChange>> parameter_changes(const std::string& path,
                                                             std::span<const run_file::JournalEntry> journal);

/// What was asked of a world's parameters from some moment on, and when.
class ComingChanges {
  public:
    /// after_entry  the journal's entries up to this one are in the world already.
    explicit ComingChanges(std::uint64_t after_entry) : last_entry_{after_entry} {}

    /// Has a world wait for what was planned before that moment, and is not due yet. Refused if that cannot have been.
    ///
    /// world        at that moment.
    /// after_entry  what the journal's entries up to this one asked for at once is in it already.
    static base::Result<void> plan_again(const std::string& path, std::span<const ParameterChange> changes,
                                         std::uint64_t after_entry, simulation::World& world);

    /// Takes in those that are new. Refused if one asks for values that no world can have.
    ///
    /// path  of the file that tells of them.
    base::Result<void> extend(const std::string& path, std::span<const ParameterChange> changes);
    /// Makes those that came after the tick at which the world is now, up to the journal's entry `last`; none any more
    /// once there is a fault.
    void make_due(simulation::World& world, std::uint64_t last = ~std::uint64_t{0});
    /// Number of the last entry of the journal that asked for one that was taken in.
    std::uint64_t last_entry() const { return last_entry_; }
    /// That a change cannot have been accepted with the parameters that held then: the file is damaged.
    const std::optional<base::Refusal>& fault() const { return fault_; }

  private:
    /// Whether it can be made there, as Laboratory accepted it.
    static bool make(const ParameterChange& change, simulation::World& world);

    std::uint64_t last_entry_; // that was taken in
    std::string path_;         // of the file that told of it
    std::vector<ParameterChange> changes_;
    std::size_t next_ = 0; // of changes_
    std::optional<base::Refusal> fault_;
};

class Rerun {
  public:
    /// At the first moment of a generation that the run has begun, or of what the file tells of it; if its beginning is
    /// not held any more, it is simulated from the last one before it that is. Refused if the file is damaged there,
    /// follows another model, or has no such generation.
    static base::Result<Rerun> at(run_file::RunFile& file, std::uint64_t generation, base::Executor& executor);
    /// At the last moment from which that one can be simulated without what comes before: a checkpoint, or the
    /// beginning of a generation. Refused as at() is.
    ///
    /// tick           since the run began; in that generation.
    /// history_count  of how many generations before it the statistics are known to the world, at most.
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
    /// At the first moment of a generation, or at a checkpoint of it.
    ///
    /// generation     whose beginning is held.
    /// checkpoint     of that generation; nullptr: its beginning, or that of the file.
    /// changes        all of the file, as parameter_changes() gives them.
    /// history_count  as in before().
    static base::Result<Rerun> begun_at(run_file::RunFile& file, std::uint64_t generation,
                                        const run_file::StoredCheckpoint* checkpoint,
                                        std::span<const ParameterChange> changes, std::size_t history_count,
                                        base::Executor& executor);
    /// The same from what has been read; of the file only its identity is looked at.
    ///
    /// begun       what can be the beginning of a generation; the run's own model is this program's.
    /// checkpoint  of that generation, where to begin; nullptr: with its first tick.
    /// changes     in order of ticks; those that `begun` or `checkpoint` has in it already are left out.
    static base::Result<Rerun> from(const run_file::RunFile& file, const run_file::GenerationBegun& begun,
                                    const run_file::StoredCheckpoint* checkpoint,
                                    std::span<const ParameterChange> changes, simulation::World::History history,
                                    base::Executor& executor);

    const simulation::World& world() const { return world_; }
    const ComingChanges& changes() const { return changes_; }
    /// Ends the rerun: the world as it is.
    simulation::World take() && { return std::move(world_); }

    /// Breeds the next generation, if one is over, as the next tick would.
    void turn_over(base::Executor& executor) { world_.turn_over(executor); }
    /// One tick, then the changes of parameters that came after it, up to the journal's entry `last`. Not to be called
    /// where the run was over.
    void advance_tick(base::Executor& executor, std::uint64_t last = ~std::uint64_t{0});
    /// The rest of those that came after the last tick.
    void make_changes(std::uint64_t last = ~std::uint64_t{0}) { changes_.make_due(world_, last); }
    /// Until that tick is over, or the run is.
    void advance_to(std::uint64_t tick, base::Executor& executor);

  private:
    Rerun(simulation::World world, ComingChanges changes) : world_{std::move(world)}, changes_{std::move(changes)} {
        make_changes();
    }
    /// The changes of parameters of a run that this program can simulate.
    static base::Result<std::vector<ParameterChange>> changes_of(run_file::RunFile& file);
    /// after_entry  up to this entry of the journal, changes are in the world already.
    static base::Result<Rerun> with_changes(const run_file::RunFile& file, simulation::World world,
                                            std::span<const ParameterChange> changes, std::uint64_t after_entry);

    simulation::World world_;
    ComingChanges changes_;
};

} // namespace evod::replay
