#include "server/evolution/scaling.h"

#include "server/base/assert.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace evod::evolution {

double linear_rank_weight(std::uint32_t rank, std::uint32_t population, double pressure) {
    EVOD_ASSERT(rank < population);
    EVOD_ASSERT(pressure >= 1);
    EVOD_ASSERT(pressure <= 2);
    if (population == 1) {
        return 1;
    }
    return pressure - 2 * (pressure - 1) * (static_cast<double>(rank) / static_cast<double>(population - 1));
}

std::vector<double> scaled_fitness(Ranking& ranking, const Parameters& parameters) {
    const std::span<const double> fitness = ranking.fitness();
    const auto population = static_cast<std::uint32_t>(fitness.size());
    std::vector<double> scaled(fitness.begin(), fitness.end());
    switch (parameters.fitness_scaling) {
    case FitnessScaling::None:
        break;
    case FitnessScaling::Windowing: {
        const auto [least, greatest] = std::minmax_element(fitness.begin(), fitness.end());
        const double unit = std::isfinite(*greatest - *least) ? 1 : 0.5;
        const double floor = *least * unit;
        for (double& value : scaled) {
            value = value * unit - floor;
        }
        break;
    }
    case FitnessScaling::LinearRanking: {
        const auto best_first = ranking.best_first();
        for (std::uint32_t rank = 0; rank < population; ++rank) {
            scaled[best_first[rank]] = linear_rank_weight(rank, population, parameters.ranking_pressure);
        }
        break;
    }
    case FitnessScaling::ExponentialRanking: {
        double weight = 1;
        for (const std::uint32_t organism : ranking.best_first()) {
            scaled[organism] = weight;
            weight *= parameters.ranking_decay;
            // Without this test, rounding would keep the weight at the smallest positive double in all later ranks, and
            // computing with such subnormal numbers is slow.
            if (weight < std::numeric_limits<double>::min()) {
                weight = 0;
            }
        }
        break;
    }
    }
    return scaled;
}

} // namespace evod::evolution
