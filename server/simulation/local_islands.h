// Local islands: islands of a world that this process simulates.
//
// Owner        World, or one process of those that share a world (simulation/shared).
// Threads      the islands are advanced, bred and restored in parallel.
// Determinism  results do not depend on the division of work.
#pragma once

#include "server/simulation/islands.h"

#include <algorithm>
#include <functional>

namespace evod::simulation {

/// The organisms that migrate on one route.
struct Migrants {
    std::vector<double> fitness;
    std::vector<std::uint32_t> founders;
    evolution::GeneMatrix genes;
};

class LocalIslands final : public Islands {
  public:
    /// Holds the islands [indices.begin, indices.end) of a world. Lists that are passed or returned have one element
    /// for each of these islands. Commands, routes, island() and founders() name islands by their index in the world.
    LocalIslands(base::Seed seed, base::Range indices);

    void begin_generation(const parameters::Parameters& parameters, std::uint64_t generation, BredIslands bred,
                          base::Executor& executor) override;
    void restore(const parameters::Parameters& begun_with, const WorldState& state, base::Executor& executor) override;
    Advanced advance(const parameters::Parameters& parameters, GenerationTicks ticks, base::Executor& executor,
                     std::vector<DiedOut>& died_out) override;
    std::vector<GenerationStatistics> end_generation(const parameters::Parameters& parameters, std::uint32_t tick,
                                                     std::span<const Rating> given, base::Executor& executor) override;
    void breed_next_generation(const parameters::Parameters& parameters, std::uint64_t generation, std::uint32_t tick,
                               const Routes& routes, base::Executor& executor) override {
        breed_next_generation(parameters, generation, tick, routes, executor,
                              [](std::span<const evolution::MigrationRoute>, std::vector<Migrants>&) {});
    }
    /// carry(routes, migrants) gets the migrants of each route that begins on one of these islands, by route. It adds
    /// those of the routes that end on one of them. Called once for each species that has routes.
    using Carry = std::function<void(std::span<const evolution::MigrationRoute>, std::vector<Migrants>&)>;
    /// The same, with migrants from and to other islands of the world.
    void breed_next_generation(const parameters::Parameters& parameters, std::uint64_t generation, std::uint32_t tick,
                               const Routes& routes, base::Executor& executor, const Carry& carry);
    EntityIds place(const PlaceEntities& command, const parameters::Parameters& parameters,
                    std::uint32_t tick) override;
    void remove(const RemoveEntities& command, std::uint32_t tick) override;

    std::span<const IslandSummary> summaries() const override { return summaries_; }
    const Island& island(std::size_t index) const override { return islands_[index - first_]; }
    std::span<const std::uint32_t> founders(std::size_t index) const override {
        return founders_.empty() ? std::span<const std::uint32_t>{} : founders_[index - first_];
    }
    BredIslands bred() const override;
    std::vector<IslandOutcome> outcomes() const override;
    std::vector<IslandState> states(base::Executor& executor) const override;
    std::vector<LiveStatistics> live_statistics() const override {
        std::vector<LiveStatistics> all(islands_.size());
        std::ranges::transform(islands_, all.begin(), &Island::live_statistics);
        return all;
    }
    std::unique_ptr<Islands> copy() const override { return std::make_unique<LocalIslands>(*this); }

    bool holds(std::size_t index) const { return first_ <= index && index < first_ + islands_.size(); }

  private:
    /// Calls body(i) for every element i of islands_, on the threads of the executor.
    template <class Body>
    void for_each_island(base::Executor& executor, Body&& body) const {
        executor.parallel_for(islands_.size(), 1, [&](base::Range range) {
            for (std::size_t i = range.begin; i < range.end; ++i) {
                body(i);
            }
        });
    }
    void use(std::span<const Rating> given, const parameters::Parameters& parameters);
    /// The chromosomes from which element i of islands_ breeds.
    const evolution::GeneMatrix& breeding_genes(std::size_t i) const;
    void find_fitness(const parameters::Parameters& parameters, std::uint32_t tick, base::Executor& executor);
    /// The organisms of a species from which the next generation comes, per island.
    struct Breeders {
        std::vector<evolution::GeneMatrix> genes;
        std::vector<std::vector<double>> fitness;
        Founders founders; // empty if unknown
    };
    /// Lets migrants replace organisms. Returns the places of the replaced ones, per island.
    ///
    /// key  keys the draws: the number of the generation.
    std::vector<std::vector<std::uint32_t>> migrate(Breeders& breeders, const parameters::Parameters& parameters,
                                                    std::uint64_t key,
                                                    std::span<const evolution::MigrationRoute> routes,
                                                    const Carry& carry) const;
    // The parts of breed_next_generation() of colonies (local_colonies.cpp).
    BredIslands bred_with_predators(const parameters::Parameters& parameters, std::uint64_t generation,
                                    const Routes& routes, base::Executor& executor, const Carry& carry);
    BredIslands continued(const parameters::Parameters& parameters, std::uint64_t generation, std::uint32_t tick,
                          const Routes& routes, base::Executor& executor, const Carry& carry);
    evolution::BreedingKey key_of(std::size_t i, Species species, std::uint64_t generation) const {
        return {.seed = seed_,
                .island = islands_[i].index() | static_cast<std::uint32_t>(species) << 31,
                .generation = generation};
    }
    /// Gives children the founders of their first parents.
    void find_founders();
    void summarise(bool at_first_moment);

    base::Seed seed_;
    std::size_t first_; // index of the first island in the world
    std::vector<Island> islands_;
    std::vector<IslandSummary> summaries_;
    Founders founders_;
    // Of the ended generation, as in IslandOutcome, per island.
    std::vector<std::vector<double>> fitness_, objectives_;
    std::vector<evolution::GeneMatrix> repaired_;
    // Per island: whether its last organism died in this tick. Kept between ticks to reuse the memory.
    std::vector<std::uint8_t> died_out_;
};

} // namespace evod::simulation
