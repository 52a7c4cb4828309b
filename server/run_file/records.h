// Records: the data that the recorder writes to a run file and that a replay reads from it. Tables: docs/RUN_FILE.md.
#pragma once

#include "server/base/actor.h"
#include "server/base/state_hash.h"
#include "server/evolution/next_generation.h"
#include "server/run_file/build.h"
#include "server/simulation/laboratory.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/model_version.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace evod::run_file {

/// The state and settings with which a run began. Written once.
struct RunIdentity {
    std::string name; // the name of the world
    simulation::RunId run_id;
    base::Seed seed;
    parameters::Parameters parameters; // in effect when the run began; they determine how many genes its organisms have
    std::string evod_version = EVOD_VERSION;
    std::string build = build_text(); // build of the evod that created the file; empty if the file does not contain it
    std::uint32_t model_version = simulation::model_version;
    std::int64_t began_unix_ms = 0; // wall clock time, only for information
    // Requested when a fork began, but partly waiting for its next generation or a reset. nullopt: `parameters`.
    std::optional<parameters::RequestedParameters> requested = std::nullopt;
    // A fork begins with a generation of another run.
    std::uint64_t first_generation = 1;
    // Ticks before this run; if the run begins within a generation, it has a checkpoint at this tick.
    std::uint64_t first_tick = 0;
    std::optional<simulation::RunId> forked_from = std::nullopt;
    // A fork copies the statistics of this number of earlier generations from its origin.
    std::uint64_t inherited_generations = 0;
    simulation::FirstPopulation first_population = {}; // given to the run or its origin; nullptr: the seed draws it
    parameters::Schedule schedule = {};                // given to the run or its origin
    simulation::Ownership ownership = {};              // of its world

    parameters::RequestedParameters requested_parameters() const {
        return requested ? *requested : parameters::RequestedParameters{parameters};
    }
};

/// Which client sent a command.
struct Origin {
    base::Actor by; // a client or the server
    std::string client_key;
    std::uint64_t request_id = 0;
    std::string request; // a serialized v1::Request
};

/// A command that the simulation has applied.
struct JournalEntry {
    std::uint64_t number = 0; // 1 for the first command of the run
    std::uint64_t tick = 0;   // the command was applied after this tick
    Origin origin;
    std::string answer;             // the frame that the client received
    simulation::RunControl control; // run control of the world after the command
};

/// A client key, with the highest request_id among commands in a journal.
struct UsedKey {
    base::Actor by; // the sender of one of the commands
    std::string client_key;
    std::uint64_t highest_id = 0;
};

/// A generation before its first tick. It determines everything later, together with the seed and the journal.
struct GenerationBegun {
    simulation::Opening opening;
    std::vector<evolution::NextGeneration> born; // one per island
    simulation::Founders founders = {};
    std::vector<simulation::IslandOpening> openings = {}; // as in simulation::BredIslands

    simulation::BredIslands bred() const { return {born, founders, openings}; }
};
/// The beginning of the generation of a world.
GenerationBegun beginning_of(const simulation::World& world);

/// The statistics that a fork copies from its origin. They belong to the generations before the fork's first one.
struct Inherited {
    simulation::History history;
};
using simulation::IslandOutcome;
struct GenerationEnded {
    std::uint64_t generation = 0;
    std::vector<simulation::IslandOutcome> outcomes;          // one per island
    std::vector<simulation::GenerationStatistics> statistics; // one per island
};
/// Returns the outcome of the world's generation, which must be complete.
GenerationEnded end_of(const simulation::World& world);
/// "alive", "starved", "poisoned", "removed", "eaten", "old"; "unknown" for any other number.
std::string_view name_of(simulation::CauseOfDeath cause);

/// The state of a world right after a tick, before any command of that tick. Together with the beginning of its
/// generation, which it does not repeat, it is sufficient to simulate everything later.
struct Checkpoint {
    simulation::WorldState state;
    base::StateHash hash;
    std::uint64_t journal_entries = 0; // number of journal entries before the checkpoint
};
Checkpoint checkpoint_of(const simulation::World& world, std::uint64_t journal_entries, base::Executor& executor);

/// What a run begins with: everything that its file contains before the first command.
struct RunBeginning {
    RunIdentity identity;
    GenerationBegun generation; // the beginning of the first generation
    // The rest is empty unless the run is a fork.
    std::optional<Checkpoint> state = std::nullopt; // the state at the first moment, if it is not that of `generation`
    std::optional<GenerationEnded> ended = std::nullopt; // if the first generation is over at the first moment
    Inherited inherited = {};
};
/// The identity of a run that begins now with this world.
RunIdentity identity_of(const simulation::World& world, std::string name, const simulation::RunId& run_id);
/// The beginning of a run whose world is at its first moment.
RunBeginning beginning_of_run(const simulation::World& world, std::string name, const simulation::RunId& run_id);
/// The beginning of a run that was forked from the run `origin`, and begins with the present state of `fork`.
RunBeginning beginning_of_fork(const simulation::World& fork, std::string name, const simulation::RunId& run_id,
                               const simulation::RunId& origin, base::Executor& executor);

/// A checkpoint as a run file stores it.
struct StoredCheckpoint {
    simulation::Moment moment;
    parameters::ParameterSet parameters;
    base::StateHash hash;
    std::uint64_t journal_entries = 0;
    std::string state; // the encoded state of the islands (checkpoint.h)
};

/// The state hash after a tick.
struct HashRecord {
    std::uint64_t tick = 0;
    base::StateHash hash;
};
/// The recorder stores the state hash after every tick that is a multiple of this number.
constexpr std::uint64_t ticks_per_hash = 60;

/// The rule for which older generations are retained (retention.h).
struct RetentionRule {
    // Up to until_generation, every keep_every-th generation is retained, counted from the first one in the file. That
    // generation ended at until_tick. Up to until_tick, every keep_every-th hash is retained, counted from tick 0.
    std::uint64_t keep_every = 1, until_generation = 0, until_tick = 0;
};

/// How a server closed a file. A file has no end mark while a server has it open, or after a server was killed.
struct EndMark {
    bool ended = false;     // the world was reset or deleted; otherwise the next server continues the run
    std::uint64_t tick = 0; // last tick of the run
    std::uint64_t journal_entries = 0, generations = 0, hashes = 0; // numbers of rows in the file
};

} // namespace evod::run_file
