#include "server/evolution/breeding_record.h"

#include "server/base/assert.h"
#include "server/evolution/breeding.h"
#include "server/evolution/scaling.h"
#include "server/evolution/tournament.h"

#include <algorithm>
#include <numeric>

namespace evod::evolution {
namespace {

using Contender = BreedingRecord::Contender;
using Pick = BreedingRecord::Pick;
using Descendant = BreedingRecord::Descendant;

/// The range of rows of a list that the record contains: first … end − 1.
struct Rows {
    std::uint32_t first, end;
    Rows(std::uint32_t wanted_first, std::uint32_t count, std::uint32_t count_max)
        : first{std::min(wanted_first, count)}, end{first + std::min(count - first, count_max)} {}
};

std::vector<float> chromosome(const GeneMatrix& genes, std::uint32_t organism) {
    const ConstGenes column = evolution::column(genes, organism);
    return {column.begin(), column.end()};
}

bool spins_a_wheel(const Parameters& parameters) {
    return parameters.selection == SelectionMethod::Roulette ||
           parameters.selection == SelectionMethod::StochasticUniversal;
}

/// candidates  candidate_count(); the organisms that are not among them can't be picked.
std::vector<Contender> contenders_of(Ranking& ranking, std::uint32_t candidates, std::span<const std::uint32_t> picks,
                                     const Picks& asked, const Parameters& parameters, const Rows& rows) {
    const auto population = static_cast<std::uint32_t>(ranking.fitness().size());
    std::vector<std::uint32_t> ranks(population), copies(population);
    for (std::uint32_t rank = 0; rank < population; ++rank) {
        ranks[ranking.best_first()[rank]] = rank;
    }
    for (const std::uint32_t organism : picks) {
        ++copies[organism];
    }
    const bool are_all = candidates == population;
    const std::vector<double> best = are_all ? std::vector<double>{} : ranking.best_fitness(candidates);
    Ranking among_best{best};
    const std::vector<double> weights = scaled_fitness(are_all ? ranking : among_best, parameters);
    std::optional<Wheel> wheel;
    if (spins_a_wheel(parameters)) {
        wheel.emplace(weights);
    }
    const SelectionLaw law{candidates, asked, parameters};

    std::vector<Contender> contenders;
    for (std::uint32_t i = rows.first; i < rows.end; ++i) {
        Contender& contender = contenders.emplace_back();
        contender.fitness = ranking.fitness()[i];
        contender.rank = ranks[i];
        if (ranks[i] >= candidates) {
            continue;
        }
        const std::uint32_t candidate = are_all ? i : ranks[i];
        contender.weight = weights[candidate];
        if (wheel) {
            const std::span<const double> ends = wheel->slot_ends();
            contender.slot_begin = candidate == 0 ? 0 : ends[candidate - 1] / ends.back();
            contender.slot_end = ends[candidate] / ends.back();
        }
        contender.law = law.copies(ranks[i], wheel ? wheel->share(candidate) : 0);
        contender.copies = copies[i];
    }
    return contenders;
}

std::vector<Pick> picks_of(std::span<const std::uint32_t> picked, Ranking& ranking, std::uint32_t candidates,
                           const Parameters& parameters, const base::RandomKey& key, const Rows& rows,
                           base::Executor& executor) {
    const auto wanted = static_cast<std::uint32_t>(picked.size());
    std::vector<double> turns;
    if (parameters.selection == SelectionMethod::Roulette) {
        turns = roulette_turns(wanted, key, executor);
    }
    if (parameters.selection == SelectionMethod::StochasticUniversal) {
        base::RandomStream random = selection_stream(key);
        turns = universal_turns(wanted, random, executor);
    }
    const Tournament tournament = tournament_of(parameters);
    std::vector<Pick> picks;
    for (std::uint32_t i = rows.first; i < rows.end; ++i) {
        Pick& pick = picks.emplace_back();
        pick.organism = picked[i];
        if (!turns.empty()) {
            pick.turns = turns[i];
        }
        if (parameters.selection != SelectionMethod::Tournament) {
            continue;
        }
        pick.tournament = i / winners_of_each(candidates, tournament, wanted);
        const std::uint32_t contestants =
            tournament.replacement ? tournament.size : std::min(tournament.size, candidates);
        if (contestants <= held_contestants_max) {
            pick.contestants = contestants_of(*pick.tournament, candidates, tournament, wanted, key);
        }
        if (candidates < ranking.fitness().size()) {
            std::ranges::transform(pick.contestants, pick.contestants.begin(),
                                   [&](std::uint32_t rank) { return ranking.best_first()[rank]; });
        }
    }
    return picks;
}

/// Applies the mutations to a chromosome and records them.
struct WithRecord {
    Descendant& of;

    void mutate_order(const OrderMutation& by, const FreeGeneOperators& listed, Genes genes,
                      base::RandomStream& random) const {
        const auto apply = [&](auto items, base::RandomStream& stream) {
            const bool changed = by.apply(items, stream);
            return listed.rearrange(by, items, stream) || changed;
        };
        base::RandomStream same = random;
        std::vector<std::uint32_t> order(genes.size());
        std::iota(order.begin(), order.end(), 0u);
        if (apply(genes, random) && apply(std::span{order}, same)) {
            of.order = std::move(order);
        }
    }
    unsigned mutate(const ValueMutation<>& by, const FreeGeneOperators& listed, Genes genes,
                    base::RandomStream& random) const {
        const unsigned outside = by.apply(genes, random, of.changes);
        return outside + listed.mutate(genes, random, RecordGene{genes, of.changes});
    }
    unsigned clamp(Genes genes, const GeneBounds& bounds) const { return evolution::clamp(genes, bounds, of.changes); }
};

} // namespace

BreedingRecord record_breeding(std::span<const double> fitness, const GeneMatrix& genes, const Parameters& parameters,
                               std::uint32_t wanted, const BreedingKey& key, const WantedRows& rows,
                               base::Executor& executor) {
    const auto present = static_cast<std::uint32_t>(fitness.size());
    EVOD_ASSERT(present >= 1);
    EVOD_ASSERT(wanted >= 1);
    EVOD_ASSERT(genes.cols() == static_cast<Eigen::Index>(fitness.size()));
    Ranking ranking{fitness, executor};
    const Choice choice = choose(ranking, parameters, wanted, key, executor);
    const auto pick_count = static_cast<std::uint32_t>(choice.picks.size());

    BreedingRecord record;
    record.places = choice.places;
    record.contender_count = present;
    record.pick_count = pick_count;
    const std::uint32_t candidates = candidate_count(choice.places, present, parameters);
    record.contenders =
        contenders_of(ranking, candidates, choice.picks, picks_for(choice.places, candidates, parameters), parameters,
                      {rows.first_contender, present, rows.count_max});
    record.picks = picks_of(choice.picks, ranking, candidates, parameters, selection_key(key),
                            {rows.first_pick, pick_count, rows.count_max}, executor);

    const Descent<> descent{genes, parameters, key};
    const Rows descendants{rows.first_descendant, wanted, rows.count_max};
    for (std::uint32_t place = descendants.first; place < descendants.end; ++place) {
        Descendant& descendant = record.descendants.emplace_back();
        descendant.id = place;
        descendant.genes.resize(static_cast<std::size_t>(genes.rows()));
        descendant.from_second = GeneMask<>{static_cast<unsigned>(genes.rows())};
        const Genes child_genes{descendant.genes};
        if (place < choice.places.survivors) {
            const std::uint32_t organism = choice.survivors()[place];
            descendant.parents = {organism, organism};
            descent.keep(organism, place, parameters.mutate_survivors && place >= choice.places.elite, child_genes,
                         WithRecord{descendant});
        } else {
            const std::uint32_t child = place - choice.places.survivors;
            Mixture<> mixture{static_cast<unsigned>(genes.rows())};
            descendant.crossed = descent.draw_mixture(child / 2, mixture);
            if (child % 2 == 1) {
                mixture.from_second.complement();
            }
            const auto inheritance = inheritance_of(choice.pairs[child / 2], mixture.from_second);
            descendant.parents = inheritance.parents;
            descendant.from_second = inheritance.from_second;
            descendant.second_share = mixture.second_share;
            if (mixture.spreads || (descendant.crossed && !parameters.listed_genes.empty())) {
                descendant.crossed_genes.resize(child_genes.size());
                descent.cross(inheritance, mixture, descendant.crossed_genes);
            }
            descent.make_child(inheritance, mixture, place, child_genes, WithRecord{descendant});
        }
        descendant.first_genes = chromosome(genes, descendant.parents.first);
        descendant.second_genes = chromosome(genes, descendant.parents.second);
    }
    return record;
}

} // namespace evod::evolution
