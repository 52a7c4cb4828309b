#include "server/evolution/next_generation.h"

#include "server/base/assert.h"
#include "server/evolution/crossover.h"
#include "server/evolution/mutation.h"
#include "server/evolution/ranking.h"
#include "server/evolution/rearranging.h"
#include "server/evolution/selection.h"

#include <algorithm>
#include <numeric>

namespace evod::evolution {
namespace {

constexpr std::size_t pairs_per_piece = 512;
constexpr std::size_t survivors_per_piece = 1024;
constexpr std::size_t prefetched_ahead = 8;

/// `share` of `count`, to the nearest, half up; at least 1.
std::uint32_t share_of(std::uint32_t count, double share) {
    return std::max(1u, std::min(count, static_cast<std::uint32_t>(share * count + 0.5)));
}

/// The elite, then the picks in order, of which each of the elite has used up one, if it was picked.
std::vector<std::uint32_t> elite_then_picks(std::span<const std::uint32_t> elite, std::vector<std::uint32_t> picks,
                                            std::size_t population) {
    if (elite.empty())
        return picks;
    std::vector<std::uint32_t> survivors(elite.begin(), elite.end());
    std::vector<bool> has_a_pick_to_use(population);
    for (const std::uint32_t organism : elite)
        has_a_pick_to_use[organism] = true;
    for (const std::uint32_t organism : picks) {
        if (survivors.size() >= picks.size())
            break;
        if (has_a_pick_to_use[organism])
            has_a_pick_to_use[organism] = false;
        else
            survivors.push_back(organism);
    }
    return survivors;
}

/// The elite, then the others of the best `count` in index order.
std::vector<std::uint32_t> elite_then_best(std::span<const std::uint32_t> best_first, std::uint32_t elite,
                                           std::uint32_t count) {
    std::vector<std::uint32_t> survivors(best_first.begin(), best_first.begin() + elite);
    std::vector<bool> stays(best_first.size());
    for (const std::uint32_t organism : best_first.subspan(elite, count - elite))
        stays[organism] = true;
    survivors.reserve(count);
    for (std::uint32_t organism = 0; organism < stays.size(); ++organism)
        if (stays[organism])
            survivors.push_back(organism);
    return survivors;
}

class Breeding {
  public:
    Breeding(const GeneMatrix& genes, const Parameters& parameters, const BreedingKey& key, base::Executor& executor)
        : present_{genes}
        , key_{key}
        , executor_{executor}
        , crossover_{parameters}
        , rearranging_{parameters}
        , mutation_{parameters}
        , bounds_{gene_bounds(parameters)} {}

    /// Copies the survivors; those after `kept` are mutated.
    void keep(std::span<const std::uint32_t> survivors, std::uint32_t kept, NextGeneration& next) const {
        const base::RandomKey key = random_key(base::Purpose::SurvivorMutation);
        next.clamped_count += counted(survivors.size(), survivors_per_piece, [&](std::size_t i) {
            const auto place = static_cast<std::uint32_t>(i);
            const Genes genes = column(next.genes, place);
            if (i + prefetched_ahead < survivors.size())
                prefetch(survivors[i + prefetched_ahead]);
            std::ranges::copy(column(present_, survivors[i]), genes.begin());
            next.parents[i] = {survivors[i], survivors[i]};
            if (place < kept)
                return clamp(genes, bounds_);
            base::RandomStream rearranging{key, place, 0}, mutation{key, place, 1};
            rearranging_.apply(genes, rearranging);
            return mutation_.apply(genes, mutation);
        });
    }

    /// Fills the places from `first` on with two children a pair; the last pair may have room for only one.
    void breed(std::span<const Parents> pairs, std::uint32_t first, NextGeneration& next) const {
        const base::RandomKey crossover_key = random_key(base::Purpose::Crossover);
        const base::RandomKey rearranging_key = random_key(base::Purpose::Rearranging);
        const base::RandomKey mutation_key = random_key(base::Purpose::Mutation);
        const auto organisms = static_cast<std::uint32_t>(next.genes.cols());
        next.clamped_count += counted(pairs.size(), pairs_per_piece, [&](std::size_t i) {
            if (i + prefetched_ahead < pairs.size()) {
                prefetch(pairs[i + prefetched_ahead].first);
                prefetch(pairs[i + prefetched_ahead].second);
            }
            const Parents pair = pairs[i];
            base::RandomStream crossover{crossover_key, static_cast<std::uint32_t>(i)};
            GeneMask mask = crossover_.draw(crossover);
            unsigned clamped = 0;
            const auto begin = first + 2 * static_cast<std::uint32_t>(i);
            for (std::uint32_t place = begin; place < std::min(begin + 2, organisms); ++place, mask = ~mask) {
                const Genes child = column(next.genes, place);
                cross(column(present_, pair.first), column(present_, pair.second), mask, child);
                next.parents[place] = pair;
                base::RandomStream rearranging{rearranging_key, place}, mutation{mutation_key, place};
                rearranging_.apply(child, rearranging);
                clamped += mutation_.apply(child, mutation);
            }
            return clamped;
        });
    }

  private:
    base::RandomKey random_key(base::Purpose purpose) const {
        return {key_.seed, purpose, key_.island, key_.generation};
    }

    /// Has a chromosome fetched that is soon to be read: those of parents lie all over the memory.
    void prefetch(std::uint32_t organism) const {
        const ConstGenes genes = column(present_, organism);
        __builtin_prefetch(&genes.front());
        __builtin_prefetch(&genes.back());
    }

    /// Runs `work` for each index and adds up what it returns.
    template <class Work>
    std::uint64_t counted(std::size_t count, std::size_t grain, const Work& work) const {
        std::vector<std::uint64_t> of_piece((count + grain - 1) / grain);
        executor_.parallel_for(count, grain, [&](base::Range piece) {
            std::uint64_t sum = 0;
            for (std::size_t i = piece.begin; i < piece.end; ++i)
                sum += work(i);
            of_piece[piece.begin / grain] = sum;
        });
        return std::accumulate(of_piece.begin(), of_piece.end(), std::uint64_t{0});
    }

    const GeneMatrix& present_;
    const BreedingKey& key_;
    base::Executor& executor_;
    Crossover crossover_;
    RearrangingMutation rearranging_;
    ValueMutation mutation_;
    GeneBounds bounds_;
};

} // namespace

Places share_places(std::uint32_t present, std::uint32_t wanted, const Parameters& parameters) {
    const std::uint32_t common = std::min(present, wanted);
    const std::uint32_t elite = std::min(parameters.elite_count, common);
    std::uint32_t survivors = 0;
    switch (parameters.population_model) {
    case PopulationModel::Hybrid:
        survivors = share_of(wanted, parameters.survivors);
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

NextGeneration next_generation(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, base::Executor& executor) {
    const auto present = static_cast<std::uint32_t>(fitness.size());
    EVOD_ASSERT(present >= 1);
    EVOD_ASSERT(genes.cols() == static_cast<Eigen::Index>(fitness.size()));
    EVOD_ASSERT(wanted >= 1);
    const Places places = share_places(present, wanted, parameters);

    Ranking ranking{fitness, executor};
    const auto elite = places.elite > 0 ? ranking.best_first().first(places.elite) : std::span<const std::uint32_t>{};
    const base::RandomKey selection_key{key.seed, base::Purpose::Selection, key.island, key.generation};
    std::vector<std::uint32_t> survivors, selected;
    std::span<const std::uint32_t> parents = selected;
    if (parameters.population_model == PopulationModel::Hybrid) {
        survivors = elite_then_picks(
            elite, select(ranking, {.wanted = places.survivors, .pool = present}, parameters, selection_key, executor),
            present);
        parents = survivors;
    } else {
        if (places.survivors > 0)
            survivors = elite_then_best(ranking.best_first(), places.elite, places.survivors);
        if (places.children > 0)
            selected = select(
                ranking, {.wanted = std::max(2u, places.children), .pool = share_of(present, parameters.survivors)},
                parameters, selection_key, executor);
        parents = selected;
    }
    const std::vector<Parents> pairs = pair_up(
        parents, (places.children + 1) / 2, {key.seed, base::Purpose::Pairing, key.island, key.generation}, executor);

    NextGeneration next{.genes = GeneMatrix(gene_count, wanted),
                        .parents = std::vector<Parents>(wanted),
                        .elite_count = places.elite,
                        .survivor_count = places.survivors,
                        .clamped_count = 0};
    const Breeding breeding{genes, parameters, key, executor};
    breeding.keep(survivors, parameters.mutate_survivors ? places.elite : places.survivors, next);
    breeding.breed(pairs, places.survivors, next);
    return next;
}

} // namespace evod::evolution
