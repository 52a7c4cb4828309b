#include "server/evolution/breeding.h"

#include "server/base/assert.h"

namespace evod::evolution {
namespace {

/// Returns share · count, rounded to the nearest whole number (halves up), but at least 1.
std::uint32_t share_of(std::uint32_t count, double share) {
    return std::max(1u, std::min(count, static_cast<std::uint32_t>(share * count + 0.5)));
}

/// Returns the elite (at least one organism), followed by the picks in order. If an elite organism was also picked, one
/// of its picks is left out.
std::vector<std::uint32_t> elite_then_picks(std::span<const std::uint32_t> elite, std::span<const std::uint32_t> picks,
                                            std::size_t population) {
    std::vector<std::uint32_t> survivors(elite.begin(), elite.end());
    std::vector<bool> drops_next_pick(population);
    for (const std::uint32_t organism : elite) {
        drops_next_pick[organism] = true;
    }
    for (const std::uint32_t organism : picks) {
        if (survivors.size() >= picks.size()) {
            break;
        }
        if (drops_next_pick[organism]) {
            drops_next_pick[organism] = false;
        } else {
            survivors.push_back(organism);
        }
    }
    return survivors;
}

/// Returns the elite, followed by the other organisms among the best `count`, in index order.
std::vector<std::uint32_t> elite_then_best(std::span<const std::uint32_t> best_first, std::uint32_t elite,
                                           std::uint32_t count) {
    std::vector<std::uint32_t> survivors(best_first.begin(), best_first.begin() + elite);
    std::vector<bool> stays(best_first.size());
    for (const std::uint32_t organism : best_first.subspan(elite, count - elite)) {
        stays[organism] = true;
    }
    survivors.reserve(count);
    for (std::uint32_t organism = 0; organism < stays.size(); ++organism) {
        if (stays[organism]) {
            survivors.push_back(organism);
        }
    }
    return survivors;
}

/// Performs select() among the best `candidates` organisms.
std::vector<std::uint32_t> select_among_best(Ranking& ranking, std::uint32_t candidates, const Picks& picks,
                                             const Parameters& parameters, const base::RandomKey& key,
                                             base::Executor& executor) {
    const std::vector<double> fitness = ranking.best_fitness(candidates);
    Ranking among{fitness, executor};
    std::vector<std::uint32_t> picked = select(among, picks, parameters, key, executor);
    std::ranges::transform(picked, picked.begin(), [&](std::uint32_t rank) { return ranking.best_first()[rank]; });
    return picked;
}

} // namespace

Places share_places(std::uint32_t present, std::uint32_t wanted, const Parameters& parameters) {
    EVOD_ASSERT(present >= 1);
    EVOD_ASSERT(wanted >= 1);
    const std::uint32_t common = std::min(present, wanted);
    const std::uint32_t elite = std::min(parameters.elite_count, common);
    std::uint32_t survivors = 0;
    switch (parameters.population_model) {
    case PopulationModel::Hybrid:
        survivors = share_of(wanted, parameters.survivors);
        break;
    case PopulationModel::Nsga2:
        survivors = std::min(present, share_of(wanted, parameters.survivors));
        break;
    case PopulationModel::Generational:
        break;
    case PopulationModel::SteadyState:
        survivors = common - std::min(parameters.replaced_count, common);
        break;
    }
    survivors = std::max(survivors, elite);
    return {.elite = elite, .survivors = survivors, .children = wanted - survivors};
}

std::uint32_t candidate_count(const Places& places, std::uint32_t present, const Parameters& parameters) {
    return parameters.population_model == PopulationModel::Nsga2 ? places.survivors : present;
}

Picks picks_for(const Places& places, std::uint32_t candidates, const Parameters& parameters) {
    const PopulationModel model = parameters.population_model;
    if (model == PopulationModel::Hybrid) {
        return {.wanted = places.survivors, .pool = candidates};
    }
    return {.wanted = places.children > 0 ? std::max(2u, places.children) : 0,
            .pool = model == PopulationModel::Nsga2 ? candidates : share_of(candidates, parameters.survivors)};
}

base::RandomKey selection_key(const BreedingKey& key) {
    return {key.seed, base::Purpose::Selection, key.island, key.generation};
}

Choice choose(Ranking& ranking, const Parameters& parameters, std::uint32_t wanted, const BreedingKey& key,
              base::Executor& executor) {
    const auto present = static_cast<std::uint32_t>(ranking.fitness().size());
    Choice choice;
    const Places& places = choice.places = share_places(present, wanted, parameters);
    const std::uint32_t candidates = candidate_count(places, present, parameters);
    const Picks picks = picks_for(places, candidates, parameters);
    if (picks.wanted > 0 && candidates == present) {
        choice.picks = select(ranking, picks, parameters, selection_key(key), executor);
    } else if (picks.wanted > 0) {
        choice.picks = select_among_best(ranking, candidates, picks, parameters, selection_key(key), executor);
    }
    const bool hybrid = parameters.population_model == PopulationModel::Hybrid;
    if (hybrid && places.elite == 0) {
        choice.picks_survive = true;
    } else if (hybrid) {
        choice.others = elite_then_picks(ranking.best_first().first(places.elite), choice.picks, present);
    } else if (places.survivors > 0) {
        choice.others = elite_then_best(ranking.best_first(), places.elite, places.survivors);
    }
    choice.pairs = pair_up(hybrid ? choice.survivors() : choice.picks, (places.children + 1) / 2,
                           {key.seed, base::Purpose::Pairing, key.island, key.generation}, executor);
    return choice;
}

} // namespace evod::evolution
