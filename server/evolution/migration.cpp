#include "server/evolution/migration.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/ranking.h"
#include "server/evolution/selection.h"

#include <algorithm>

namespace evod::evolution {
namespace {

// The draws of one migration and island are told apart by what they decide, in the place of the tick.
enum Decision : std::uint64_t { Destination, WhoLeaves, WhoIsReplaced };

struct Edge {
    std::uint32_t from, to;
};

/// Ordered by (to, from).
std::vector<Edge> edges(std::uint32_t islands, Topology topology, base::Seed seed, std::uint64_t generation) {
    std::vector<Edge> result;
    if (islands < 2)
        return result;
    for (std::uint32_t from = 0; from < islands; ++from) {
        switch (topology) {
        case Topology::None:
            break;
        case Topology::Ring:
            result.push_back({from, (from + 1) % islands});
            break;
        case Topology::FullyConnected:
            for (std::uint32_t to = 0; to < islands; ++to)
                if (to != from)
                    result.push_back({from, to});
            break;
        case Topology::Random: {
            base::RandomStream random{{seed, base::Purpose::Migration, from, generation}, 0, Destination};
            const std::uint32_t other = random.below(islands - 1);
            result.push_back({from, other < from ? other : other + 1});
            break;
        }
        }
    }
    std::stable_sort(result.begin(), result.end(), [](const Edge& a, const Edge& b) { return a.to < b.to; });
    return result;
}

} // namespace

bool migration_due(std::uint64_t generation, const Parameters& parameters) {
    return parameters.migration != Topology::None && generation % parameters.migration_epoch == 0;
}

std::vector<Migrant> choose_migrants(std::span<const std::span<const double>> fitness, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation) {
    const auto islands = static_cast<std::uint32_t>(fitness.size());
    const auto population = [&](std::uint32_t island) { return static_cast<std::uint32_t>(fitness[island].size()); };
    const auto stream = [&](std::uint32_t island, std::uint32_t entity, Decision decision) {
        return base::RandomStream{{seed, base::Purpose::Migration, island, generation}, entity, decision};
    };
    base::InlineExecutor executor;
    std::vector<Ranking> rankings(fitness.begin(), fitness.end());

    std::vector<Migrant> migrants;
    std::vector<std::uint32_t> replaced; // at the island of the present edge, in the order in which they make room
    std::uint32_t arrived = 0;           // there, so far
    std::uint32_t previous_to = islands;
    for (const Edge edge : edges(islands, parameters.migration, seed, generation)) {
        if (edge.to != previous_to) {
            previous_to = edge.to;
            arrived = 0;
            if (parameters.immigrants_replace == Replaced::Worst) {
                const auto order = rankings[edge.to].best_first();
                replaced.assign(order.rbegin(), order.rend());
            } else {
                base::RandomStream random = stream(edge.to, 0, WhoIsReplaced);
                replaced = draw_unique(population(edge.to), population(edge.to), random, executor);
            }
        }
        const std::uint32_t leaving =
            std::min({parameters.migrant_count, population(edge.from), population(edge.to) - arrived});
        std::vector<std::uint32_t> drawn;
        std::span<const std::uint32_t> emigrants;
        if (parameters.emigrants == Emigrants::Best) {
            emigrants = rankings[edge.from].best_first().first(leaving);
        } else {
            base::RandomStream random = stream(edge.from, edge.to, WhoLeaves);
            drawn = draw_unique(population(edge.from), leaving, random, executor);
            emigrants = drawn;
        }
        for (const std::uint32_t organism : emigrants)
            migrants.push_back({edge.from, edge.to, organism, replaced[arrived++]});
    }
    return migrants;
}

void migrate(std::span<const Migrant> migrants, std::span<const IslandPopulation> islands) {
    struct Traveller {
        Chromosome genes;
        double fitness;
    };
    std::vector<Traveller> travellers;
    travellers.reserve(migrants.size());
    for (const Migrant& migrant : migrants) {
        const IslandPopulation& home = islands[migrant.from];
        EVOD_ASSERT(migrant.organism < home.fitness.size());
        travellers.push_back({home.genes->col(migrant.organism), home.fitness[migrant.organism]});
    }
    for (std::size_t i = 0; i < migrants.size(); ++i) {
        const IslandPopulation& destination = islands[migrants[i].to];
        EVOD_ASSERT(migrants[i].replaces < destination.fitness.size());
        destination.genes->col(migrants[i].replaces) = travellers[i].genes;
        destination.fitness[migrants[i].replaces] = travellers[i].fitness;
    }
}

} // namespace evod::evolution
