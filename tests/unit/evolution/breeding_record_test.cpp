#include "server/evolution/breeding_record.h"

#include "server/base/inline_executor.h"
#include "server/evolution/selection_law.h"
#include "server/evolution/tournament.h"
#include "tests/unit/evolution/draws.h"
#include "tests/unit/evolution/stage_choices.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace evod::evolution {
namespace {

constexpr WantedRows all_rows{.count_max = ~0u};

/// The input and the result of a breeding.
struct Case {
    std::vector<double> fitness;
    GeneMatrix genes;
    Parameters parameters;
    std::uint32_t wanted;
    BreedingKey key;

    Case(const Parameters& chosen, std::uint32_t present, std::uint32_t wanted_, std::uint64_t seed)
        : genes{initial_population(present, chosen, base::Seed{seed}, 0)}
        , parameters{chosen}
        , wanted{wanted_}
        , key{.seed = base::Seed{seed}, .island = 3, .generation = 7} {
        base::RandomStream random = stream_of(seed);
        for (std::uint32_t i = 0; i < present; ++i) {
            fitness.push_back(random.below(100) / 4.0 - 5); // with ties and negative values
        }
    }
    NextGeneration next() const {
        base::InlineExecutor executor;
        return next_generation(fitness, genes, parameters, wanted, key, executor);
    }
    BreedingRecord record(const WantedRows& rows = all_rows) const {
        base::InlineExecutor executor;
        return record_breeding(fitness, genes, parameters, wanted, key, rows, executor);
    }
};

/// Whether a change moved a gene that was outside its bounds.
bool brings_back(ChangeKind kind) {
    return kind == ChangeKind::Clamp || kind == ChangeKind::Reflect || kind == ChangeKind::Redraw;
}

/// The genes of a descendant, computed from its parents' genes and the record alone.
std::vector<float> made_of(const BreedingRecord::Descendant& descendant) {
    const std::size_t gene_count = descendant.genes.size();
    std::vector<float> mixed(gene_count), genes(gene_count);
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        mixed[gene] =
            descendant.from_second.contains(gene) ? descendant.second_genes[gene] : descendant.first_genes[gene];
        if (descendant.second_share > 0) {
            const double first = double{descendant.first_genes[gene]}, second = double{descendant.second_genes[gene]};
            mixed[gene] = static_cast<float>(first + descendant.second_share * (second - first));
        }
        if (!descendant.crossed_genes.empty()) {
            mixed[gene] = descendant.crossed_genes[gene];
        }
    }
    for (unsigned gene = 0; gene < gene_count; ++gene) {
        genes[gene] = mixed[descendant.order ? (*descendant.order)[gene] : gene];
    }
    for (const GeneChange& change : descendant.changes) {
        EXPECT_EQ(genes[change.gene], change.before);
        genes[change.gene] = change.after;
    }
    return genes;
}

class EveryChoice : public testing::TestWithParam<StageChoice> {};

TEST_P(EveryChoice, RecordsTheNextGenerationBitForBit) {
    for (const auto& [present, wanted] :
         {std::pair{1u, 1u}, {1u, 4u}, {2u, 3u}, {7u, 20u}, {150u, 150u}, {301u, 40u}}) {
        const Case bred{GetParam(), present, wanted, 881 + present};
        const NextGeneration next = bred.next();
        const BreedingRecord record = bred.record();
        ASSERT_EQ(record.contender_count, present);
        ASSERT_EQ(record.places.elite, next.elite_count);
        ASSERT_EQ(record.places.survivors, next.survivor_count);
        ASSERT_EQ(record.descendants.size(), wanted);
        std::uint64_t clamped = 0;
        for (std::uint32_t id = 0; id < wanted; ++id) {
            const auto& descendant = record.descendants[id];
            ASSERT_EQ(descendant.id, id);
            ASSERT_EQ(descendant.parents, next.parents[id]);
            ASSERT_TRUE(std::ranges::equal(descendant.first_genes, column(bred.genes, descendant.parents.first)));
            ASSERT_TRUE(std::ranges::equal(descendant.second_genes, column(bred.genes, descendant.parents.second)));
            ASSERT_TRUE(std::ranges::equal(descendant.genes, column(next.genes, id))) << "descendant " << id;
            ASSERT_TRUE(std::ranges::equal(made_of(descendant), column(next.genes, id))) << "descendant " << id;
            clamped +=
                static_cast<std::uint64_t>(std::ranges::count_if(descendant.changes, brings_back, &GeneChange::kind));
        }
        EXPECT_EQ(clamped, next.clamped_count);
    }
}

TEST_P(EveryChoice, RecordsAnyNumberOfGenesBitForBit) {
    for (const std::uint32_t free_genes : {1u, 58u, 322u}) {
        StageChoice choice = GetParam();
        choice.free_genes = free_genes;
        const Case bred{choice, 40, 50, 886 + free_genes};
        const NextGeneration next = bred.next();
        const BreedingRecord record = bred.record();
        ASSERT_EQ(next.genes.rows(), 6 + free_genes);
        std::uint64_t clamped = 0;
        for (std::uint32_t id = 0; id < 50; ++id) {
            const auto& descendant = record.descendants[id];
            ASSERT_EQ(descendant.parents, next.parents[id]);
            ASSERT_TRUE(std::ranges::equal(descendant.genes, column(next.genes, id))) << "descendant " << id;
            ASSERT_TRUE(std::ranges::equal(made_of(descendant), column(next.genes, id))) << "descendant " << id;
            clamped +=
                static_cast<std::uint64_t>(std::ranges::count_if(descendant.changes, brings_back, &GeneChange::kind));
        }
        EXPECT_EQ(clamped, next.clamped_count);
    }
}

TEST_P(EveryChoice, RecordsThePicksAndTheirOrigin) {
    const Case bred{GetParam(), 150, 130, 882};
    const BreedingRecord record = bred.record();
    const Parameters& p = bred.parameters;
    ASSERT_EQ(record.picks.size(), record.pick_count);
    std::map<std::uint32_t, std::uint32_t> copies;
    for (const auto& pick : record.picks) {
        ++copies[pick.organism];
        const auto& contender = record.contenders[pick.organism];
        const bool wheel =
            p.selection == SelectionMethod::Roulette || p.selection == SelectionMethod::StochasticUniversal;
        ASSERT_EQ(pick.turns.has_value(), wheel);
        ASSERT_EQ(pick.tournament.has_value(), p.selection == SelectionMethod::Tournament);
        if (wheel) {
            // Positions on the wheel are products there and quotients here, so they may differ by rounding.
            ASSERT_GE(*pick.turns, contender.slot_begin - 1e-12);
            ASSERT_LE(*pick.turns, contender.slot_end + 1e-12);
        }
        if (pick.tournament && p.tournament_size <= held_contestants_max) {
            ASSERT_EQ(pick.contestants.size(), p.tournament_size);
            ASSERT_EQ(std::ranges::count(pick.contestants, pick.organism) > 0, true);
            const auto fitter = std::ranges::count_if(
                pick.contestants, [&](std::uint32_t other) { return record.contenders[other].rank < contender.rank; });
            ASSERT_LT(fitter, p.tournament_winners);
        } else {
            ASSERT_TRUE(pick.contestants.empty());
        }
    }
    double expected = 0;
    std::vector<bool> ranked(bred.fitness.size());
    for (std::uint32_t i = 0; i < record.contender_count; ++i) {
        const auto& contender = record.contenders[i];
        EXPECT_EQ(contender.copies, copies[i]);
        EXPECT_EQ(contender.fitness, bred.fitness[i]);
        EXPECT_GE(contender.law.expected, 0);
        expected += contender.law.expected;
        ASSERT_FALSE(ranked[contender.rank]);
        ranked[contender.rank] = true;
        for (std::uint32_t j = 0; j < i; ++j) {
            ASSERT_EQ(record.contenders[j].rank < contender.rank, bred.fitness[j] >= bred.fitness[i]);
        }
    }
    EXPECT_NEAR(expected, record.pick_count, 1e-6);
    // All parents were picked, or survived as the best.
    for (const auto& descendant : record.descendants) {
        if (descendant.id >= record.places.elite && p.population_model == PopulationModel::Hybrid) {
            const auto was_elite = [&](std::uint32_t organism) {
                return record.contenders[organism].rank < record.places.elite;
            };
            EXPECT_TRUE(copies[descendant.parents.first] > 0 || was_elite(descendant.parents.first));
            EXPECT_TRUE(copies[descendant.parents.second] > 0 || was_elite(descendant.parents.second));
        } else if (descendant.id >= record.places.survivors) {
            EXPECT_TRUE(copies[descendant.parents.first] > 0 && copies[descendant.parents.second] > 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(BreedingRecord, EveryChoice, testing::ValuesIn(stage_choices()), [](const auto& choice) {
    std::string name = choice.param.name;
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
});

TEST(BreedingRecord, ContainsTheClampedGenesOfTheElite) {
    StageChoice choice;
    choice.elite_count = 3;
    Case bred{choice, 40, 40, 883};
    bred.parameters.impulse_max = 90; // those of the population reach 120
    const BreedingRecord record = bred.record();
    const auto clamps = std::accumulate(
        record.descendants.begin(), record.descendants.begin() + record.places.survivors, std::size_t{0},
        [](std::size_t sum, const auto& descendant) { return sum + descendant.changes.size(); });
    EXPECT_GT(clamps, 0u);
    for (std::uint32_t id = 0; id < record.places.survivors; ++id) {
        for (const GeneChange& change : record.descendants[id].changes) {
            EXPECT_EQ(change.kind, ChangeKind::Clamp);
            EXPECT_EQ(change.gene, static_cast<unsigned>(Impulse));
            EXPECT_EQ(change.after, 90.0f);
        }
    }
}

TEST(BreedingRecord, ContainsTheWeightOfEachBlend) {
    StageChoice choice;
    choice.crossover = CrossoverMethod::Blend;
    choice.crossover_chance = 0.7;
    choice.mutation_chance = 0;
    const BreedingRecord record = Case{choice, 300, 300, 885}.record();
    std::uint32_t blended = 0, copied = 0;
    for (std::uint32_t id = record.places.survivors; id + 1 < 300; id += 2) {
        const auto &child = record.descendants[id], &sibling = record.descendants[id + 1];
        ASSERT_EQ(child.crossed, child.second_share > 0);
        ASSERT_LE(child.second_share, 0.5);
        ASSERT_EQ(child.second_share, sibling.second_share);
        ASSERT_EQ(child.from_second.count(), 0u);
        ASSERT_EQ(sibling.parents, (Parents{child.parents.second, child.parents.first}));
        blended += child.crossed;
        copied += !child.crossed;
    }
    EXPECT_GT(blended, 30u);
    EXPECT_GT(copied, 5u);
}

RC_GTEST_PROP(BreedingRecord, OfSomeRowsEqualsThatPartOfTheWhole, ()) {
    const auto choices = stage_choices();
    const Parameters choice = *rc::gen::elementOf(choices);
    const auto present = *rc::gen::inRange(1u, 60u), wanted = *rc::gen::inRange(1u, 60u);
    const Case bred{choice, present, wanted, *rc::gen::inRange<std::uint64_t>(0, 1000)};
    const WantedRows rows{.first_contender = *rc::gen::inRange(0u, 70u),
                          .first_pick = *rc::gen::inRange(0u, 70u),
                          .first_descendant = *rc::gen::inRange(0u, 70u),
                          .count_max = *rc::gen::inRange(0u, 70u)};
    const BreedingRecord whole = bred.record(), part = bred.record(rows);
    const auto size_of = [&](std::size_t all, std::uint32_t first) {
        return std::min<std::size_t>(all - std::min<std::size_t>(first, all), rows.count_max);
    };
    RC_ASSERT(part.contenders.size() == size_of(whole.contenders.size(), rows.first_contender));
    RC_ASSERT(part.picks.size() == size_of(whole.picks.size(), rows.first_pick));
    RC_ASSERT(part.descendants.size() == size_of(whole.descendants.size(), rows.first_descendant));
    for (std::size_t i = 0; i < part.contenders.size(); ++i) {
        RC_ASSERT(part.contenders[i].fitness == whole.contenders[rows.first_contender + i].fitness);
        RC_ASSERT(part.contenders[i].copies == whole.contenders[rows.first_contender + i].copies);
        RC_ASSERT(part.contenders[i].slot_end == whole.contenders[rows.first_contender + i].slot_end);
    }
    for (std::size_t i = 0; i < part.picks.size(); ++i) {
        RC_ASSERT(part.picks[i].organism == whole.picks[rows.first_pick + i].organism);
        RC_ASSERT(part.picks[i].turns == whole.picks[rows.first_pick + i].turns);
        RC_ASSERT(part.picks[i].contestants == whole.picks[rows.first_pick + i].contestants);
    }
    for (std::size_t i = 0; i < part.descendants.size(); ++i) {
        const auto &descendant = part.descendants[i], &of_whole = whole.descendants[rows.first_descendant + i];
        RC_ASSERT(descendant.id == of_whole.id);
        RC_ASSERT(descendant.parents == of_whole.parents);
        RC_ASSERT(descendant.from_second == of_whole.from_second);
        RC_ASSERT(descendant.second_share == of_whole.second_share);
        RC_ASSERT(descendant.crossed == of_whole.crossed);
        RC_ASSERT(descendant.order == of_whole.order);
        RC_ASSERT(descendant.changes == of_whole.changes);
        RC_ASSERT(descendant.genes == of_whole.genes);
    }
}

// ---- the law ---------------------------------------------------------------------------------------------------

TEST(SelectionLaw, OfASingleWinnerIsTheClosedForm) {
    // ((n-r)^k - (n-r-1)^k) / n^k with replacement; C(n-r-1, k-1) / C(n, k) without.
    constexpr std::uint32_t n = 20;
    for (const std::uint32_t k : {1u, 2u, 3u, 7u, 20u, 200u}) {
        Parameters parameters;
        parameters.selection = SelectionMethod::Tournament;
        parameters.tournament_size = k;
        const SelectionLaw law{n, {.wanted = 100, .pool = n}, parameters};
        for (std::uint32_t r = 0; r < n; ++r) {
            EXPECT_NEAR(law.copies(r, 0).expected,
                        100 * (std::pow((n - r) / 20.0, k) - std::pow((n - r - 1) / 20.0, k)), 1e-9);
        }
        parameters.tournament_replacement = false;
        const SelectionLaw without{n, {.wanted = 100, .pool = n}, parameters};
        double none_better = 1; // no contestant has rank 0 ... r - 1
        for (std::uint32_t r = 0; r < n; ++r) {
            const double hit = std::min(1.0, static_cast<double>(std::min(k, n)) / (n - r));
            EXPECT_NEAR(without.copies(r, 0).expected, 100 * none_better * hit, 1e-9);
            none_better *= 1 - hit;
        }
    }
}

TEST(SelectionLaw, IsTheMeanOfManySelections) {
    // Compares the copies of each organism over many selections with the law: chi-square over the organisms. If no
    // organism can be drawn twice, the picks of one selection exclude each other, which makes the statistic smaller,
    // never larger.
    constexpr std::uint32_t population = 12, rounds = 4000;
    for (const StageChoice& choice : stage_choices()) {
        if (choice.selection == SelectionMethod::Truncation) {
            continue;
        }
        StageChoice held = choice;
        held.tournament_size = std::min(held.tournament_size, 9u);
        held.elite_count = 0;
        std::vector<std::uint64_t> copies(population);
        std::vector<double> law(population);
        double picks = 0;
        for (std::uint32_t round = 0; round < rounds; ++round) {
            Case bred{held, population, population, 884};
            for (double& fitness : bred.fitness) {
                fitness += 6;
            }
            bred.key.generation = round + 1;
            const BreedingRecord record = bred.record({.count_max = population});
            picks = record.pick_count;
            for (std::uint32_t i = 0; i < population; ++i) {
                copies[i] += record.contenders[i].copies;
                law[i] = record.contenders[i].law.expected / picks;
            }
        }
        EXPECT_GT(p_value_of_law(copies, law), alpha) << choice.name;
    }
}

TEST(SelectionLaw, OfSeveralWinnersAddsUpForAnyTournamentSize) {
    for (const bool replacement : {true, false}) {
        for (const std::uint32_t size : {5u, 64u, 1000u, 1'000'000u}) {
            for (const std::uint32_t winners : {1u, 3u, size / 2}) {
                Parameters parameters;
                parameters.selection = SelectionMethod::Tournament;
                parameters.tournament_size = size;
                parameters.tournament_winners = winners;
                parameters.tournament_replacement = replacement;
                const SelectionLaw law{50, {.wanted = 31, .pool = 50}, parameters};
                double sum = 0, before = 31;
                for (std::uint32_t rank = 0; rank < 50; ++rank) {
                    const double copies = law.copies(rank, 0).expected;
                    EXPECT_LE(copies, before + 1e-9);
                    before = copies;
                    sum += copies;
                }
                EXPECT_NEAR(sum, 31, 1e-8);
            }
        }
    }
}

} // namespace
} // namespace evod::evolution
