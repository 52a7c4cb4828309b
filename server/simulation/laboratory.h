// Laboratory: all worlds of a server, each with its run control. Commands are applied here, between two ticks.
//
// Owner        the simulation thread or `evod run`; no other thread uses a laboratory.
// Determinism  run control (goals, pause, speed) decides when a world advances, never what happens in a tick. It is not
//              part of the state hash.
#pragma once

#include "server/base/executor.h"
#include "server/base/result.h"
#include "server/simulation/class_rules.h"
#include "server/simulation/commands.h"
#include "server/simulation/events.h"
#include "server/simulation/world.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::simulation {

constexpr std::size_t worlds_max_by_default = 256;

enum class RunState { Waiting, Running, Paused, Terminated };

/// The run control of a world: its goals, pause and requested speed.
struct RunControl {
    bool endless = false;                          // run without end; excludes until_generation
    std::optional<std::uint64_t> until_generation; // run until this many generations have ended
    std::optional<std::uint64_t> until_tick;       // step: run until this tick, then pause
    bool paused = false;
    bool leased = false;     // the pause or step lasts only until the lease ends
    std::uint64_t lease = 0; // number of the lease; each RunUntilTick that grants or extends one gives it a new number
    Speed speed = 1.0;
};

/// Removes the goals that the world has reached. A goal in ticks also pauses the world. Returns whether a goal was
/// removed.
bool remove_reached_goals(RunControl& control, const World& world);

/// The extent of a replay: a world that shows the run of a run file.
struct Replay {
    std::string replay_of; // the world whose run the replay shows; empty if the laboratory has no world with that run
    std::uint64_t first_generation = 1, last_generation = 1;
    std::uint64_t first_tick = 0, last_tick = 0;
};

/// Whether the storage thread keeps up with the worlds.
enum class StorageState {
    KeepsUp,
    Behind,  // storage is slower than the worlds, which wait for it
    Failing, // nothing can be written: commands are refused, worlds continue
    Stalled, // nothing can be written: commands are refused, worlds wait
};
struct Storage {
    StorageState state = StorageState::KeepsUp;
    std::string reason; // empty for KeepsUp

    bool worlds_wait() const { return state == StorageState::Behind || state == StorageState::Stalled; }
    friend bool operator==(const Storage&, const Storage&) = default;
};

/// A world and its run control.
struct Entry {
    std::string name;
    RunId run_id;
    RunControl control;
    World world;
    // Measured by the simulation loop; not part of the state.
    double ticks_per_s = 0;
    bool slowed = false;                           // the machine does not reach the requested speed
    std::optional<Replay> replay = std::nullopt;   // nullopt: a live world; otherwise the world is a replay
    std::optional<Storage> storage = std::nullopt; // nullopt: the world's run is not stored
    Ownership ownership = {};
    bool frozen = false; // as in the rules of its class

    /// Returns whether this is a replay whose original world is in the laboratory. find() finds such a replay only by
    /// its own name.
    bool replays_another_world() const { return replay && !replay->replay_of.empty(); }

    RunState state() const;
    /// Returns whether the world has a goal that it has not reached, and is not paused.
    bool wants_to_run() const;
    /// Returns whether the world should advance: it wants to run, is not frozen, and awaits no fitness from clients.
    bool wants_tick() const;
};

/// A world that does not run, because it cannot be restored from its run file, or because this file is damaged. It
/// keeps its name, and counts as a world.
struct DamagedWorld {
    std::string name;
    std::optional<RunId> run_id; // nullopt: the file cannot be read at all
    std::string reason;          // what is wrong, and what can be done

    /// The answer to every request that needs the world to run.
    base::Refusal refusal() const;
};

/// The answer to a request that names a replay which does not exist.
base::Refusal no_such_replay(std::string_view name);

/// Returns the number of genes of all organisms with which a world of these parameters begins.
std::uint64_t genes_of(const parameters::Parameters& p);

/// The construction of the world of a CreateWorld, ResetWorld or ForkWorld.
struct Construction {
    std::function<World(base::Executor&)> construct; // throws std::bad_alloc if memory does not suffice
    std::uint64_t genes = 0;  // number of genes of all its organisms; the time it takes grows with this number
    bool reads_world = false; // it reads the world of the command, which must not change until `construct` returns
    bool is_shared = false;   // other processes take part, so `construct` must run on the thread of the laboratory
};

/// The result of a command.
struct Applied {
    std::string world;
    std::uint64_t tick = 0; // the change holds from this tick on
    // SetParameters: the complete set after the change; after a dry run, the set that would result.
    std::optional<parameters::ParameterSet> parameters;
    // SetParameters: the planned change, with id 0 after a dry run. CancelChange: the cancelled change.
    std::optional<parameters::PlannedChange> planned = std::nullopt;
    // PlaceEntities, RemoveEntities: the entities.
    std::optional<EntityIds> placed = std::nullopt, removed = std::nullopt;
};

class Laboratory {
  public:
    /// Applies a command now, between two ticks. A refused command has changed nothing. CreateWorld, ResetWorld and
    /// ForkWorld throw std::bad_alloc, with nothing changed, if memory does not suffice for the new world.
    base::Result<Applied> apply(const Command& command);
    /// Does the same as apply() in three steps, of which another thread can carry out the second: checks the command,
    /// constructs the world, and adds it. The last step checks the command again.
    base::Result<Construction> construction(const CreateWorld& command) const;
    base::Result<Construction> construction(const ResetWorld& command) const;
    base::Result<Construction> construction(const ForkWorld& command) const;
    base::Result<Applied> adopt(const CreateWorld& command, World world);
    base::Result<Applied> adopt(const ResetWorld& command, World world);
    base::Result<Applied> adopt(const ForkWorld& command, World world);

    /// Divides the islands of the live worlds among processes, also those of worlds that are created later.
    ///
    /// maker  must outlive the laboratory.
    void share(IslandsMaker& maker, base::Executor& executor);

    /// Adds a world that was created elsewhere; its name must be unused.
    void adopt(std::unique_ptr<Entry> entry) { entries_.push_back(std::move(entry)); }
    /// Removes a world.
    void dismiss(std::string_view name) {
        std::erase_if(entries_, [&](const auto& entry) { return entry->name == name; });
    }
    /// Adds a damaged world; its name must be unused.
    void adopt(DamagedWorld world) { damaged_.push_back(std::move(world)); }
    /// Stops a live world whose run file is damaged: it becomes a damaged world, which keeps its name.
    void replace_with_damaged(DamagedWorld world) {
        dismiss(world.name);
        adopt(std::move(world));
    }

    /// Sets the storage state of all live worlds, including those created later. The simulation loop calls it, so that
    /// clients can read the state.
    void set_storage(const Storage& storage);
    const std::optional<Storage>& storage() const { return storage_; }

    /// Advances a world that wants a tick by one tick, then calls settle().
    void advance(Entry& entry, base::Executor& executor) { advance(entry, 1, executor); }
    /// Advances a world that wants a tick by at most `ticks` >= 1, then calls settle(). Stops at goals, after the first
    /// and the last tick of a generation, and where planned changes take effect, so that every event has its tick.
    void advance(Entry& entry, std::uint64_t ticks, base::Executor& executor);
    /// Collects the events of a world, and removes the goals that it has reached. To be called after a world has
    /// changed.
    void settle(Entry& entry);

    /// Returns the world with that name. An empty name means the only world or, if there are several, the world
    /// `default`. If the world is damaged: its refusal. If no world is found: a refusal NOT_FOUND that lists the
    /// existing names.
    base::Result<Entry*> find(std::string_view name);
    base::Result<const Entry*> find(std::string_view name) const;
    /// Returns the damaged world with that name, with the same meaning of an empty name; nullptr if there is none.
    const DamagedWorld* find_damaged(std::string_view name) const;

    /// Sets the rules of a class, also for worlds that are created later. nullopt: the class is deleted. Returns the
    /// names of the worlds that are frozen or go on by this.
    std::vector<std::string> set_class(const std::string& name, std::optional<ClassRules> rules);
    /// The rules of the class to which a world belongs; nullptr: it belongs to none that has rules.
    const ClassRules* class_of(const Entry& entry) const;

    /// Sets the number of worlds from which on none can be created.
    void set_worlds_max(std::size_t worlds_max) { worlds_max_ = worlds_max; }
    /// Returns whether the laboratory has that many worlds, not counting replays whose original world is in it.
    bool is_full() const;

    /// The worlds, in order of creation, without damaged worlds.
    std::span<const std::unique_ptr<Entry>> entries() const { return entries_; }
    std::span<const DamagedWorld> damaged() const { return damaged_; }

    /// Returns and removes the events since the last call, oldest first.
    std::vector<Event> take_events() { return std::exchange(events_, {}); }

  private:
    template <class C>
    base::Result<Applied> construct_and_adopt(const C& command);
    base::Result<Applied> carry_out(const CreateWorld& command) { return construct_and_adopt(command); }
    base::Result<Applied> carry_out(const ResetWorld& command) { return construct_and_adopt(command); }
    base::Result<Applied> carry_out(const ForkWorld&);
    base::Result<Applied> carry_out(const DeleteWorld&);
    base::Result<Applied> carry_out(Entry& entry, const Run&);
    base::Result<Applied> carry_out(Entry& entry, const RunUntilTick&);
    base::Result<Applied> carry_out(Entry& entry, const ReleaseLease&);
    base::Result<Applied> carry_out(Entry& entry, const Pause&);
    base::Result<Applied> carry_out(Entry& entry, const Resume&);
    base::Result<Applied> carry_out(Entry& entry, const AddNote&);
    base::Result<Applied> carry_out(Entry& entry, const SetSpeed&);
    base::Result<Applied> carry_out(Entry& entry, const SetParameters&);
    base::Result<Applied> carry_out(Entry& entry, const CancelChange&);
    base::Result<Applied> carry_out(Entry& entry, const PlaceEntities&);
    base::Result<Applied> carry_out(Entry& entry, const RemoveEntities&);
    base::Result<Applied> carry_out(Entry& entry, const SetFitness&);
    base::Result<Applied> add(const std::string& name, const RunId& run_id, World world, Ownership ownership);
    /// Returns why the owner cannot have a fork of that name; nullopt if he can.
    std::optional<base::Refusal> refusal_of_fork(const ForkWorld& command) const;
    /// The number of worlds, not counting replays whose original world is in the laboratory.
    std::size_t world_count() const;
    /// Returns the name itself or, if it is empty, the name that it means.
    std::string_view meant_by(std::string_view name) const;
    /// Divides the islands of a world that are all in this process, if there are processes among which they can be
    /// divided.
    void share(World& world, base::Executor& executor) const;
    /// Returns why no world with that name can be created; nullopt if one can.
    std::optional<base::Refusal> refusal_of(const std::string& name) const;
    base::Refusal not_found(std::string_view name) const;

    std::vector<std::unique_ptr<Entry>> entries_;
    std::vector<DamagedWorld> damaged_;
    std::vector<Event> events_;
    std::size_t worlds_max_ = worlds_max_by_default;
    std::optional<Storage> storage_;
    std::map<std::string, ClassRules, std::less<>> classes_;
    IslandsMaker* maker_ = nullptr; // nullptr: all islands are in this process
    std::uint64_t leases_granted_ =
        0; // a number is never used again, also after a reset or a new world of the same name
};

} // namespace evod::simulation
