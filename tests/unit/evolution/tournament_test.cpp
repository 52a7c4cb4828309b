#include "server/evolution/tournament.h"

#include "tests/unit/evolution/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace evod::evolution {
namespace {

double choose(std::uint32_t n, std::uint32_t k) {
    if (k > n) {
        return 0;
    }
    double value = 1;
    for (std::uint32_t i = 1; i <= k; ++i) {
        value = value * (n - k + i) / i;
    }
    return value;
}

/// The probability that the winner number `place` (0 = best) of a tournament has rank r, for each of n ranks.
std::vector<double> closed_form(std::uint32_t n, const Tournament& tournament, std::uint32_t place) {
    const std::uint32_t k = tournament.size;
    std::vector<double> law(n);
    if (!tournament.replacement) {
        // `place` of the k are among the r better ranks, the others among the n − r − 1 worse.
        for (std::uint32_t r = 0; r < n; ++r) {
            law[r] = choose(r, place) * choose(n - r - 1, k - place - 1) / choose(n, k);
        }
        return law;
    }
    // Winner `place` is worse than the r best ranks if at most `place` of k independent draws are among them.
    const auto beyond = [&](std::uint32_t r) {
        const double p = static_cast<double>(r) / n;
        double sum = 0;
        for (std::uint32_t hits = 0; hits <= place; ++hits) {
            sum += choose(k, hits) * std::pow(p, hits) * std::pow(1 - p, k - hits);
        }
        return sum;
    };
    for (std::uint32_t r = 0; r < n; ++r) {
        law[r] = beyond(r) - beyond(r + 1);
    }
    return law;
}

/// How often winner number `place` has each rank, if the fitness decreases with the index.
std::vector<std::uint64_t> ranks_of_winners(std::uint32_t n, const Tournament& tournament, std::uint32_t place,
                                            std::uint32_t tournaments, std::uint64_t seed) {
    base::InlineExecutor executor;
    std::vector<double> fitness(n);
    std::iota(fitness.rbegin(), fitness.rend(), -3.0);
    Ranking ranking{fitness};
    const auto picked = hold_tournaments(ranking, tournament, tournaments * tournament.winners, key_of(seed), executor);
    std::vector<std::uint64_t> counts(n);
    for (std::size_t i = place; i < picked.size(); i += tournament.winners) {
        ++counts[picked[i]];
    }
    return counts;
}

TEST(Tournament, TheWinnersRankFollowsTheClosedForm) {
    // Law: ((n−r)^k − (n−r−1)^k) / n^k with replacement, C(n−r−1, k−1) / C(n, k) without, n = 10. Chi-square, one
    // degree of freedom less than ranks of positive probability.
    for (const bool replacement : {true, false}) {
        for (const std::uint32_t size : {1u, 2u, 3u, 5u, 10u}) {
            const Tournament tournament{.size = size, .winners = 1, .replacement = replacement};
            if (size == 10 && !replacement) {
                continue; // the best of all always wins: there is no law to test here, see below
            }
            const auto law = closed_form(10, tournament, 0);
            if (replacement) {
                EXPECT_NEAR(law[0], (std::pow(10, size) - std::pow(9, size)) / std::pow(10, size), 1e-12);
            }
            EXPECT_GT(p_value_of_law(ranks_of_winners(10, tournament, 0, 300'000, 161), law), alpha)
                << "size " << size << " replacement " << replacement;
        }
    }
}

TEST(Tournament, EveryWinnersRankFollowsTheClosedForm) {
    // Law: that of the order statistics of the contestants (closed_form above). Chi-square for each winner's place.
    for (const bool replacement : {true, false}) {
        for (std::uint32_t place = 0; place < 3; ++place) {
            const Tournament tournament{.size = 5, .winners = 3, .replacement = replacement};
            EXPECT_GT(p_value_of_law(ranks_of_winners(10, tournament, place, 200'000, 162),
                                     closed_form(10, tournament, place)),
                      alpha)
                << "place " << place << " replacement " << replacement;
        }
    }
}

TEST(Tournament, OutcomesDrawnDirectlyFollowTheSameLaw) {
    // Tournaments whose outcome is drawn directly. The same law and test as above; rare ranks are combined into one
    // cell.
    const struct {
        std::uint32_t population;
        Tournament tournament;
    } cases[] = {{40, {.size = 80, .winners = 1, .replacement = true}},
                 {40, {.size = 80, .winners = 3, .replacement = true}},
                 {100, {.size = 65, .winners = 1, .replacement = false}},
                 {1000, {.size = 70, .winners = 1, .replacement = false}},
                 {100, {.size = 65, .winners = 3, .replacement = false}},
                 {1000, {.size = 70, .winners = 3, .replacement = false}}};
    for (const auto& [population, tournament] : cases) {
        for (std::uint32_t place = 0; place < tournament.winners; ++place) {
            const auto ranks = ranks_of_winners(population, tournament, place, 300'000, 163);
            const auto law = closed_form(population, tournament, place);
            std::vector<std::uint64_t> counts(1);
            std::vector<double> expected(1);
            for (std::size_t r = 0; r < law.size(); ++r) {
                if (law[r] < 1e-4) {
                    counts[0] += ranks[r];
                    expected[0] += law[r];
                } else {
                    counts.push_back(ranks[r]);
                    expected.push_back(law[r]);
                }
            }
            if (expected[0] < 1e-5) { // too rare to be expected: omitted from the test
                counts.erase(counts.begin());
                expected.erase(expected.begin());
            }
            EXPECT_GT(p_value_of_law(counts, expected), alpha) << "size " << tournament.size << " place " << place;
        }
    }
}

TEST(Tournament, WithoutReplacementEachWinsOnce) {
    base::InlineExecutor executor;
    std::vector<double> fitness(2000);
    std::iota(fitness.begin(), fitness.end(), 0.0);
    for (const std::uint32_t size : {4u, 70u, 1999u}) { // held, skipped to, walked to
        Ranking ranking{fitness};
        const auto picked =
            hold_tournaments(ranking, {.size = size, .winners = 3, .replacement = false}, 3000, key_of(164), executor);
        for (std::size_t i = 0; i < picked.size(); i += 3) {
            ASSERT_GT(picked[i], picked[i + 1]); // fitness rises with the index
            ASSERT_GT(picked[i + 1], picked[i + 2]);
        }
    }
}

TEST(Tournament, OfTheWholePopulationTheBestWin) {
    base::InlineExecutor executor;
    const std::vector<double> fitness = {3, 9, 1, 9, 5};
    for (const std::uint32_t size : {5u, 6u, 1'000'000u}) {
        Ranking ranking{fitness};
        EXPECT_EQ(
            hold_tournaments(ranking, {.size = size, .winners = 2, .replacement = false}, 5, key_of(165), executor),
            (std::vector{1u, 3u, 1u, 3u, 1u}));
    }
}

TEST(Tournament, TiesGoToTheLowerIndex) {
    // Law: among equals the index is the rank. Chi-square against size 3 with replacement.
    base::InlineExecutor executor;
    const std::vector<double> fitness(10, 4.0);
    Ranking ranking{fitness};
    const auto picked = hold_tournaments(ranking, {.size = 3}, 300'000, key_of(166), executor);
    EXPECT_GT(p_value_of_law(count_each(picked, 10), closed_form(10, {.size = 3}, 0)), alpha);
}

TEST(Tournament, MoreWinnersThanContestantsMeansThatAllWin) {
    // Law: uniform, because every contestant wins. Chi-square, 9 degrees of freedom.
    base::InlineExecutor executor;
    const std::vector<double> fitness = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
    Ranking ranking{fitness};
    const auto picked = hold_tournaments(ranking, {.size = 2, .winners = 9}, 200'000, key_of(167), executor);
    EXPECT_GT(support::p_value_of_equal_cells(count_each(picked, 10)), alpha);
}

TEST(Tournament, SurplusWinnersOfTheLastOneAreDropped) {
    base::InlineExecutor executor;
    const std::vector<double> fitness = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
    Ranking ranking{fitness};
    const Tournament tournament{.size = 4, .winners = 3, .replacement = false};
    const auto seven = hold_tournaments(ranking, tournament, 7, key_of(168), executor);
    const auto nine = hold_tournaments(ranking, tournament, 9, key_of(168), executor);
    EXPECT_EQ(seven, std::vector(nine.begin(), nine.begin() + 7));
}

} // namespace
} // namespace evod::evolution
