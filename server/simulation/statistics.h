// Statistics: the results of a generation on an island, those of all ended generations, and the current state of an
// island.
//
// Determinism  organisms are summed in order of id, in blocks of fixed size; the sums of the blocks are added in order.
#pragma once

#include "server/base/executor.h"
#include "server/evolution/chromosome.h"
#include "server/evolution/price.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace evod::parameters {
struct Parameters;
}

namespace evod::simulation {

struct GeneStatistics {
    double mean = 0, deviation = 0, min = 0, max = 0; // standard deviation of the population: divided by n
};

/// What only colonies have (colony.h), of one species.
struct ColonyStatistics {
    std::uint32_t first_count = 0;  // organisms at the beginning of the generation
    std::uint32_t lowest_count = 0; // fewest living organisms after any tick
    double count_mean = 0;          // living organisms, mean over the ticks
    std::uint32_t born_count = 0, refused_count = 0, without_room_count = 0; // as in ColonyCounts
    std::uint32_t eaten_count = 0, old_count = 0;
    std::uint32_t died_count = 0; // deaths, of whatever cause
    // Of the organisms that died: children, and age at death.
    double children_mean = 0, children_variance = 0, age_mean_s = 0;
    friend bool operator==(const ColonyStatistics&, const ColonyStatistics&) = default;
};

struct GenerationStatistics {
    std::uint64_t generation = 1; // 1 for the first
    std::uint32_t island = 0;
    std::uint64_t end_tick = 0; // ticks since the run began
    std::uint32_t organism_count = 0;
    double fitness_best = 0, fitness_mean = 0, fitness_median = 0, fitness_worst = 0, fitness_deviation = 0;
    // One element per gene, in chromosome order. A new object has those of the body genes.
    std::vector<GeneStatistics> genes = std::vector<GeneStatistics>(evolution::body_gene_count);
    double diversity = 0; // mean over genes of deviation / (upper bound − lower bound); 0 for a gene with equal bounds
    std::uint32_t alive_count = 0, starved_count = 0, poisoned_count = 0;
    std::uint64_t food_eaten = 0, poison_eaten = 0;
    std::uint64_t clamp_count = 0;       // genes that were clamped when the generation was bred
    std::uint64_t too_fast_count = 0;    // number of times that a body moved more than its radius in a tick
    std::uint64_t speed_limit_count = 0; // number of times that max_speed_px_s limited a speed
    std::uint32_t best_organism = 0;     // lowest id with the best fitness
    double simulated_s = 0;
    // How the means of the genes changed from the previous generation. nullopt in the first generation, and if the
    // previous generation is not available. The account is known from the generation's beginning on, so a checkpoint
    // does not contain it.
    std::optional<evolution::SelectionAccount> account = std::nullopt;
    // In colonies, and of both species.
    std::optional<ColonyStatistics> colony = std::nullopt;
    // The predators, without `predators` of their own; empty if there are none. The other members are about the prey.
    std::vector<GenerationStatistics> predators = {};
};

/// The statistics of an ended generation, one entry per island. They are immutable, and copies share them.
class GenerationRows {
  public:
    GenerationRows(std::vector<GenerationStatistics> rows)
        : rows_{std::make_shared<const std::vector<GenerationStatistics>>(std::move(rows))} {}
    operator const std::vector<GenerationStatistics>&() const { return *rows_; }

    std::size_t size() const { return rows_->size(); }
    auto begin() const { return rows_->begin(); }
    auto end() const { return rows_->end(); }
    const GenerationStatistics& front() const { return rows_->front(); }
    const GenerationStatistics& operator[](std::size_t island) const { return (*rows_)[island]; }

  private:
    std::shared_ptr<const std::vector<GenerationStatistics>> rows_;
};

/// The ended generations, oldest first.
using History = std::deque<GenerationRows>;

/// The maximum number of generations, and of rows, whose statistics are kept in memory. A generation has one row per
/// island, whose size grows with the number of genes, so with many islands or genes fewer generations are kept. The
/// oldest are dropped first.
constexpr std::size_t history_generations_kept = 10'000, history_rows_kept = 131'072;
constexpr std::size_t history_generations_kept_of(std::size_t island_count,
                                                  std::size_t gene_count = evolution::body_gene_count) {
    const std::size_t rows = history_rows_kept * evolution::body_gene_count / gene_count;
    return std::min(history_generations_kept, std::max<std::size_t>(rows / island_count, 1));
}
/// The maximum number of previous generations whose statistics a fork keeps.
constexpr std::size_t history_generations_inherited = 1'000;

/// Calls visit(name, value) for every number except those of `genes` and `account`, in the order of the columns in
/// files. In files, the columns of for_each_gene_number() and those of `account` follow.
///
/// Statistics  GenerationStatistics, or const GenerationStatistics.
template <class Statistics, class Visit>
void for_each_number(Statistics&& s, Visit&& visit) {
    visit("generation", s.generation);
    visit("island", s.island);
    visit("end_tick", s.end_tick);
    visit("simulated_s", s.simulated_s);
    visit("organism_count", s.organism_count);
    visit("fitness_best", s.fitness_best);
    visit("fitness_mean", s.fitness_mean);
    visit("fitness_median", s.fitness_median);
    visit("fitness_worst", s.fitness_worst);
    visit("fitness_deviation", s.fitness_deviation);
    visit("diversity", s.diversity);
    visit("alive_count", s.alive_count);
    visit("starved_count", s.starved_count);
    visit("poisoned_count", s.poisoned_count);
    visit("food_eaten", s.food_eaten);
    visit("poison_eaten", s.poison_eaten);
    visit("clamp_count", s.clamp_count);
    visit("too_fast_count", s.too_fast_count);
    visit("speed_limit_count", s.speed_limit_count);
    visit("best_organism", s.best_organism);
}

/// Calls visit(name, value) for every number of a ColonyStatistics, in the order of the columns in files.
template <class Statistics, class Visit>
void for_each_colony_number(Statistics&& s, Visit&& visit) {
    visit("first_count", s.first_count);
    visit("lowest_count", s.lowest_count);
    visit("count_mean", s.count_mean);
    visit("born_count", s.born_count);
    visit("refused_count", s.refused_count);
    visit("without_room_count", s.without_room_count);
    visit("eaten_count", s.eaten_count);
    visit("old_count", s.old_count);
    visit("died_count", s.died_count);
    visit("children_mean", s.children_mean);
    visit("children_variance", s.children_variance);
    visit("age_mean_s", s.age_mean_s);
}

/// Calls visit(name, value) for every number of the first genes of s.genes.
///
/// gene_names  the names of these genes, in chromosome order.
template <class Statistics, class Names, class Visit>
void for_each_gene_number(Statistics&& s, const Names& gene_names, Visit&& visit) {
    for (std::size_t gene = 0; gene < gene_names.size(); ++gene) {
        const std::string name{gene_names[gene]};
        visit(name + "_mean", s.genes[gene].mean);
        visit(name + "_deviation", s.genes[gene].deviation);
        visit(name + "_min", s.genes[gene].min);
        visit(name + "_max", s.genes[gene].max);
    }
}

class Island;

/// Computes the statistics of the generation that has just ended. In colonies, those of fitness and genes are about the
/// organisms with which it began.
///
/// fitness  of each organism, by id.
/// tick     the last of the generation.
GenerationStatistics generation_statistics(const Island& island, const parameters::Parameters& parameters,
                                           std::span<const double> fitness, std::uint32_t tick,
                                           base::Executor& executor);

struct LiveStatistics {
    std::uint32_t organism_count = 0, alive_count = 0; // organisms born, organisms alive
    double health_mean = 0;                            // mean health of living organisms; 0 if there are none
    std::uint64_t food_eaten = 0, poison_eaten = 0;
    std::uint32_t starved_count = 0, poisoned_count = 0;
    std::uint32_t eaten_count = 0, old_count = 0, born_count = 0, predator_count = 0; // only in colonies
};

/// Computes LiveStatistics::health_mean.
///
/// health       health of all bodies, in any order; −infinity for placeholders of dead organisms.
/// alive_count  number of living organisms.
double mean_health(std::span<const float> health, std::uint32_t alive_count);

} // namespace evod::simulation
