#include "server/evolution/termination.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace evod::evolution {
namespace {

Progress after(std::initializer_list<double> best_fitness, bool died_out = false) {
    Progress progress;
    for (const double best : best_fitness) {
        progress = advance(progress, {.best_fitness = best, .died_out = false});
    }
    progress.last_died_out = died_out;
    return progress;
}

TEST(Termination, NothingEndsARunByDefault) {
    EXPECT_EQ(outcome(after({1e12, 0, 0, 0, 0}, true), {}), Outcome::Running);
    EXPECT_EQ(outcome({}, {}), Outcome::Running);
}

TEST(Termination, GenerationLimit) {
    Parameters parameters;
    parameters.generation_limit = 3;
    EXPECT_EQ(outcome(after({1, 2}), parameters), Outcome::Running);
    EXPECT_EQ(outcome(after({1, 2, 3}), parameters), Outcome::GenerationLimit);
    EXPECT_EQ(outcome(after({1, 2, 3, 4}), parameters), Outcome::GenerationLimit); // the limit was lowered
}

TEST(Termination, TargetFitnessOfTheLastGeneration) {
    Parameters parameters;
    parameters.target_fitness = 5;
    EXPECT_EQ(outcome(after({5}), parameters), Outcome::Running);
    parameters.stop_at_target_fitness = true;
    EXPECT_EQ(outcome(after({4.999}), parameters), Outcome::Running);
    EXPECT_EQ(outcome(after({5}), parameters), Outcome::TargetFitness);
    parameters.target_fitness = -3;
    EXPECT_EQ(outcome(after({-3}), parameters), Outcome::TargetFitness);
    EXPECT_EQ(outcome({}, parameters), Outcome::Running); // no generation has ended
}

TEST(Termination, StagnationCountsGenerationsWithoutANewBest) {
    Parameters parameters;
    parameters.stagnation_limit = 2;
    EXPECT_EQ(outcome(after({5}), parameters), Outcome::Running);
    EXPECT_EQ(outcome(after({5, 4}), parameters), Outcome::Running);
    EXPECT_EQ(outcome(after({5, 4, 5}), parameters), Outcome::Stagnation); // a tie is not an improvement
    EXPECT_EQ(outcome(after({5, 4, 6}), parameters), Outcome::Running);
    EXPECT_EQ(outcome(after({5, 4, 6, 1, 6}), parameters), Outcome::Stagnation);
    EXPECT_EQ(outcome(after({-7, -8, -7}), parameters),
              Outcome::Stagnation); // the first is the best so far, below 0 too
    EXPECT_EQ(after({5, 4, 6, 1}).best_fitness, 6);
}

TEST(Termination, Extinction) {
    Parameters parameters;
    EXPECT_EQ(outcome(after({5}, true), parameters), Outcome::Running);
    parameters.stop_at_extinction = true;
    EXPECT_EQ(outcome(after({5}, true), parameters), Outcome::Extinction);
    EXPECT_EQ(outcome(after({5}, false), parameters), Outcome::Running);
    const Progress died = advance({}, {.best_fitness = 1, .died_out = true});
    EXPECT_TRUE(died.last_died_out);
    EXPECT_FALSE(advance(died, {.best_fitness = 1, .died_out = false}).last_died_out);
}

TEST(Termination, ExtinctionOfASpecies) {
    const LivingSpecies none{0, 0, true}, prey{3, 0, true}, predators{0, 3, true}, before_predators{3, 0, false};
    Parameters parameters;
    for (const bool stops : {false, true}) {
        parameters.stop_at_extinction = stops;
        EXPECT_TRUE(has_died_out(none, parameters));
        EXPECT_TRUE(has_died_out(predators, parameters));
        EXPECT_EQ(has_died_out(prey, parameters), stops);
        EXPECT_FALSE(has_died_out(before_predators, parameters));
    }
}

TEST(Termination, AColonyEndsWithItsExtinction) {
    EXPECT_EQ(outcome(after({5}, true), {}, true), Outcome::Extinction);
    EXPECT_EQ(outcome(after({5}, false), {}, true), Outcome::Running);
}

TEST(Termination, TheFirstOutcomeThatHoldsIsReturned) {
    Parameters parameters;
    parameters.stop_at_target_fitness = parameters.stop_at_extinction = true;
    parameters.target_fitness = 5;
    parameters.stagnation_limit = 1;
    parameters.generation_limit = 1;
    EXPECT_EQ(outcome(after({5, 5}, true), parameters), Outcome::TargetFitness);
    EXPECT_EQ(outcome(after({4, 4}, true), parameters), Outcome::Extinction);
    EXPECT_EQ(outcome(after({4, 4}), parameters), Outcome::Stagnation);
    EXPECT_EQ(outcome(after({4}), parameters), Outcome::GenerationLimit);
}

} // namespace
} // namespace evod::evolution
