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
#include "server/simulation/behaviour.h"
#include "server/simulation/feeding.h"
#include "server/simulation/items.h"
#include "server/simulation/living.h"
#include "server/simulation/parameters.h"
#include "server/simulation/statistics.h"

#include <optional>
#include <span>
#include <vector>

namespace evod::simulation {

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
    void begin_generation(const Parameters& parameters, std::uint64_t generation, evolution::NextGeneration bred);

    /// tick  of the generation, 1 for its first.
    void advance_tick(const Parameters& parameters, std::uint32_t tick, base::Executor& executor);

    /// Fitness of every organism by id, at the end of tick `tick` of the generation: seconds lived + health at the end,
    /// or the function of the chromosome.
    std::vector<double> fitness(const Parameters& parameters, std::uint32_t tick, base::Executor& executor) const;

    /// The index in bodies() of a living organism; nullopt if it is dead.
    std::optional<std::size_t> body_of(std::uint32_t id) const;

    std::uint32_t index() const { return index_; }
    base::Seed seed() const { return seed_; }
    /// Of everything on the island, as of the last tick.
    base::StateHash hash() const { return hash_; }

    const Living& living() const { return living_; }
    const physics::Circles& bodies() const { return bodies_; } // of the living, ids rising
    const physics::Boxes& boxes() const { return boxes_; }     // crates, then obstacles
    std::uint32_t crate_count() const { return crate_count_; }
    const Items& food() const { return food_; }
    const Items& poison() const { return poison_; }
    const physics::Area& area() const { return area_; }

    const evolution::NextGeneration& born() const { return born_; } // chromosomes, parents, clampings; by id
    const Fate& fate() const { return fate_; }
    const IslandCounts& counts() const { return counts_; }
    LiveStatistics live_statistics() const;

  private:
    void place(const Parameters& parameters, std::uint64_t generation);
    void feed(const Parameters& parameters, std::uint32_t tick, base::Executor& executor);
    void bury_the_dead(std::uint32_t tick);
    void update_hash(base::Executor& executor);

    base::Seed seed_;
    std::uint32_t index_;
    base::RandomKey behaviour_key_{base::Seed{}, base::Purpose::Behaviour, 0, 0};
    physics::Area area_;
    physics::StepParameters step_parameters_;
    physics::Stepper stepper_;
    evolution::NextGeneration born_;
    Living living_;
    physics::Circles bodies_;
    physics::Boxes boxes_;
    physics::Boxes obstacles_; // those of boxes_ that do not move: where no item may lie
    std::uint32_t crate_count_ = 0;
    Items food_, poison_;
    Sight sight_;
    Feeding feeding_;
    Fate fate_;
    IslandCounts counts_;
    base::StateHash born_hash_; // of the chromosomes, which do not change during a generation
    base::StateHash hash_;
    std::vector<base::StateHash> hash_of_block_; // working memory, kept warm
    std::vector<std::uint8_t> keep_;
};

} // namespace evod::simulation
