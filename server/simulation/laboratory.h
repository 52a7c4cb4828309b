// Laboratory: all worlds of a server, each with its run control. Commands are applied here, between two ticks.
//
// Owner        the simulation thread (or `evod run`), alone.
// Determinism  run control (goals, pause, speed) decides when a world advances, never what happens when it does; it is
//              no part of the state hash.
#pragma once

#include "server/base/executor.h"
#include "server/base/result.h"
#include "server/simulation/commands.h"
#include "server/simulation/events.h"
#include "server/simulation/world.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::simulation {

constexpr std::size_t worlds_max = 64;

enum class RunState { Waiting, Running, Paused, Terminated };

/// What a world has been told to do.
struct RunControl {
    bool endless = false;                          // run on; excludes until_generation
    std::optional<std::uint64_t> until_generation; // run until this many generations have ended
    std::optional<std::uint64_t> until_tick;       // step: run until this tick, then be paused
    bool paused = false;
    bool leased = false;     // paused, or stepping, only until the lease is over
    std::uint64_t lease = 0; // number of the last one since the server started
    Speed speed = 1.0;
};

/// Takes goals away that the world has reached; one reached by ticks pauses it. Whether there was one.
bool mind_goals(RunControl& control, const World& world);

/// What there is to be seen in a world that shows what a run file tells.
struct Replay {
    std::string replay_of; // the world that is looked back at; empty: the run of the file has no other world here
    std::uint64_t first_generation = 1, last_generation = 1;
    std::uint64_t first_tick = 0, last_tick = 0;
};

/// How it stands with writing down what worlds do.
enum class StorageState {
    KeepsUp,
    Behind,  // it is slower than worlds, which wait for it
    Failing, // nothing can be written: commands are refused, worlds go on
    Stalled, // nothing can be written: commands are refused, worlds wait
};
struct Storage {
    StorageState state = StorageState::KeepsUp;
    std::string reason; // empty while it keeps up

    bool worlds_wait() const { return state == StorageState::Behind || state == StorageState::Stalled; }
    friend bool operator==(const Storage&, const Storage&) = default;
};

/// A world in its laboratory.
struct Entry {
    std::string name;
    RunId run_id;
    RunControl control;
    World world;
    // Measured by whoever drives the laboratory; no part of the state.
    double ticks_per_s = 0;
    bool slowed = false;                           // its speed is more than the machine can do
    std::optional<Replay> replay = std::nullopt;   // nothing: the world lives. What happens in others is past
    std::optional<Storage> storage = std::nullopt; // nothing: what it does is not written down

    /// Whether it shows the past of another: such worlds are there for those who ask for them by name.
    bool is_look_back() const { return replay && !replay->replay_of.empty(); }

    RunState state() const;
    /// Whether a tick is due as far as goals and pause are concerned.
    bool wants_tick() const;
};

/// The answer to a command.
struct Applied {
    std::string world;
    std::uint64_t tick = 0;                             // from which the change holds
    std::optional<parameters::ParameterSet> parameters; // SetParameters: the complete set, or what it would be
    // SetParameters: what waits now, or with id 0 what would; CancelChange: what waits no more.
    std::optional<parameters::PlannedChange> planned = std::nullopt;
};

class Laboratory {
  public:
    /// Applies a command now, between two ticks; a refusal has changed nothing. CreateWorld, ResetWorld and ForkWorld
    /// throw std::bad_alloc, having changed nothing, where memory does not suffice for the new world.
    base::Result<Applied> apply(const Command& command);

    /// Takes in a world that comes from elsewhere; its name is free.
    void adopt(std::unique_ptr<Entry> entry) { entries_.push_back(std::move(entry)); }
    /// Lets go of one that was taken in.
    void dismiss(std::string_view name) {
        std::erase_if(entries_, [&](const auto& entry) { return entry->name == name; });
    }
    /// Takes in a world that a fork begins with. Refused as CreateWorld is.
    base::Result<Applied> fork(const ForkWorld& command, World world);

    /// Every world that lives, and every one to come, is written down, and it stands so with that. Said by whoever
    /// drives the laboratory, for those who look at its worlds.
    void set_storage(const Storage& storage);
    const std::optional<Storage>& storage() const { return storage_; }

    /// Advances a world that wants a tick by one, and minds its goals.
    void advance(Entry& entry, base::Executor& executor);

    /// The world named, or for an empty name the only one, or `default`. Refused with NOT_FOUND and the names there
    /// are.
    base::Result<Entry*> find(std::string_view name);
    base::Result<const Entry*> find(std::string_view name) const;

    /// Whether there are worlds_max worlds; looks at the past are not counted.
    bool is_full() const;

    /// In order of creation.
    std::span<const std::unique_ptr<Entry>> entries() const { return entries_; }

    /// What happened since this was last called, in order.
    std::vector<Event> take_events() { return std::exchange(events_, {}); }

  private:
    base::Result<Applied> carry_out(const CreateWorld&);
    base::Result<Applied> carry_out(const DeleteWorld&);
    base::Result<Applied> carry_out(Entry& entry, const ResetWorld&);
    base::Result<Applied> carry_out(Entry& entry, const Run&);
    base::Result<Applied> carry_out(Entry& entry, const RunUntilTick&);
    base::Result<Applied> carry_out(Entry& entry, const ReleaseLease&);
    base::Result<Applied> carry_out(Entry& entry, const Pause&);
    base::Result<Applied> carry_out(Entry& entry, const Resume&);
    base::Result<Applied> carry_out(Entry& entry, const SetSpeed&);
    base::Result<Applied> carry_out(Entry& entry, const SetParameters&);
    base::Result<Applied> carry_out(Entry& entry, const CancelChange&);
    base::Result<Applied> carry_out(Entry& entry, const ForkWorld&);
    Applied add(std::unique_ptr<Entry> entry);
    /// Why there can be no new world of that name; nothing if there can.
    std::optional<base::Refusal> refusal_of(const std::string& name) const;
    base::Refusal not_found(std::string_view name) const;
    void collect_events(Entry& entry);

    std::vector<std::unique_ptr<Entry>> entries_;
    std::vector<Event> events_;
    std::optional<Storage> storage_;
};

} // namespace evod::simulation
