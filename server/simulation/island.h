// Island: one walled rectangle with its organisms, food and poison, and everything that happens there in a tick.
//
// One tick, in this order: due items reappear → every living organism loses health → perception and choice, from the
// positions at the start of the tick → forces, damping, collisions, positions (physics/step.h) → feeding at the new
// positions → deaths → hash.
//
// Owner        World. Islands share nothing, so a world advances them side by side.
// Determinism  decisions go by ids; the order of arrays is no part of the state.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/state_hash.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/next_generation.h"
#include "server/physics/bodies.h"
#include "server/physics/step.h"
#include "server/simulation/items.h"
#include "server/simulation/parameters.h"
#include "server/simulation/statistics.h"

#include <optional>
#include <span>
#include <vector>

namespace evod::simulation {

enum class CauseOfDeath : std::uint8_t { Alive, Starved, Poisoned };

/// The living, in rising order of id; index i of every column is the same organism. Bodies are in Island::bodies().
struct Living {
    std::vector<std::uint32_t> id; // birth order within the generation
    std::vector<float> health;
    std::vector<float> loss_per_tick;         // health that living costs
    std::vector<float> wander_force, impulse_force;
    std::vector<float> flee_chance;
    std::vector<float> food_radius, poison_radius; // px
};

/// What became of each organism that was born, by id.
struct Fate {
    std::vector<std::uint32_t> lived_ticks;
    std::vector<float> health; // at the end; 0 for the dead
    std::vector<CauseOfDeath> cause;
    std::vector<std::uint16_t> food_eaten, poison_eaten;
};

/// Numbers of the generation that do not follow from Fate.
struct IslandCounts {
    std::uint64_t food_eaten = 0, poison_eaten = 0;
    std::uint32_t starved_count = 0, poisoned_count = 0;
    std::uint64_t too_fast_count = 0, speed_limit_count = 0;
};

class Island {
  public:
    Island(base::Seed seed, std::uint32_t index) : seed_{seed}, index_{index} {}

    /// Replaces everything: fresh organisms grown from `bred`, food, poison, obstacles and crates.
    void begin_generation(const Parameters& parameters, std::uint64_t generation, evolution::NextGeneration bred,
                          base::Executor& executor);

    /// tick  of the generation, 1 for its first.
    void advance_tick(const Parameters& parameters, std::uint32_t tick, base::Executor& executor);

    /// Fitness of every organism by id, now: seconds lived + health, or the function of the chromosome.
    const std::vector<double>& evaluate(const Parameters& parameters, std::uint32_t tick, base::Executor& executor);

    std::uint32_t index() const { return index_; }
    base::Seed seed() const { return seed_; }
    /// Of everything on the island, as of the last tick.
    base::StateHash hash() const { return hash_; }

    const Living& living() const { return living_; }
    const physics::Circles& bodies() const { return bodies_; } // of the living, same order
    const physics::Boxes& boxes() const { return boxes_; }     // crates, then obstacles
    std::uint32_t crate_count() const { return crate_count_; }
    const Items& food() const { return food_; }
    const Items& poison() const { return poison_; }
    const physics::Area& area() const { return area_; }

    const evolution::NextGeneration& born() const { return born_; } // chromosomes, parents, clampings; by id
    const Fate& fate() const { return fate_; }
    const IslandCounts& counts() const { return counts_; }
    LiveStatistics live_statistics() const;
    GenerationStatistics generation_statistics(const Parameters& parameters, std::span<const double> fitness) const;
