#include "server/experiments/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::experiments {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// Results of the four controls.
std::vector<ControlResult> results_of(double random, double random_p, double mutation, double mutation_p, double poison,
                                      double poison_p, double shuffled, double shuffled_p,
                                      std::size_t replicates = 20) {
    const std::pair<double, double> found[] = {
        {random, random_p}, {mutation, mutation_p}, {poison, poison_p}, {shuffled, shuffled_p}};
    std::vector<ControlResult> all;
    for (const ControlKind kind : all_controls) {
        const auto& [mean, p] = found[all.size()];
        all.push_back({control_of({}, kind), Finding{.differences = std::vector<double>(replicates),
                                                     .mean = mean,
                                                     .interval = {mean - 1, mean + 1},
                                                     .effect_size = 1.0,
                                                     .p = p,
                                                     .adjusted_p = p}});
    }
    return all;
}

std::string answer(double rise, const Interval& interval, const std::vector<ControlResult>& all) {
    return verdict(rise, interval, all, 1)[0];
}

TEST(Verdict, IsYesIfTheWorldRisesMoreThanBothControls) {
    EXPECT_EQ(answer(120, {110, 130}, results_of(125, 1e-5, 1, 0.9, 2, 0.9, 118.04, 0.049)),
              "Did evolution do it? Yes: the mean fitness rose by 120.0, and selection for fitness is the cause: "
              "+125.0 against "
              "random selection (adjusted p = 1e-05), +118.0 against shuffled fitness (adjusted p = 0.049).");
}

TEST(Verdict, IsQualifiedIfSelectionOnlyPreventedAFall) {
    EXPECT_THAT(answer(-2, {-8, 4}, results_of(30, 1e-5, 1, 0.9, 2, 0.9, 30, 1e-5)),
                StartsWith("Did evolution do it? Yes, but the mean fitness is not shown to have risen (-2.0)"));
}

TEST(Verdict, NeedsBothControls) {
    for (const auto& all :
         {results_of(125, 1e-5, 9, 1e-5, 9, 1e-5, 5, 0.05), results_of(5, 0.3, 9, 1e-5, 9, 1e-5, 99, 1e-5)}) {
        EXPECT_THAT(answer(120, {110, 130}, all), StartsWith("Did evolution do it? That is not shown: "));
    }
    EXPECT_THAT(answer(-9, {-12, -6}, results_of(125, 1e-5, 9, 1, 9, 1, -5, 1e-3)),
                StartsWith("Did evolution do it? No: selection for fitness makes the fitness lower: "));
}

TEST(Verdict, ReportsTooFewReplicates) {
    // Seven replicates: 4 · 2/2^7 is above 0.05; eight: it is not.
    EXPECT_THAT(answer(120, {110, 130}, results_of(99, 0.0625, 99, 0.0625, 99, 0.0625, 99, 0.0625, 7)),
                HasSubstr("There are too few replicates to answer"));
    EXPECT_THAT(answer(120, {110, 130}, results_of(99, 0.0625, 99, 0.0625, 99, 0.0625, 99, 0.0625, 8)),
                HasSubstr("That is not shown"));
}

TEST(Verdict, IsNoIfNothingIsSelected) {
    std::vector<ControlResult> all = results_of(0, 1, 9, 1, 9, 1, 0, 1);
    parameters::Parameters world;
    world.selection = evolution::SelectionMethod::Random;
    for (const std::size_t i : {0, 3}) {
        all[i] = {control_of(world, all_controls[i]), {}};
    }
    EXPECT_EQ(answer(1, {-1, 3}, all),
              "Did evolution do it? No: parents are already drawn at random, so no organism is selected for its "
              "fitness.");
}

TEST(Verdict, ReportsTheEffectsOfMutationAndPoison) {
    const auto sentences = [](double mean, double p) {
        return verdict(100, {90, 110}, results_of(99, 1e-5, mean, p, mean, p, 99, 1e-5), 1);
    };
    EXPECT_EQ(
        sentences(40, 0.001)[1],
        "Mutation: without mutation the rise is +60.0 (adjusted p = 0.001): new variety adds to the variety of the "
        "first generation.");
    EXPECT_EQ(sentences(-40, 0.001)[1],
              "Mutation: without mutation the rise is +140.0 (adjusted p = 0.001): it costs more than it gains in this "
              "number of generations.");
    EXPECT_THAT(sentences(40, 0.06)[1], HasSubstr("is not shown"));
    EXPECT_EQ(
        sentences(40, 0.001)[2],
        "Poison: with harmless poison the rise is +60.0 (adjusted p = 0.001): adaptation to poison is a part of the "
        "rise.");
    EXPECT_THAT(sentences(-40, 0.001)[2], HasSubstr("poison limits the rise"));
    EXPECT_THAT(sentences(-40, 0.06)[2], HasSubstr("is not shown"));

    std::vector<ControlResult> all = results_of(99, 1e-5, 0, 1, 0, 1, 99, 1e-5);
    parameters::Parameters still;
    still.mutation_chance = 0;
    still.poison_count = 0;
    for (const std::size_t i : {1, 2}) {
        all[i] = {control_of(still, all_controls[i]), {}};
    }
    EXPECT_THAT(verdict(100, {90, 110}, all, 1)[1], StartsWith("Mutation: there is no mutation; "));
    EXPECT_EQ(verdict(100, {90, 110}, all, 1)[2], "Poison: there is no poison.");
}

TEST(SignedText, HasASignUnlessItIsZero) {
    EXPECT_EQ(signed_text(1.25, 1), "+1.2");
    EXPECT_EQ(signed_text(-1.25, 2), "-1.25");
    EXPECT_EQ(signed_text(-0.04, 1), "0.0");
    EXPECT_EQ(signed_text(0, 0), "0");
}

} // namespace
} // namespace evod::experiments
