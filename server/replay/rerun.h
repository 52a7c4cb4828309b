// Rerun: simulates a stored run again. Every moment can be computed from the beginning of its generation or a
// checkpoint, and from the journal.
//
// Threads      no threads of its own; it uses those of the executor.
// Determinism  the result has the same bits as the original run. Callers compare the stored state hashes.
#pragma once

#include "server/base/executor.h"
#include "server/base/stop_check.h"
#include "server/run_file/run_file.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace evod::replay {

/// A command that check() accepts before it changes a world.
using CheckedCommand = std::variant<simulation::PlaceEntities, simulation::RemoveEntities, simulation::SetFitness>;

/// Why work ended that a StopCheck has stopped.
base::Refusal cancelled_refusal();

/// A command in the journal that changes a world: it changes parameters, plans such a change, cancels a planned change,
/// places or removes entities, or sets fitness.
struct WorldChange {
    std::uint64_t entry = 0; // number of the command in the journal
    std::uint64_t tick = 0;  // the command was applied after this tick
    std::vector<parameters::Assignment> assignments;
    std::optional<parameters::PlannedMoment> at = std::nullopt; // when the change takes effect; nullopt: at once
    base::Actor by = {};                                        // the client that sent the command
    std::optional<std::uint64_t> cancels = std::nullopt;        // id of the planned change that this command cancels
    // nullptr: it is another command. Copies of the change share it, because it may contain the fitness of an island.
    std::shared_ptr<const CheckedCommand> checked = nullptr;
};

/// Memory of a change, with what it shares with its copies.
std::size_t bytes_of(const WorldChange& change);

/// Reads the changes in a file's journal, in order of ticks. Refused if an entry contains no command, or if
/// its tick is before that of the previous entry.
///
/// after_entry  the journal entries up to and including this one are skipped.
/// stop         stops the work, which is then refused with UNAVAILABLE.
base::Result<std::vector<WorldChange>> world_changes(run_file::RunFile& file, std::uint64_t after_entry = 0,
                                                     const base::StopCheck& stop = {});
/// Like world_changes() above, for entries that have already been read.
///
/// path  path of the file that contains the entries, for error messages.
base::Result<std::vector<WorldChange>> world_changes(const std::string& path,
                                                     std::span<const run_file::JournalEntry> journal);

/// The changes that a world will get at later ticks.
class ComingChanges {
  public:
    /// after_entry  the world already contains the journal entries up to and including this one.
    explicit ComingChanges(std::uint64_t after_entry) : last_entry_{after_entry} {}

    /// Restores the planned changes of a world that are not yet due. Refused if the journal contradicts itself.
    ///
    /// world  contains the journal entries up to and including `after_entry`, but no planned changes.
    static base::Result<void> restore_planned_changes(const std::string& path, std::span<const WorldChange> changes,
                                                      std::uint64_t after_entry, simulation::World& world);

    /// Adds the changes that are new. Refused if a change has values that are invalid in every world.
    ///
    /// path  path of the file that contains the changes, for error messages.
    base::Result<void> extend(const std::string& path, std::span<const WorldChange> changes);
    /// Applies the changes up to the present tick of the world and up to journal entry `last`. After a fault, applies
    /// none.
    void apply_due(simulation::World& world, std::uint64_t last = ~std::uint64_t{0});
    /// Number of the last journal entry that was added.
    std::uint64_t last_entry() const { return last_entry_; }
    /// The number of changes that were not applied yet. The others are not kept.
    std::size_t waiting_count() const { return changes_.size(); }
    /// Memory of the changes that were not applied yet.
    std::size_t held_bytes() const { return bytes_; }
    /// Set if a change cannot have been accepted at its moment, or is missing; the file is then damaged.
    const std::optional<base::Refusal>& fault() const { return fault_; }
    /// Sets fault(): the journal lacks the fitness without which this generation cannot end.
    void fail_without_fitness(std::uint64_t generation);

  private:
    /// Applies one change, as Laboratory applied it. Returns false if Laboratory cannot have accepted the change.
    static bool apply(const WorldChange& change, simulation::World& world);

    std::uint64_t last_entry_;        // number of the last journal entry that was added
    std::string path_;                // path of the file
    std::deque<WorldChange> changes_; // those that were not applied yet
    std::size_t bytes_ = 0;           // their memory
    std::optional<base::Refusal> fault_;
};

class Rerun {
  public:
    /// Returns a rerun at the first moment of a generation. If the beginning of this generation is not retained, the
    /// run is simulated from the last retained beginning before it. Refused if the file is damaged there, follows
    /// another model, or does not contain the generation.
    static base::Result<Rerun> at(run_file::RunFile& file, std::uint64_t generation, base::Executor& executor);
    /// Returns a rerun at the last stored state at or before a moment: a checkpoint, or the beginning of a generation.
    /// Refused for the same reasons as at().
    ///
    /// tick           ticks since the run began; must be within the generation.
    /// history_count  maximum number of previous generations whose statistics the world gets.
    /// stop           stops reading, which is then refused with UNAVAILABLE.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                                      std::size_t history_count, base::Executor& executor,
                                      const base::StopCheck& stop = {});
    /// Like before() above, for a tick that the file contains. Refused for any other tick.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t tick, base::Executor& executor);
    /// Like before() above, for changes that have already been read.
    ///
    /// changes  all changes in the file, as world_changes() returns them. The run must follow the model of this
    ///          program.
    static base::Result<Rerun> before(run_file::RunFile& file, std::uint64_t generation, std::uint64_t tick,
                                      std::span<const WorldChange> changes, std::size_t history_count,
                                      base::Executor& executor);
    /// Returns a rerun at the first moment of a generation, or at one of its checkpoints.
    ///
    /// generation     its beginning must be retained.
    /// checkpoint     a checkpoint of this generation; nullptr: the beginning of the generation or of the file.
    /// changes        all changes in the file, as world_changes() returns them.
    /// history_count  as in before(); if it is 0, the world gets no past changes either.
    static base::Result<Rerun> begun_at(run_file::RunFile& file, std::uint64_t generation,
                                        const run_file::StoredCheckpoint* checkpoint,
                                        std::span<const WorldChange> changes, std::size_t history_count,
                                        base::Executor& executor);
    /// Like begun_at(), for records that have already been read. Uses only the identity from the file.
    ///
    /// begun       a beginning of a generation; refused if it is impossible. The run must follow the model of this
    ///             program.
    /// checkpoint  a checkpoint of this generation, to start from; nullptr: its first tick.
    /// changes     in order of ticks. Changes that `begun` or `checkpoint` already contains are skipped.
    /// past        what the world then reports as its past changes.
    static base::Result<Rerun> from(const run_file::RunFile& file, const run_file::GenerationBegun& begun,
                                    const run_file::StoredCheckpoint* checkpoint, std::span<const WorldChange> changes,
                                    simulation::History history, base::Executor& executor,
                                    simulation::Changes past = {});

    const simulation::World& world() const { return world_; }
    const ComingChanges& changes() const { return changes_; }
    /// Moves the changes out. The rerun must not advance afterwards.
    ComingChanges take_changes() && { return std::move(changes_); }
    /// Ends the rerun and returns its world in the present state.
    simulation::World take() && { return std::move(world_); }

    /// If a generation is over, breeds the next one, as the next tick would.
    void breed_next_generation(base::Executor& executor) { world_.breed_next_generation(executor); }
    /// The state hash after the last tick, before the commands that followed it. Run files contain these hashes.
    const base::StateHash& hash_of_tick() const { return hash_of_tick_; }
    /// Simulates one tick, then applies the changes after it, up to journal entry `last`. The run must not be
    /// over. If the world awaits fitness that the journal does not contain, sets changes().fault() and does nothing.
    void advance_tick(base::Executor& executor, std::uint64_t last = ~std::uint64_t{0});
    /// Applies the remaining changes after the last tick, up to journal entry `last`.
    void apply_changes(std::uint64_t last = ~std::uint64_t{0}) { changes_.apply_due(world_, last); }
    /// Simulates up to and including this tick, up to the end of the run, or up to a fault.
    void advance_to(std::uint64_t tick, base::Executor& executor);

  private:
    Rerun(simulation::World world, ComingChanges changes)
        : world_{std::move(world)}, hash_of_tick_{world_.hash()}, changes_{std::move(changes)} {
        apply_changes();
    }
    /// Reads the changes of a run. Refused if this program cannot simulate the run.
    static base::Result<std::vector<WorldChange>> changes_of(run_file::RunFile& file, const base::StopCheck& stop = {});
    /// after_entry  the world already contains the journal entries up to and including this one.
    static base::Result<Rerun> with_changes(const run_file::RunFile& file, simulation::World world,
                                            std::span<const WorldChange> changes, std::uint64_t after_entry);

    simulation::World world_;
    base::StateHash hash_of_tick_;
    ComingChanges changes_;
};

} // namespace evod::replay
