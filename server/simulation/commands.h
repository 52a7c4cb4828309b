// Commands: everything that can change a laboratory from outside. Laboratory::apply applies them between two ticks.
//
// Each command names its world. The protocol layer has already replaced an empty name by the name of a world.
#pragma once

#include "server/base/actor.h"
#include "server/base/random.h"
#include "server/evolution/chromosome.h"
#include "server/parameters/model_parameters.h"
#include "server/parameters/schedule.h"
#include "server/simulation/first_population.h"

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace evod::simulation {

/// The permanent identity of a run: a random number that is drawn outside the core whenever a world is created, forked
/// or reset. It is not part of the world's state.
struct RunId {
    std::uint64_t high = 0, low = 0;
    friend bool operator==(const RunId&, const RunId&) = default;
};

/// Returns the id as 32 lower-case hexadecimal digits.
std::string to_text(const RunId& id);
/// Returns the id as 16 bytes, most significant byte first.
std::string to_bytes(const RunId& id);

/// The speed of a world in simulated seconds per second, 0.001 to 10,000; nullopt: as fast as possible.
using Speed = std::optional<double>;
constexpr double speed_min = 0.001, speed_max = 10'000;

/// To whom a world belongs. It does not influence what happens in the world.
struct Ownership {
    std::string user;       // the owner; empty: no user
    std::string class_name; // the class to which the world belongs; empty: none
    std::string teacher;    // the user who may control all worlds of the class; empty: none

    friend bool operator==(const Ownership&, const Ownership&) = default;
};

struct CreateWorld {
    std::string name; // 1 to 64 of a-z A-Z 0-9 _ -
    parameters::Parameters parameters;
    base::Seed seed;
    RunId run_id;
    FirstPopulation first_population = {}; // valid for these parameters
    parameters::Schedule schedule = {};    // without faults (faults_of()); generation 1 as in `parameters`
    Ownership ownership = {};
};
struct DeleteWorld {
    std::string world;
};
struct ResetWorld {
    std::string world;
    std::optional<base::Seed> seed; // nullopt: the same seed as before
    RunId run_id;
    std::optional<evolution::FreeGenes> listed_genes = {}; // valid; nullopt: the same list as before
};
struct Run {
    std::string world;
    std::optional<std::uint64_t> generations; // >= 1; nullopt: until paused or until a termination criterion holds
};
struct RunUntilTick {
    std::string world;
    std::uint64_t tick;
};
struct ReleaseLease {
    std::string world;
    // The value of RunControl::lease when the lease was granted or extended. The command is refused if that value has
    // changed since. nullopt: releases any lease.
    std::optional<std::uint64_t> lease = {};
};
struct Pause {
    std::string world;
};
struct Resume {
    std::string world;
};
/// A text for the journal. It changes nothing in the world.
struct AddNote {
    std::string world;
    std::string kind; // 1 to 32 of a-z 0-9 _
    std::string text; // 1 to 4,096 bytes of UTF-8
};
struct SetSpeed {
    std::string world;
    Speed speed;
};
struct SetParameters {
    std::string world;
    std::vector<parameters::Assignment> assignments;
    bool dry_run = false;
    std::optional<std::uint64_t> expected_revision;
    std::optional<parameters::PlannedMoment> at = std::nullopt; // when to apply the change; nullopt: at once
    base::Actor by = {};                                        // the author
};
/// Cancels a planned change.
struct CancelChange {
    std::string world;
    std::uint64_t id;
};

enum class ItemKind : std::uint8_t { Food, Poison };
/// The maximum number of items and organisms in one PlaceEntities or RemoveEntities.
constexpr std::size_t place_entries_max = 1000;
/// The maximum number of food items, of poison items and of organisms that can be placed on an island in a generation.
constexpr std::uint32_t placed_max = 10'000;

/// Places items and organisms on an island (entities.h).
struct PlaceEntities {
    struct Item {
        ItemKind kind;
        double x_px, y_px; // any numbers
    };
    struct Organism {
        double x_px, y_px;        // any numbers
        std::vector<float> genes; // in chromosome order
    };
    std::string world;
    std::uint32_t island = 0;
    std::vector<Item> items = {}; // together 1 to place_entries_max entries
    std::vector<Organism> organisms = {};
};
/// Removes items and organisms from an island (entities.h).
struct RemoveEntities {
    std::string world;
    std::uint32_t island = 0;
    std::optional<std::uint64_t> generation = {};                      // the ids belong to it; nullopt: the current one
    std::vector<std::uint32_t> food = {}, poison = {}, organisms = {}; // ids; together 1 to place_entries_max entries
};
/// The ids of items and organisms of one island.
struct EntityIds {
    std::uint32_t island = 0;
    std::uint64_t generation = 1;
    std::vector<std::uint32_t> food = {}, poison = {}, organisms = {};
    friend bool operator==(const EntityIds&, const EntityIds&) = default;
};

/// The largest absolute value of a fitness from a client. The sum of the squares of all fitness values is finite.
constexpr double given_fitness_max = 1e100;

/// The largest value of the parameter `objectives`.
constexpr std::uint32_t objectives_max = 16;

/// Sets the fitness of organisms, if the parameter `fitness` is external and the generation has ended (rating.h).
struct SetFitness {
    std::string world;
    std::uint64_t generation;
    std::uint32_t island = 0;
    std::uint32_t first_organism = 0; // id of the organism to which the first number belongs; the others follow
    // At least one; absolute values at most given_fitness_max; `objectives` numbers for each organism.
    std::vector<double> fitness;
    std::vector<float> genes = {}; // the repaired chromosomes of the rated organisms; empty: none was repaired
};

struct ForkWorld {
    std::string world; // the world to fork
    std::string name;  // name of the new world; as in CreateWorld
    // The fork starts at the first moment of this generation of `world`, which must be stored in a run file; nullopt:
    // the fork starts at the present state of `world`.
    std::optional<std::uint64_t> at_generation;
    RunId run_id;
    Ownership ownership = {};
};

using Command =
    std::variant<CreateWorld, DeleteWorld, ResetWorld, Run, RunUntilTick, ReleaseLease, Pause, Resume, AddNote,
                 SetSpeed, SetParameters, CancelChange, PlaceEntities, RemoveEntities, SetFitness, ForkWorld>;

} // namespace evod::simulation
