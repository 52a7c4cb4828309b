#include "client/viewer/panels/breeding/bets.h"

#include "tests/unit/viewer/panels/breeding/made_up.h"

#include <gtest/gtest.h>

namespace evod::viewer {
namespace {

TEST(Bets, ASecondClickWithdrawsTheBet) {
    Bets bets;
    bets.toggle(3);
    bets.toggle(1);
    bets.toggle(3);
    EXPECT_EQ(bets.organisms(), std::vector<std::uint32_t>{1});
    for (std::uint32_t organism = 10; organism < 20; ++organism) {
        bets.toggle(organism);
    }
    EXPECT_TRUE(bets.full());
    EXPECT_EQ(bets.organisms().size(), Bets::bets_max);
    EXPECT_FALSE(bets.has(14));
    bets.toggle(1); // a bet can still be withdrawn
    EXPECT_FALSE(bets.full());
}

TEST(Bets, ScoreComparesWithRandomBetsAndWithTheLaw) {
    // Copies by organism: 2, 0, 1, 1; expected by the law: 1.6, 0.4, 1.2, 0.8.
    const auto comparison = compare(made_up::record_of(made_up::wheel()));
    ASSERT_TRUE(comparison);
    Bets bets;
    bets.toggle(0);
    bets.toggle(1);
    const BetScore score = score_of(bets, *comparison, comparison->copies, 4);
    EXPECT_EQ(score.hits, 2u);
    EXPECT_DOUBLE_EQ(score.random, 2) << "two bets on four organisms win half of the four picks";
    EXPECT_NEAR(score.law, 2, 1e-12);
    EXPECT_EQ(score.most, 3u) << "organism 0 twice and organism 2 or 3 once";
    EXPECT_EQ(
        score_text(score, true),
        "2 of 4 picks hit your 2 bets. Random bets: 2 expected. Your bets: 2 expected by the law of the selection. "
        "The best possible bets: 3. Score: 1 times random betting.");
}

TEST(Bets, NothingOfTheResultIsShownBeforeTheLastPick) {
    const BreedingRecord record = made_up::record_of(made_up::wheel());
    const auto comparison = compare(record);
    Bets bets;
    bets.toggle(2);
    const BetScore score = score_of(bets, *comparison, copies_after(record, 1), 1);
    EXPECT_EQ(score_text(score, false), "0 of 1 pick hit your 1 bet. Random bets: 0.25 expected.");
}

TEST(Bets, RandomBetsOnAllOrganismsReachTheirExpectation) {
    const auto comparison = compare(made_up::record_of(made_up::wheel()));
    double sum = 0;
    for (std::uint32_t organism = 0; organism < 4; ++organism) {
        Bets bets;
        bets.toggle(organism);
        const BetScore score = score_of(bets, *comparison, comparison->copies, 4);
        EXPECT_DOUBLE_EQ(score.random, 1);
        sum += score.hits;
    }
    EXPECT_DOUBLE_EQ(sum / 4, 1);
}

} // namespace
} // namespace evod::viewer
