// Records: what a run file holds, as the program knows it. How it is laid out in tables is in docs/RUN_FILE.md.
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

/// What a run began with.
struct RunIdentity {
    std::string name; // of the world
    simulation::RunId run_id;
    base::Seed seed;
    parameters::Parameters parameters;
    std::string evod_version = EVOD_VERSION;
    std::string build = build_text(); // of that evod; empty where the file does not tell
    std::uint32_t model_version = simulation::model_version;
    std::int64_t began_unix_ms = 0; // the clock on the wall, for people; nothing depends on it
    // A fork begins with a generation of another run; `parameters` are those that were asked for there.
    std::uint64_t first_generation = 1;
    std::uint64_t first_tick = 0; // the ticks before it; with those of a generation over, it begins with a checkpoint
    std::optional<simulation::RunId> forked_from = std::nullopt;
    std::uint64_t inherited_generations = 0; // right before its first, of which it has its origin's statistics
    simulation::FirstPopulation first_population = {}; // that it was given, or its origin; nullptr: drawn
    parameters::Schedule schedule = {};                // that it was created with, or its origin
};

/// Who asked for a command, and how.
struct Origin {
    std::string client; // "user: program address", or "program address" where the session had no token
    std::string client_key;
    std::uint64_t request_id = 0;
    std::string request; // a serialized v1::Request
};

/// The user in Origin::client; empty: none. No program's name contains ": ".
inline std::string user_of(const Origin& origin) {
    const auto end = origin.client.find(": ");
    return end == std::string::npos ? "" : origin.client.substr(0, end);
}

/// A command that was applied.
struct JournalEntry {
    std::uint64_t number = 0; // 1 for the first of the run
    std::uint64_t tick = 0;   // after which it was applied
    Origin origin;
    std::string answer;             // the frame that its client got
    simulation::RunControl control; // as it was then
};

/// A generation before its first tick; with the seed, all that follows from there.
struct GenerationBegun {
    simulation::Opening opening;
    std::vector<evolution::NextGeneration> born; // one per island
    simulation::Founders founders = {};
};
/// The beginning of the generation that a world is in.
GenerationBegun beginning_of(const simulation::World& world);

/// What a fork has from its origin: the statistics of the generations before its own first.
struct Inherited {
    simulation::World::History history;
};
/// world  a fork, in its first generation.
Inherited inherited_by(const simulation::World& world);

/// What became of a generation's organisms on one island, by id.
struct IslandOutcome {
    std::vector<double> fitness;
    std::vector<std::uint32_t> lived_ticks; // until death; 0 for those who lived on
    std::vector<simulation::CauseOfDeath> cause;
    friend bool operator==(const IslandOutcome&, const IslandOutcome&) = default;
};
struct GenerationEnded {
    std::uint64_t generation = 0;
    std::vector<IslandOutcome> outcomes;                      // one per island
    std::vector<simulation::GenerationStatistics> statistics; // one per island
};
/// world  whose generation is over.
GenerationEnded end_of(const simulation::World& world);
/// "alive", "starved", "poisoned"; "unknown" for a number that is no cause.
std::string_view name_of(simulation::CauseOfDeath cause);

/// A world right after a tick, before anything was asked of it there; from here, too, all that follows can be
/// simulated. What it has in common with its generation's beginning is told there.
struct Checkpoint {
    simulation::WorldState state;
    base::StateHash hash;
    std::uint64_t journal_entries = 0; // that came before it
};
Checkpoint checkpoint_of(const simulation::World& world, std::uint64_t journal_entries, base::Executor& executor);
/// The same as it is stored.
struct StoredCheckpoint {
    simulation::Moment moment;
    parameters::ParameterSet parameters;
    base::StateHash hash;
    std::uint64_t journal_entries = 0;
    std::string state; // the rest, packed (checkpoint.h)
};

/// The state hash after a tick.
struct HashLink {
    std::uint64_t tick = 0;
    base::StateHash hash;
};
/// After every tick that is a multiple of this.
constexpr std::uint64_t ticks_per_link = 60;

/// Which generations are no longer held whole, so that a file does not grow without end.
struct Thinning {
    // Up to this generation, and to the tick that ended it, only each keep_every-th is: generations as counted from the
    // file's first, links as counted from tick 0.
    std::uint64_t keep_every = 1, until_generation = 0, until_tick = 0;
};

/// How a file was left. Absent while a server has it open, and after one that did not end in order.
struct EndMark {
    bool ended = false;     // reset or deleted: no world any more; else closed, to be gone on with
    std::uint64_t tick = 0; // the last
    std::uint64_t journal_entries = 0, generations = 0, links = 0;
};

} // namespace evod::run_file
