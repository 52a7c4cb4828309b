#include "server/evolution/migration.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/ranking.h"
#include "server/evolution/selection.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace evod::evolution {
namespace {

// Each kind of decision has its own stream per migration and island: the Decision takes the place of the tick.
enum Decision : std::uint64_t { Destination, EmigrantChoice, ReplacedChoice, LastPlaces };

struct Edge {
    std::uint32_t from, to;
};

/// Returns the pairs of islands between which migrants are sent, ordered by (to, from).
std::vector<Edge> edges(std::uint32_t islands, Topology topology, base::Seed seed, std::uint64_t generation) {
    std::vector<Edge> result;
    if (islands < 2) {
        return result;
    }
    for (std::uint32_t from = 0; from < islands; ++from) {
        switch (topology) {
        case Topology::None:
            break;
        case Topology::Ring:
            result.push_back({from, (from + 1) % islands});
            break;
        case Topology::FullyConnected:
            for (std::uint32_t to = 0; to < islands; ++to) {
                if (to != from) {
                    result.push_back({from, to});
                }
            }
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

/// Divides the places of an island among the edges that lead to it. In each round, every edge that has migrants left
/// gets one place, until all places or all migrants are used up. If the last round is incomplete, the edges that get a
/// place in it are drawn.
///
/// wanted   number of migrants of each edge.
/// returns  how many migrants of each edge get a place. If there is room for all, this is `wanted`, and nothing is
///          drawn.
std::vector<std::uint32_t> share_of_places(std::vector<std::uint32_t> wanted, std::uint32_t places,
                                           base::RandomStream random, base::Executor& executor) {
    if (std::accumulate(wanted.begin(), wanted.end(), std::uint64_t{0}) <= places) {
        return wanted;
    }
    std::vector<std::uint32_t> shares(wanted.size());
    std::vector<std::uint32_t> waiting(wanted.size()); // edges with migrants left, all with equally many places
    std::iota(waiting.begin(), waiting.end(), 0u);
    while (places > 0) {
        std::erase_if(waiting, [&](std::uint32_t edge) { return shares[edge] == wanted[edge]; });
        const auto count = static_cast<std::uint32_t>(waiting.size());
        if (places < count) {
            for (const std::uint32_t index : draw_unique(count, places, random, executor)) {
                ++shares[waiting[index]];
            }
            break;
        }
        std::uint32_t rounds = places / count;
        for (const std::uint32_t edge : waiting) {
            rounds = std::min(rounds, wanted[edge] - shares[edge]);
        }
        for (const std::uint32_t edge : waiting) {
            shares[edge] += rounds;
        }
        places -= rounds * count;
    }
    return shares;
}

} // namespace

bool migration_due(std::uint64_t generation, const Parameters& parameters) {
    EVOD_ASSERT(generation >= 1);
    EVOD_ASSERT(parameters.migration_epoch >= 1);
    return parameters.migration != Topology::None && generation % parameters.migration_epoch == 0;
}

std::vector<MigrationRoute> plan_migration(std::span<const std::uint32_t> populations, const Parameters& parameters,
                                           base::Seed seed, std::uint64_t generation) {
    EVOD_ASSERT(generation >= 1);
    base::InlineExecutor executor;
    std::vector<MigrationRoute> routes;
    const std::vector<Edge> all =
        edges(static_cast<std::uint32_t>(populations.size()), parameters.migration, seed, generation);
    for (auto first = all.begin(); first != all.end();) {
        const std::uint32_t to = first->to;
        const auto last = std::find_if(first, all.end(), [&](const Edge& edge) { return edge.to != to; });
        std::vector<std::uint32_t> wanted;
        for (auto edge = first; edge != last; ++edge) {
            wanted.push_back(std::min(parameters.migrant_count, populations[edge->from]));
        }
        const std::vector<std::uint32_t> leaving = share_of_places(
            std::move(wanted), populations[to] - std::min(parameters.elite_count, populations[to]),
            base::RandomStream{{seed, base::Purpose::Migration, to, generation}, 0, LastPlaces}, executor);
        std::uint32_t place = 0;
        for (const std::uint32_t count : leaving) {
            const std::uint32_t from = first++->from;
            if (count > 0) {
                routes.push_back({.from = from, .to = to, .count = count, .first_place = place});
            }
            place += count;
        }
    }
    return routes;
}

std::vector<std::uint32_t> emigrants(const MigrationRoute& route, Ranking& ranking, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation) {
    if (parameters.emigrants == Emigrants::Best) {
        const auto best = ranking.best_first().first(route.count);
        return {best.begin(), best.end()};
    }
    base::InlineExecutor executor;
    base::RandomStream random{{seed, base::Purpose::Migration, route.from, generation}, route.to, EmigrantChoice};
    return draw_unique(static_cast<std::uint32_t>(ranking.fitness().size()), route.count, random, executor);
}

std::vector<std::uint32_t> replaced_first(std::uint32_t island, Ranking& ranking, const Parameters& parameters,
                                          base::Seed seed, std::uint64_t generation) {
    const auto best_first = ranking.best_first();
    const auto elite = best_first.first(std::min<std::size_t>(parameters.elite_count, best_first.size()));
    if (parameters.immigrants_replace == Replaced::Worst) {
        return {best_first.rbegin(), best_first.rend() - static_cast<std::ptrdiff_t>(elite.size())};
    }
    base::InlineExecutor executor;
    base::RandomStream random{{seed, base::Purpose::Migration, island, generation}, 0, ReplacedChoice};
    const auto population = static_cast<std::uint32_t>(ranking.fitness().size());
    std::vector<std::uint32_t> replaced = draw_unique(population, population, random, executor);
    std::vector<bool> is_elite(population);
    for (const std::uint32_t organism : elite) {
        is_elite[organism] = true;
    }
    std::erase_if(replaced, [&](std::uint32_t organism) { return is_elite[organism]; });
    return replaced;
}

std::vector<Migrant> choose_migrants(std::span<const std::span<const double>> fitness, const Parameters& parameters,
                                     base::Seed seed, std::uint64_t generation) {
    std::vector<Ranking> rankings(fitness.begin(), fitness.end());
    std::vector<std::uint32_t> populations;
    for (const std::span<const double> island : fitness) {
        populations.push_back(static_cast<std::uint32_t>(island.size()));
    }
    std::vector<Migrant> migrants;
    std::vector<std::uint32_t> replaced; // on the island `to` of the previous route
    std::uint32_t to = ~0U;
    for (const MigrationRoute& route : plan_migration(populations, parameters, seed, generation)) {
        if (std::exchange(to, route.to) != route.to) {
            replaced = replaced_first(to, rankings[to], parameters, seed, generation);
        }
        std::uint32_t place = route.first_place;
        for (const std::uint32_t organism : emigrants(route, rankings[route.from], parameters, seed, generation)) {
            migrants.push_back({route.from, to, organism, replaced[place++]});
        }
    }
    return migrants;
}

void migrate(std::span<const Migrant> migrants, std::span<const IslandPopulation> islands) {
    struct Traveller {
        Eigen::ArrayXf genes;
        double fitness;
    };
    std::vector<Traveller> travellers;
    travellers.reserve(migrants.size());
    for (const Migrant& migrant : migrants) {
        EVOD_ASSERT(migrant.from < islands.size());
        const IslandPopulation& home = islands[migrant.from];
        EVOD_ASSERT(migrant.organism < home.fitness.size());
        EVOD_ASSERT(home.genes->cols() == static_cast<Eigen::Index>(home.fitness.size()));
        travellers.push_back({home.genes->col(migrant.organism), home.fitness[migrant.organism]});
    }
    for (std::size_t i = 0; i < migrants.size(); ++i) {
        EVOD_ASSERT(migrants[i].to < islands.size());
        const IslandPopulation& destination = islands[migrants[i].to];
        EVOD_ASSERT(migrants[i].replaces < destination.fitness.size());
        destination.genes->col(migrants[i].replaces) = travellers[i].genes;
        destination.fitness[migrants[i].replaces] = travellers[i].fitness;
    }
}

} // namespace evod::evolution
