// Records: what the recorder writes to a run file and a replay reads from it. Their tables: docs/RUN_FILE.md.
#pragma once

#include "server/base/state_hash.h"
#include "server/evolution/next_generation.h"
#include "server/run_file/build.h"
#include "server/simulation/laboratory.h"
#include "server/simulation/living.h"
#include "server/simulation/model_version.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::run_file {

/// What a run began with; written once.
struct RunIdentity {
    std::string name; // of the world
    simulation::RunId run_id;
    base::Seed seed;
    parameters::Parameters parameters;
    std::string evod_version = EVOD_VERSION;
    std::string build = build_text(); // of that evod; empty if the file does not state it
    std::uint32_t model_version = simulation::model_version;
    std::int64_t began_unix_ms = 0; // wall clock, for information only
    // A fork begins with a generation of another run; its `parameters` are those requested in that run.
    std::uint64_t first_generation = 1;
    std::uint64_t first_tick = 0; // ticks before this run; a run that begins within a generation has a checkpoint here
    std::optional<simulation::RunId> forked_from = std::nullopt;
    std::uint64_t inherited_generations = 0;           // before its first one, whose statistics it has from its origin
    simulation::FirstPopulation first_population = {}; // given to it or its origin; nullptr: drawn by seed
    parameters::Schedule schedule = {};                // given to it or its origin
};

/// Which client sent a command.
struct Origin {
    std::string client; // "user: program address"; "program address" if the session had no token
    std::string client_key;
    std::uint64_t request_id = 0;
    std::string request; // a serialized v1::Request
};

/// The user in Origin::client; empty for none. The name of a program never contains ": ".
inline std::string user_of(const Origin& origin) {
    const auto end = origin.client.find(": ");
    return end == std::string::npos ? "" : origin.client.substr(0, end);
}

/// A command that the simulation has applied.
struct JournalEntry {
    std::uint64_t number = 0; // 1 for the first of the run
    std::uint64_t tick = 0;   // after which it was applied
    Origin origin;
    std::string answer;             // the frame that its client received
    simulation::RunControl control; // of the world after the command
};

/// A generation before its first tick. With the seed and the journal, everything later follows from it.
struct GenerationBegun {
    simulation::Opening opening;
    std::vector<evolution::NextGeneration> born; // one per island
    simulation::Founders founders = {};
};
/// The beginning of the generation that a world is in.
GenerationBegun beginning_of(const simulation::World& world);

/// The statistics that a fork copies from its origin: of the generations before its first one.
struct Inherited {
    simulation::World::History history;
};
/// world  a fork, in its first generation.
Inherited inherited_by(const simulation::World& world);

/// The outcome of a generation on one island; vectors by organism id.
struct IslandOutcome {
    std::vector<double> fitness;
    std::vector<std::uint32_t> lived_ticks; // until death; 0 for organisms that lived to the end
    std::vector<simulation::CauseOfDeath> cause;
    friend bool operator==(const IslandOutcome&, const IslandOutcome&) = default;
};
struct GenerationEnded {
    std::uint64_t generation = 0;
    std::vector<IslandOutcome> outcomes;                      // one per island
    std::vector<simulation::GenerationStatistics> statistics; // one per island
};
/// world  its generation is over.
GenerationEnded end_of(const simulation::World& world);
/// "alive", "starved", "poisoned"; "unknown" for any other number.
std::string_view name_of(simulation::CauseOfDeath cause);

/// The state of a world right after a tick, before any command of that tick. Everything later can be simulated from it
/// and the beginning of its generation, which it does not repeat.
struct Checkpoint {
    simulation::WorldState state;
    base::StateHash hash;
    std::uint64_t journal_entries = 0; // before it
};
Checkpoint checkpoint_of(const simulation::World& world, std::uint64_t journal_entries, base::Executor& executor);
/// The same as a run file stores it.
struct StoredCheckpoint {
    simulation::Moment moment;
    parameters::ParameterSet parameters;
    base::StateHash hash;
    std::uint64_t journal_entries = 0;
    std::string state; // the rest, compressed (checkpoint.h)
};

/// The state hash after a tick.
struct HashRecord {
    std::uint64_t tick = 0;
    base::StateHash hash;
};
/// The recorder stores the state hash after every tick that is a multiple of this.
constexpr std::uint64_t ticks_per_hash = 60;

/// Which of the older generations are retained (retention.h).
struct RetentionRule {
    // Up to until_generation, each keep_every-th generation counted from the file's first; up to until_tick, where that
    // generation ended, each keep_every-th hash counted from tick 0.
    std::uint64_t keep_every = 1, until_generation = 0, until_tick = 0;
};

/// How a server closed a file. There is none while a server has it open, or after a server that was killed.
struct EndMark {
    bool ended = false;     // the world was reset or deleted; otherwise the next server continues the run
    std::uint64_t tick = 0; // the last
    std::uint64_t journal_entries = 0, generations = 0, hashes = 0; // numbers of rows
};

} // namespace evod::run_file
