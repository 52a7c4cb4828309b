// Island: one walled rectangle with its organisms, food and poison, and everything that happens there in a tick.
//
// docs/MODEL.md, "What happens in a tick", states what happens and in which order. The definition of advance_tick()
// states how this work is divided into two loops over blocks of organisms. At the end of a tick, the hash of the island
// is computed.
//
// Organisms are stored strip by strip, in the order of their positions, so that neighbours share cache lines. They are
// sorted again from time to time as they move. Until the next sorting, a dead organism leaves a void body: an immovable
// placeholder that touches nothing.
//
// Owner        World. Islands share nothing, so a world advances them in parallel.
// Threads      a tick is two loops over blocks of organisms. Work that concerns single organisms runs between and after
//              the loops.
// Determinism  decisions depend on ids. The order of arrays is not part of the state.
#pragma once

#include "server/base/executor.h"
#include "server/base/random.h"
#include "server/base/result.h"
#include "server/base/state_hash.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/next_generation.h"
#include "server/parameters/model_parameters.h"
#include "server/physics/bodies.h"
#include "server/physics/motion_report.h"
#include "server/physics/step.h"
#include "server/simulation/behaviour.h"
#include "server/simulation/colony.h"
#include "server/simulation/commands.h"
#include "server/simulation/hunt.h"
#include "server/simulation/item_claims.h"
#include "server/simulation/items.h"
#include "server/simulation/living_organisms.h"
#include "server/simulation/perception.h"
#include "server/simulation/placement.h"
#include "server/simulation/statistics.h"
#include "server/simulation/world_state.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace evod::simulation {

class Island {
  public:
    Island(base::Seed seed, std::uint32_t index) : seed_{seed}, index_{index} {}

    /// Replaces everything on the island. Creates the organisms whose chromosomes are in `bred`, and places food,
    /// poison, obstacles and crates.
    ///
    /// opening  with births, from the second interval on: the state of these organisms, items and crates.
    void begin_generation(const parameters::Parameters& parameters, std::uint64_t generation,
                          evolution::NextGeneration bred, base::Executor& executor,
                          std::optional<IslandOpening> opening = std::nullopt);

    /// With births, at the end of an interval: what the island hands over to the next one (interval.cpp). The account
    /// is that of both species without migration.
    struct Continuation {
        evolution::NextGeneration bred;
        IslandOpening opening;
    };
    /// parameters  those of the next interval.
    /// tick        the last of this one.
    Continuation continuation(const parameters::Parameters& parameters, std::uint32_t tick,
                              base::Executor& executor) const;
    /// Adds the predators that arrive at the beginning of the next interval, whose number is `generation`.
    void add_predators(Continuation& to, const parameters::Parameters& parameters, std::uint64_t generation) const;
    /// The organisms of a species from which the next generation comes: with births the living, otherwise all.
    std::vector<std::uint32_t> breeders(Species species) const;
    std::uint32_t breeder_count(Species species) const;

    /// Frees the copies of the weights that networks read. Until begin_generation(), organisms cannot act. Breeding
    /// reads only the chromosomes, and the weights would be a quarter of the memory that it needs.
    void free_weights() { living_.free_weights(); }

    /// Performs one tick. `tick` is its number within the generation, from 1. The island must have living organisms.
    void advance_tick(const parameters::Parameters& parameters, std::uint32_t tick, base::Executor& executor);

    /// Takes the place of advance_tick() on an island without living organisms, where nothing moves.
    void skip_tick(std::uint32_t tick);

    /// Places an item, between two ticks. Returns its id. `place` must be inside the walls and clear of boxes.
    std::uint32_t place(ItemKind kind, Place place);
    /// Places organisms, between two ticks. Returns the id of the first; the others follow. Each place must be inside
    /// the walls, and clear of boxes, organisms and the other places.
    struct NewOrganism {
        Place place;
        std::vector<float> genes;
        std::uint32_t tick; // it is placed or born after this tick of the generation
        evolution::Parents parents = no_parents;
    };
    std::uint32_t place(std::span<const NewOrganism> organisms, const parameters::Parameters& parameters);
    /// Removes an item that is present, between two ticks.
    void remove(ItemKind kind, std::uint32_t item);
    /// Removes a living organism, between two ticks, after `tick` of the generation.
    void remove_organism(std::uint32_t id, std::uint32_t tick);

    IslandShape shape() const;
    IslandState state(base::Executor& executor) const;
    /// Checks whether `state` is possible for this island after `tick`. The island must be at the beginning of its
    /// generation.
    base::Result<void> check(const IslandState& state, std::uint32_t tick) const;
    /// Sets the island to a state that check() has accepted. `parameters` are those of the generation.
    void restore(const IslandState& state, std::uint32_t tick, const parameters::Parameters& parameters,
                 base::Executor& executor);

    /// What an organism has achieved in this generation.
    struct Life {
        std::uint32_t lived_ticks;
        float health; // 0 for dead organisms
        std::uint32_t food_eaten, poison_eaten;
    };
    /// Returns the life of an organism up to the end of `tick` of the generation. The island must have bodies.
    Life life(std::uint32_t id, std::uint32_t tick) const;

    /// Returns the fitness of every organism, by id, at the end of `tick` of the generation: a weighted sum of
    /// seconds lived, health, food eaten and poison eaten, or a function of the chromosome alone.
    std::vector<double> fitness(const parameters::Parameters& parameters, std::uint32_t tick,
                                base::Executor& executor) const;

    /// Predicts what organisms [ids.begin, ids.end) will do in `tick` of the generation if no item reappears before
    /// that tick. The choice is None for dead organisms and on islands without bodies.
    std::vector<Intention> intentions(const parameters::Parameters& parameters, std::uint32_t tick,
                                      base::Range ids) const;

    /// Predicts the activations of an organism's network in the next tick; nullopt if the organism is dead or has none.
    ///
    /// tick  of the generation: the next one.
    std::optional<Activations> activations(const parameters::Parameters& parameters, std::uint32_t tick,
                                           std::uint32_t id) const;
    /// The networks of the organisms; empty if they have none.
    const evolution::BrainLayout& brain() const { return brain_; }

    /// Returns the index in bodies() of the organism with this id; nullopt if the organism is dead.
    std::optional<std::size_t> body_of(std::uint32_t id) const;
    /// The index in bodies() of every organism of this generation, by id; no_body for the dead. Empty if there are
    /// no bodies.
    std::span<const std::uint32_t> bodies_by_id() const { return body_of_; }
    static constexpr std::uint32_t no_body = ~0U;

    /// Measures how fast living organisms and crates move, and how deeply they overlap; all zeros if there are no
    /// bodies.
    physics::MotionReport motion_report(const parameters::Parameters& parameters) const;

    std::uint32_t index() const { return index_; }
    base::Seed seed() const { return seed_; }
    /// The hash of everything on the island after the last tick.
    base::StateHash hash() const { return hash_; }

    std::uint32_t alive_count() const { return alive_count_; }
    const LivingOrganisms& living() const { return living_; } // indexed by body
    /// The circles of the living organisms, in any order, and placeholders (void circles) of dead organisms.
    const physics::Circles& bodies() const { return bodies_; }
    const physics::Boxes& boxes() const { return boxes_; } // first the crates, then the obstacles
    std::uint32_t crate_count() const { return crate_count_; }
    const Items& food() const { return food_; }
    const Items& poison() const { return poison_; }
    const physics::Area& area() const { return area_; }

    // The chromosomes, parents and clamped genes of the organisms, by id. Those that were placed or born come last. In
    // the first generation no organism has parents here; later, the parents of a placed organism are `no_parents`.
    const evolution::NextGeneration& born() const { return born_; }
    /// The number of organisms at the beginning of the generation.
    std::uint32_t bred_count() const { return static_cast<std::uint32_t>(born_.genes.cols() - std::ssize(arrivals_)); }
    /// born() without the organisms that were placed.
    evolution::NextGeneration bred() const;
    /// The tick of the generation after which an organism was placed; 0 for an organism that was bred.
    std::uint32_t placed_tick(std::uint32_t id) const { return id < bred_count() ? 0 : arrival(id).tick; }
    /// Returns the parents of a child of this interval: ids in this interval. no_parents for all other organisms.
    evolution::Parents parents_of_child(std::uint32_t id) const {
        return id < bred_count() ? no_parents : arrival(id).parents;
    }
    Species species_of(std::uint32_t id) const {
        const bool is_predator =
            id < bred_count() ? id >= bred_count() - born_.predator_count : arrival(id).is_predator;
        return is_predator ? Species::Predator : Species::Prey;
    }
    /// With births: the number of an organism on its island, from 0 in the order of births, for its whole life.
    std::uint32_t number_of(std::uint32_t id) const;
    /// With births: the age of a living organism at the end of `tick` of the interval, or of a dead one at its death.
    std::uint32_t age_ticks(std::uint32_t id, std::uint32_t tick) const;
    bool is_colony() const { return living_.in_colony(); }
    bool has_births() const { return has_births_; }
    const std::array<ColonyCounts, 2>& colony_counts() const { return colony_; } // per species
    const IslandOpening* opening() const { return opening_.get(); }
    /// Whether nothing has been placed, removed or eaten, and no organism has died.
    bool is_as_begun() const;
    const LifeRecords& life_records() const { return life_records_; }
    const IslandCounts& counts() const { return counts_; }
    LiveStatistics live_statistics() const;
    /// Returns all live statistics except health_mean, which would need a loop over all organisms.
    LiveStatistics live_counts() const;

    static constexpr evolution::Parents no_parents{~0U, ~0U};

  private:
    /// How an organism arrived that was not there when the generation began.
    struct Arrival {
        std::uint32_t tick;
        evolution::Parents parents;
        bool is_predator;
    };
    /// Returns what is impossible about the organisms of a state that were placed or born; nullptr: nothing.
    const char* fault_of_arrivals(const IslandState& state, std::uint32_t tick) const;
    const Arrival& arrival(std::uint32_t id) const { return arrivals_[id - bred_count()]; }
    void fill(const parameters::Parameters& parameters, std::uint64_t generation, base::Executor& executor);
    /// Appends organisms, without updating hash_ and what is derived from bodies.
    void append(std::span<const NewOrganism> organisms, const parameters::Parameters& parameters);
    /// The part of born_hash_ that describes one organism.
    base::StateHash hash_of_birth(std::uint32_t id) const;
    static ItemRules item_rules(const parameters::Parameters& parameters);
    Items& items(ItemKind kind) { return kind == ItemKind::Food ? food_ : poison_; }
    void renew_near_pairs(base::Executor& executor);
    void reorder(base::Executor& executor);
    /// Creates the living organism of a chromosome, with its network if it has one.
    ///
    /// parameters  of its species.
    void put_living(std::size_t body, std::uint32_t id, const parameters::Parameters& parameters);
    /// The weights of a network: the genes behind those of the body.
    std::span<const float> weights_of(std::uint32_t id) const;
    void act(const BehaviourRules& rules, std::uint32_t tick, std::size_t block);
    void act(const SteeringRules& rules, std::uint32_t tick, std::size_t block);
    /// The columns of a block, with what its organisms see.
    OrganismColumns seen_columns(base::Range block, std::uint32_t tick);
    void move(std::size_t block);
    /// Lets organisms eat, and removes the organisms that die. Returns the hash of the living organisms.
    base::StateHash feed_and_remove_dead(const parameters::Parameters& parameters, std::uint32_t tick,
                                         base::Executor& executor);
    // Colonies: predators eat prey (meals.cpp); organisms have children (births.cpp). Both return the change of
    // the hash of the living organisms.
    bool has_predators() const { return colony_[1].living > 0; }
    void begin_colony(const parameters::Parameters& parameters, base::Executor& executor);
    void locate() {
        hunt_.locate(bodies_, area_, [&](std::uint32_t id) { return species_of(id) == Species::Predator; });
    }
    /// Where the organisms are now; nullopt without predators.
    std::optional<Hunt> present_hunt() const;
    void leave_out_predators(FoundIndices& found) const;
    struct Block;
    void add_deaths(const Block& block);
    base::StateHash eat_prey(const parameters::Parameters& parameters, std::uint32_t tick, base::Executor& executor);
    base::StateHash hash_of_handling() const;
    /// Returns the prey that a predator reaches and may eat; BodyGrid::none if there is none.
    std::uint32_t reached_prey(std::uint32_t predator, std::uint32_t tick) const;
    bool births_are_due(const parameters::Parameters& parameters, std::uint32_t tick) const;
    void give_birth(const parameters::Parameters& parameters, std::uint32_t tick);
    class Nursery;
    void add_to_latest(Species species, evolution::ConstGenes genes);
    void count_living();
    base::StateHash hash_of_boxes() const;
    /// Returns the hash of what one organism has eaten. It covers only kinds of items whose weight in the fitness is
    /// not 0; otherwise the numbers of eaten items do not affect the run.
    base::StateHash hash_of_eaten(std::uint32_t id) const;
    base::StateHash whole_hash() const;
    bool has_bodies() const { return body_of_.size() == life_records_.cause.size(); }
    OrganismColumns columns() { return organism_columns(bodies_, living_, perception_, food_, poison_); }

    static constexpr std::size_t organisms_per_block = 1024;
    /// The results of a tick in one block of organisms.
    struct Block {
        base::StateHash hash;             // hash of the living organisms
        std::vector<std::uint32_t> dying; // bodies whose health was at most 0 before they ate
        base::StateHash food_hash_change, poison_hash_change, eaten_hash_change;
        std::uint32_t food_eaten = 0, poison_eaten = 0, starved = 0, poisoned = 0;
        using Deaths = std::array<std::uint32_t, 6>; // by CauseOfDeath
        std::array<Deaths, 2> deaths{};              // in colonies, per species
    };
    /// Processes food and poison, in parallel if that is faster.
    template <class OfFood, class OfPoison>
    void for_each_kind(base::Executor& executor, OfFood&& of_food, OfPoison&& of_poison) {
        executor.parallel_for(2, physics::worth_dividing(bodies_.size()) ? 1 : 2, [&](base::Range kinds) {
            if (kinds.begin == 0) {
                of_food();
            }
            if (kinds.end == 2) {
                of_poison();
            }
        });
    }
    void resize_blocks(std::size_t count);
    void feed_and_remove_dead_in_block(const parameters::Parameters& parameters, std::uint32_t tick, std::size_t index);
    template <class Change>
    void change_health(Block& block, std::uint32_t body, Change&& change);
    /// Adds 1 to an element of `eaten`. `counts` states whether the state hash covers these numbers.
    void count_eaten(Block& block, std::uint32_t id, std::vector<std::uint32_t>& eaten, bool counts);
    bool is_dying(std::uint32_t body) const;
    void record_death(Block& block, std::uint32_t body, std::uint32_t tick, CauseOfDeath cause);

    base::Seed seed_;
    std::uint32_t index_;
    base::RandomKey behaviour_key_{base::Seed{}, base::Purpose::Behaviour, 0, 0};
    base::RandomKey heading_key_{base::Seed{}, base::Purpose::Heading, 0, 0};
    evolution::BrainLayout brain_;
    bool is_kinematic_ = false; // velocities are set directly, and bodies have no contacts
    physics::Area area_;
    physics::StepParameters step_parameters_;
    physics::Stepper stepper_;
    evolution::NextGeneration born_;
    std::vector<Arrival> arrivals_; // of the organisms that were placed or born
    LivingOrganisms living_;
    physics::Circles bodies_;
    physics::Boxes boxes_;
    BoxGrid obstacles_; // the boxes that do not move: no item may overlap them
    std::uint32_t crate_count_ = 0;
    Items food_, poison_;
    Perception perception_;
    ItemClaims food_claims_, poison_claims_;
    LifeRecords life_records_;
    IslandCounts counts_;
    std::uint32_t alive_count_ = 0;
    base::Column<std::uint32_t> body_of_; // index in bodies(), by id
    base::StateHash born_hash_;           // hash of the chromosomes, which do not change while an organism lives
    base::StateHash eaten_hash_;          // sum of hash_of_eaten() over all organisms
    bool food_counts_ = false, poison_counts_ = false; // whether the fitness depends on the numbers of eaten items
    base::StateHash hash_;

    // Colonies
    std::shared_ptr<const IslandOpening> opening_; // of this interval; nullptr in the first one
    std::array<ColonyCounts, 2> colony_{};         // per species
    Hunt hunt_;
    std::array<std::vector<float>, 2> latest_born_; // per species, with shuffle_births: chromosomes, oldest first
    bool has_births_ = false;
    std::uint64_t generation_ = 1;
    std::array<std::uint32_t, 2> lifespan_ticks_{}; // per species; 0: no age is lethal

    std::vector<Block> blocks_; // kept between ticks
    base::Column<std::uint32_t> spare_column_;
    std::uint32_t renewals_ = 0; // number of renewals of the near pairs in this generation
};

} // namespace evod::simulation
