// Islands: all islands of a world, as the world uses them. LocalIslands holds them in this process. The islands of
// simulation/shared are divided among several processes.
//
// Owner        World.
// Threads      called on the thread of the world; work is passed to the given executor.
// Determinism  all implementations give the same results.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/state_hash.h"
#include "server/evolution/migration.h"
#include "server/evolution/next_generation.h"
#include "server/parameters/model_parameters.h"
#include "server/simulation/colony.h"
#include "server/simulation/commands.h"
#include "server/simulation/island.h"
#include "server/simulation/statistics.h"
#include "server/simulation/world_state.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace evod::simulation {

/// For each island, the founder of each organism, by id: the ancestor in the first generation that is found by
/// following first parents, also across islands. Founders are numbered from 0, island after island. Not part of the
/// state; empty if unknown. The founder of an organism that was placed is `no_founder`.
using Founders = std::vector<std::vector<std::uint32_t>>;
constexpr std::uint32_t no_founder = ~0U;

/// The organisms with which a generation began.
struct BredIslands {
    std::vector<evolution::NextGeneration> islands; // one per island
    Founders founders;
    std::vector<IslandOpening> openings = {}; // with births, from the second interval on: one per island
};

/// The birth of a child, or, without parents, the arrival of an organism that was placed.
struct Birth {
    std::uint32_t tick;         // of the interval, after which it was born
    evolution::Parents parents; // ids in the same interval
    friend bool operator==(const Birth&, const Birth&) = default;
};

/// The outcome of a generation on one island. Every vector is indexed by organism id.
struct IslandOutcome {
    std::vector<double> fitness;            // the first objective
    std::vector<std::uint32_t> lived_ticks; // ticks until death; 0 for an organism that lived to the end
    std::vector<CauseOfDeath> cause;
    // Several objectives: all numbers of each organism, one organism after another; otherwise empty.
    std::vector<double> objectives = {};
    // The chromosomes that clients have repaired, one of each organism after another; empty: none was repaired.
    std::vector<float> repaired = {};
    std::vector<Birth> births = {}; // with births: of the organisms with the last ids
    friend bool operator==(const IslandOutcome&, const IslandOutcome&) = default;

    /// The fitness that decides migration, survival and breeding: with several objectives the standing
    /// (evolution/objectives.h).
    std::vector<double> deciding_fitness() const;
};

/// What is known about every island at any time.
struct IslandSummary {
    base::StateHash hash;
    std::uint32_t alive_count = 0;
    std::uint32_t organism_count = 0;              // of this generation, with those that were placed
    std::array<std::uint32_t, 2> breeder_counts{}; // Island::breeder_count() of the prey and of the predators
    bool is_as_begun = false; // Island::is_as_begun(), at the first moment of a generation; otherwise false
};

/// The number that keys the draws of a migration; that of predators differs.
constexpr std::uint64_t migration_key(std::uint64_t generation, Species species) {
    return generation | static_cast<std::uint64_t>(species) << 63;
}

/// The migrants of an epoch.
struct Routes {
    std::vector<evolution::MigrationRoute> prey, predators;

    bool empty() const { return prey.empty() && predators.empty(); }
};

/// Ticks [first, last] of a generation.
struct GenerationTicks {
    std::uint32_t first, last;
};
/// The state after some ticks.
struct Advanced {
    std::uint32_t tick;        // of the generation: the last that was performed
    std::uint64_t alive_count; // on all islands
};
/// The last organism of an island has died in a tick of the generation.
struct DiedOut {
    std::uint32_t island, tick;
};

class IslandsMaker;

class Islands {
  public:
    virtual ~Islands() = default;

    /// Begins a generation. Throws std::bad_alloc if memory does not suffice.
    ///
    /// bred  its organisms; without islands: they are drawn from the seed.
    virtual void begin_generation(const parameters::Parameters& parameters, std::uint64_t generation, BredIslands bred,
                                  base::Executor& executor) = 0;
    /// Brings islands at the beginning of a generation to a state that has been checked.
    ///
    /// begun_with  the parameters with which the generation began.
    virtual void restore(const parameters::Parameters& begun_with, const WorldState& state,
                         base::Executor& executor) = 0;
    /// Performs ticks, but none after the tick in which the last organism of all islands dies. Adds the
    /// islands that have died out, in order of ticks.
    virtual Advanced advance(const parameters::Parameters& parameters, GenerationTicks ticks, base::Executor& executor,
                             std::vector<DiedOut>& died_out) = 0;
    /// Ends a generation after its last tick. Returns the statistics of every island, without the moment of the end.
    ///
    /// given  what clients have given, per island; empty: the islands compute the fitness.
    virtual std::vector<GenerationStatistics> end_generation(const parameters::Parameters& parameters,
                                                             std::uint32_t tick, std::span<const Rating> given,
                                                             base::Executor& executor) = 0;
    /// Breeds the next generation from the chromosomes of the last one, or from repaired ones, and begins it. With
    /// several objectives, the standing takes the place of the fitness; migrants keep that of their island. If
    /// shuffle_fitness is on, the shuffled fitness decides migration, survival and breeding, and nothing else.
    ///
    /// generation  the generation that has ended; with births, an interval, after which the living live on.
    /// tick        its last tick.
    /// routes      the migrants of this epoch; empty if there are none.
    virtual void breed_next_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                                       std::uint32_t tick, const Routes& routes, base::Executor& executor) = 0;
    /// Places or removes entities after a tick of the generation. check() has accepted the command (entities.h).
    ///
    /// returns  the ids of the new entities, without island and generation.
    virtual EntityIds place(const PlaceEntities& command, const parameters::Parameters& parameters,
                            std::uint32_t tick) = 0;
    virtual void remove(const RemoveEntities& command, std::uint32_t tick) = 0;

    /// The summary of every island.
    virtual std::span<const IslandSummary> summaries() const = 0;
    /// Returns an island in its present state. It is valid until the islands change.
    virtual const Island& island(std::size_t index) const = 0;
    /// The founders of the organisms of an island; empty if this world began with a later generation and received none.
    virtual std::span<const std::uint32_t> founders(std::size_t index) const = 0;
    /// Makes the next calls of island() and founders() for these islands return without waiting.
    virtual void bring(std::span<const std::uint32_t>) const {}
    /// Returns the organisms of all islands as the generation began, without those that were placed.
    virtual BredIslands bred() const = 0;
    /// Returns the outcome of the ended generation on every island.
    virtual std::vector<IslandOutcome> outcomes() const = 0;
    virtual std::vector<IslandState> states(base::Executor& executor) const = 0;
    virtual std::vector<LiveStatistics> live_statistics() const = 0;

    /// Returns a copy; nullptr if other processes hold some of the islands.
    virtual std::unique_ptr<Islands> copy() const = 0;
    /// What has made these islands; nullptr if all of them are in this process.
    virtual IslandsMaker* maker() const { return nullptr; }

    std::size_t size() const { return summaries().size(); }
    const Island& operator[](std::size_t index) const { return island(index); }

    /// For loops over all islands.
    struct Iterator {
        const Islands& islands;
        std::size_t index;
        const Island& operator*() const { return islands.island(index); }
        void operator++() { ++index; }
        bool operator==(const Iterator& other) const { return index == other.index; }
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size()}; }
};

/// Makes islands that several processes hold.
class IslandsMaker {
  public:
    virtual ~IslandsMaker() = default;

    /// Whether a world with so many islands can be divided.
    virtual bool divides(std::uint32_t island_count) const = 0;
    /// Makes the islands of a world, before its first generation.
    virtual std::unique_ptr<Islands> make(base::Seed seed, std::uint32_t island_count) = 0;
};

/// Makes the islands of a world, before its first generation.
///
/// maker  nullptr, or one that cannot divide them: they are all in this process.
std::unique_ptr<Islands> make_islands(base::Seed seed, std::uint32_t island_count, IslandsMaker* maker);

} // namespace evod::simulation
