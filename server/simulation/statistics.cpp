#include "server/simulation/statistics.h"

#include "server/simulation/island.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace evod::simulation {
namespace {

GeneStatistics gene_statistics(const evolution::GeneMatrix& genes, Eigen::Index gene) {
    const Eigen::Index n = genes.cols();
    GeneStatistics s;
    s.min = s.max = static_cast<double>(genes(gene, 0));
    double sum = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto value = static_cast<double>(genes(gene, i));
        sum += value;
        s.min = std::min(s.min, value);
        s.max = std::max(s.max, value);
    }
    s.mean = sum / static_cast<double>(n);
    double squares = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        const double difference = static_cast<double>(genes(gene, i)) - s.mean;
        squares += difference * difference;
    }
    s.deviation = std::sqrt(squares / static_cast<double>(n));
    return s;
}

double median(std::span<const double> values) {
    std::vector<double> sorted(values.begin(), values.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    if (sorted.size() % 2 == 1)
        return *middle;
    return (*std::max_element(sorted.begin(), middle) + *middle) / 2;
}

} // namespace

GenerationStatistics generation_statistics(const Island& island, const Parameters& parameters,
                                           std::span<const double> fitness) {
    GenerationStatistics s;
    s.island = island.index();
    s.organism_count = static_cast<std::uint32_t>(fitness.size());

    const auto n = static_cast<double>(fitness.size());
    double sum = 0;
    for (const double value : fitness)
        sum += value;
    s.fitness_mean = sum / n;
    double squares = 0;
    for (const double value : fitness)
        squares += (value - s.fitness_mean) * (value - s.fitness_mean);
    s.fitness_deviation = std::sqrt(squares / n);
    const auto best = std::max_element(fitness.begin(), fitness.end()); // the first of equals
    s.best_organism = static_cast<std::uint32_t>(best - fitness.begin());
    s.fitness_best = *best;
    s.fitness_worst = *std::min_element(fitness.begin(), fitness.end());
    s.fitness_median = median(fitness);

    const evolution::GeneBounds bounds = evolution::gene_bounds(parameters);
    for (unsigned gene = 0; gene < evolution::gene_count; ++gene) {
        s.genes[gene] = gene_statistics(island.born().genes, gene);
        const auto width = static_cast<double>(bounds.max(gene) - bounds.min(gene));
        s.diversity += width > 0 ? s.genes[gene].deviation / width / evolution::gene_count : 0;
    }

    const LiveStatistics live = island.live_statistics();
    s.alive_count = live.alive_count;
    s.starved_count = live.starved_count;
    s.poisoned_count = live.poisoned_count;
    s.food_eaten = live.food_eaten;
    s.poison_eaten = live.poison_eaten;
    s.clamp_count = island.born().clamped_count;
    s.too_fast_count = island.counts().too_fast_count;
    s.speed_limit_count = island.counts().speed_limit_count;
    return s;
}

} // namespace evod::simulation
