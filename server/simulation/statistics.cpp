#include "server/simulation/statistics.h"

#include "server/simulation/island.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace evod::simulation {
namespace {

constexpr std::size_t organisms_per_block = 8192;

constexpr std::size_t block_genes = evolution::body_gene_count;

/// Sums of the fitness and of each gene: first of the values, then of the squared differences from the mean.
struct Sums {
    double fitness = 0;
    std::vector<double> genes;

    explicit Sums(std::size_t gene_count = 0) : genes(gene_count) {}

    Sums& operator+=(const Sums& other) {
        fitness += other.fitness;
        for (std::size_t gene = 0; gene < genes.size(); ++gene) {
            genes[gene] += other.genes[gene];
        }
        return *this;
    }
    Sums over(std::size_t count) const {
        const auto n = static_cast<double>(count);
        Sums means{*this};
        means.fitness /= n;
        for (double& gene : means.genes) {
            gene /= n;
        }
        return means;
    }
};

struct Extremes {
    std::uint32_t best_organism;
    double worst;
    std::vector<float> gene_min, gene_max;
};

/// A population, whose organisms are processed block by block.
struct Population {
    std::span<const double> fitness;
    const evolution::GeneMatrix& genes;
    base::Executor& executor;

    std::size_t gene_count() const { return static_cast<std::size_t>(genes.rows()); }
    const float* chromosome(std::size_t organism) const { return genes.data() + organism * gene_count(); }

    /// Returns the results of of_block(range) for all blocks, in order.
    template <class Result, class OfBlock>
    std::vector<Result> each_block(const OfBlock& of_block) const {
        std::vector<Result> results((fitness.size() + organisms_per_block - 1) / organisms_per_block);
        executor.parallel_for(fitness.size(), organisms_per_block,
                              [&](base::Range block) { results[block.begin / organisms_per_block] = of_block(block); });
        return results;
    }

    /// Returns Σ (value − centre)^power for the fitness and for each gene; power is 1 or 2.
    template <unsigned power>
    Sums sums(const Sums& centre) const {
        const auto raised = [](double difference) { return power == 1 ? difference : difference * difference; };
        Sums total{gene_count()};
        const auto blocks = each_block<Sums>([&](base::Range block) {
            Sums sum{gene_count()};
            for (std::size_t i = block.begin; i < block.end; ++i) {
                sum.fitness += raised(fitness[i] - centre.fitness);
            }
            evolution::for_each_block_of_genes(static_cast<unsigned>(gene_count()), [&](unsigned first) {
                std::array<double, block_genes> of_genes{};
                for (std::size_t i = block.begin; i < block.end; ++i) {
                    const float* its = chromosome(i) + first;
                    for (std::size_t gene = 0; gene < block_genes; ++gene) {
                        of_genes[gene] += raised(static_cast<double>(its[gene]) - centre.genes[first + gene]);
                    }
                }
                std::ranges::copy(of_genes, sum.genes.begin() + first);
            });
            return sum;
        });
        for (const Sums& sum : blocks) {
            total += sum;
        }
        return total;
    }

    Extremes extremes() const {
        const auto blocks = each_block<Extremes>([&](base::Range block) {
            const float* first = chromosome(block.begin);
            Extremes e{static_cast<std::uint32_t>(block.begin),
                       fitness[block.begin],
                       {first, first + gene_count()},
                       {first, first + gene_count()}};
            for (std::size_t i = block.begin; i < block.end; ++i) {
                if (fitness[i] > fitness[e.best_organism]) {
                    e.best_organism = static_cast<std::uint32_t>(i);
                }
                e.worst = std::min(e.worst, fitness[i]);
            }
            evolution::for_each_block_of_genes(static_cast<unsigned>(gene_count()), [&](unsigned first_gene) {
                float *const min = e.gene_min.data() + first_gene, *const max = e.gene_max.data() + first_gene;
                for (std::size_t i = block.begin; i < block.end; ++i) {
                    const float* its = chromosome(i) + first_gene;
                    for (std::size_t gene = 0; gene < block_genes; ++gene) {
                        min[gene] = std::min(min[gene], its[gene]);
                        max[gene] = std::max(max[gene], its[gene]);
                    }
                }
            });
            return e;
        });
        Extremes all = blocks.front();
        for (const Extremes& e : blocks) {
            if (fitness[e.best_organism] > fitness[all.best_organism]) {
                all.best_organism = e.best_organism; // among equals, the first is kept
            }
            all.worst = std::min(all.worst, e.worst);
            for (std::size_t gene = 0; gene < gene_count(); ++gene) {
                all.gene_min[gene] = std::min(all.gene_min[gene], e.gene_min[gene]);
                all.gene_max[gene] = std::max(all.gene_max[gene], e.gene_max[gene]);
            }
        }
        return all;
    }
};

double median(std::span<const double> values) {
    std::vector<double> sorted(values.begin(), values.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    if (sorted.size() % 2 == 1) {
        return *middle;
    }
    return (*std::max_element(sorted.begin(), middle) + *middle) / 2;
}

} // namespace

namespace {

/// Sets the statistics of fitness and genes: those of the organisms [ids.begin, ids.end).
void add_population(GenerationStatistics& s, const Island& island, base::Range ids,
                    const parameters::Parameters& parameters, std::span<const double> all_fitness,
                    base::Executor& executor) {
    const std::span<const double> fitness = all_fitness.subspan(ids.begin, ids.end - ids.begin);
    const evolution::GeneMatrix& all_genes = island.born().genes;
    const bool is_whole = fitness.size() == all_fitness.size();
    const evolution::GeneMatrix part =
        is_whole
            ? evolution::GeneMatrix{}
            : evolution::GeneMatrix{all_genes.middleCols(static_cast<Eigen::Index>(ids.begin), std::ssize(fitness))};
    const evolution::GeneMatrix& genes = is_whole ? all_genes : part;
    const auto gene_count = static_cast<std::size_t>(genes.rows());
    s.genes.assign(gene_count, {});
    if (fitness.empty()) {
        return;
    }
    const bool is_short = gene_count < block_genes;
    const evolution::GeneMatrix longer = is_short ? evolution::with_a_block(genes) : evolution::GeneMatrix{};
    const Population population{fitness, is_short ? longer : genes, executor};
    const Sums mean = population.sums<1>(Sums{population.gene_count()}).over(fitness.size());
    const Sums variance = population.sums<2>(mean).over(fitness.size());
    const Extremes extremes = population.extremes();
    s.best_organism = extremes.best_organism + static_cast<std::uint32_t>(ids.begin);
    s.fitness_best = fitness[extremes.best_organism];
    s.fitness_mean = mean.fitness;
    s.fitness_median = median(fitness);
    s.fitness_worst = extremes.worst;
    s.fitness_deviation = std::sqrt(variance.fitness);

    const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
    for (std::size_t gene = 0; gene < gene_count; ++gene) {
        s.genes[gene] = {.mean = mean.genes[gene],
                         .deviation = std::sqrt(variance.genes[gene]),
                         .min = static_cast<double>(extremes.gene_min[gene]),
                         .max = static_cast<double>(extremes.gene_max[gene])};
        const auto width = static_cast<double>(bounds.max(static_cast<Eigen::Index>(gene)) -
                                               bounds.min(static_cast<Eigen::Index>(gene)));
        s.diversity += width > 0 ? s.genes[gene].deviation / width / static_cast<double>(gene_count) : 0;
    }
}

/// Sets the numbers of lives and deaths of a species of a colony.
///
/// tick  the last of the generation.
void add_lives(GenerationStatistics& s, const Island& island, Species species, std::uint32_t tick, double tick_s) {
    const ColonyCounts& counts = island.colony_counts()[static_cast<std::size_t>(species)];
    const LifeRecords& records = island.life_records();
    ColonyStatistics colony{.first_count = counts.first,
                            .lowest_count = counts.lowest,
                            .count_mean = tick == 0 ? 0 : static_cast<double>(counts.living_sum) / tick,
                            .born_count = counts.born,
                            .refused_count = counts.refused,
                            .without_room_count = counts.without_room,
                            .eaten_count = counts.eaten,
                            .old_count = counts.old};
    double children = 0, squares = 0, ages = 0;
    s.organism_count = 0;
    s.food_eaten = s.poison_eaten = 0;
    for (std::uint32_t id = 0; id < records.cause.size(); ++id) {
        if (island.species_of(id) != species) {
            continue;
        }
        ++s.organism_count;
        s.food_eaten += records.food_eaten[id];
        s.poison_eaten += records.poison_eaten[id];
        if (records.cause[id] != CauseOfDeath::Alive) {
            ++colony.died_count;
            const auto own = static_cast<double>(records.children[id]);
            children += own;
            squares += own * own;
            ages += island.age_ticks(id, tick) * tick_s;
        }
    }
    if (colony.died_count > 0) {
        colony.children_mean = children / colony.died_count;
        colony.children_variance = squares / colony.died_count - colony.children_mean * colony.children_mean;
        colony.age_mean_s = ages / colony.died_count;
    }
    s.alive_count = counts.living;
    s.starved_count = counts.starved;
    s.poisoned_count = counts.poisoned;
    s.colony = colony;
}

} // namespace

GenerationStatistics generation_statistics(const Island& island, const parameters::Parameters& parameters,
                                           std::span<const double> fitness, std::uint32_t tick,
                                           base::Executor& executor) {
    GenerationStatistics s;
    s.island = island.index();
    s.organism_count = static_cast<std::uint32_t>(fitness.size());
    const LiveStatistics live = island.live_statistics();
    s.alive_count = live.alive_count;
    s.starved_count = live.starved_count;
    s.poisoned_count = live.poisoned_count;
    s.food_eaten = live.food_eaten;
    s.poison_eaten = live.poison_eaten;
    s.clamp_count = island.born().clamped_count;
    s.too_fast_count = island.counts().too_fast_count;
    s.speed_limit_count = island.counts().speed_limit_count;
    s.account = island.born().account;
    if (!island.is_colony()) {
        add_population(s, island, {0, fitness.size()}, parameters, fitness, executor);
        return s;
    }
    // In colonies: the organisms with which the generation began.
    const std::uint32_t predators = island.born().predator_count, prey = island.bred_count() - predators;
    add_population(s, island, {0, prey}, parameters, fitness, executor);
    add_lives(s, island, Species::Prey, tick, parameters.tick_s);
    if (predators > 0 || island.colony_counts()[1].first > 0) {
        GenerationStatistics& second = s.predators.emplace_back();
        second.island = s.island;
        second.account = island.born().predator_account;
        add_population(second, island, {prey, prey + predators}, parameters, fitness, executor);
        add_lives(second, island, Species::Predator, tick, parameters.tick_s);
    }
    return s;
}

double mean_health(std::span<const float> health, std::uint32_t alive_count) {
    // The sum is taken in integers, so that it does not depend on the order of bodies. The fractional part is summed
    // separately, so that no reachable health overflows either sum.
    constexpr double parts = 1 << 16;
    std::int64_t whole = 0, rest = 0;
    for (const float of_one : health) {
        if (of_one != -std::numeric_limits<float>::infinity()) {
            const auto units = static_cast<std::int64_t>(of_one);
            whole += units;
            rest += std::llrint((static_cast<double>(of_one) - static_cast<double>(units)) * parts);
        }
    }
    return alive_count == 0 ? 0 : (static_cast<double>(whole) + static_cast<double>(rest) / parts) / alive_count;
}

} // namespace evod::simulation
