#include "server/protocol/experiment_summary.h"

#include "server/protocol/parameters.h"

#include <gmock/gmock.h>

namespace evod::protocol {
namespace {

using parameters::Parameters;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// The default parameters with other values: {{"selection", "random"}}.
Parameters with(const std::vector<parameters::Assignment>& assignments) {
    return parameters::assign(parameters::RequestedParameters{Parameters{}}, assignments).value().values;
}

TEST(ExperimentSummary, SaysWhatTheOrganismsTryToDo) {
    EXPECT_EQ(
        experiment_summary({}),
        "50 organisms seek food (+25 health) and avoid poison (−40). Each loses 6 health per second and dies at 0. "
        "Fitness is the time lived plus the health at the end. On average, fitter organisms have more offspring "
        "(roulette selection).");
    EXPECT_EQ(to_proto(parameters::ParameterSet::all_in_effect({})).summary(), experiment_summary({}));
}

TEST(ExperimentSummary, SaysThatNetworksSteerTheOrganisms) {
    EXPECT_THAT(experiment_summary(with({{"controller", std::string{"network"}}})),
                StartsWith("50 organisms, each steered by an evolving neural network, eat food (+25 health) and "
                           "poison (−40); a line shows where each heads. Each loses 6 health"));
}

TEST(ExperimentSummary, LeavesOutWhatTheExperimentLacks) {
    Parameters parameters;
    parameters.population_size = 12'000;
    parameters.poison_count = 0;
    parameters.health_loss_per_s = 0;
    EXPECT_THAT(experiment_summary(parameters),
                StartsWith("12,000 organisms seek food (+25 health). They lose no health over time. Fitness is"));
}

/// The sentence about fitness with these weights of seconds, health, food and poison.
std::string about_fitness(double second, double health, double food, double poison) {
    Parameters parameters;
    parameters.fitness_per_second = second;
    parameters.fitness_per_health = health;
    parameters.fitness_per_food = food;
    parameters.fitness_per_poison = poison;
    const std::string text = experiment_summary(parameters);
    const std::size_t begin = text.find("Fitness is");
    return text.substr(begin, text.find(". ", begin) - begin);
}

TEST(ExperimentSummary, StatesTheWeightsOfTheFitness) {
    EXPECT_EQ(about_fitness(1, 1, 0, 0), "Fitness is the time lived plus the health at the end");
    EXPECT_EQ(about_fitness(0, 2, 10, -4),
              "Fitness is 2 × the health at the end plus 10 × the food eaten minus 4 × the poison eaten");
    EXPECT_EQ(about_fitness(0, 0, 2.5, 0), "Fitness is 2.5 × the food eaten");
    EXPECT_EQ(about_fitness(0, 0, 0, -3), "Fitness is −3 × the poison eaten");
    EXPECT_EQ(about_fitness(0, 0, 0, 0), "Fitness is 0 for all organisms");
}

TEST(ExperimentSummary, NamesFitnessOfTheGenesAndItsSelection) {
    const auto text = [](const char* fitness, const char* selection) {
        return experiment_summary(with({{"fitness", std::string{fitness}}, {"selection", std::string{selection}}}));
    };
    EXPECT_THAT(text("rastrigin", "random"),
                AllOf(HasSubstr("from the genes alone (rastrigin)"), HasSubstr("chosen at random")));
    EXPECT_THAT(text("gene_sum", "truncation"), HasSubstr("Only the fittest have offspring."));
    EXPECT_THAT(text("external", "random"), HasSubstr("Fitness comes from a client"));
    EXPECT_THAT(text("life", "stochastic_universal"), HasSubstr("(stochastic universal selection)"));
}

TEST(ExperimentSummary, ClaimsNothingThatControlsOrCostsMakeFalse) {
    Parameters parameters;
    EXPECT_THAT(experiment_summary(parameters), HasSubstr("Each loses 6 health per second and dies"));
    parameters.food_radius_cost = 0.2;
    parameters.shuffle_fitness = true;
    EXPECT_THAT(experiment_summary(parameters),
                AllOf(HasSubstr("Each loses 6 health per second, more or less with its genes, and dies"),
                      HasSubstr("fitter organisms have no more offspring than others"),
                      Not(HasSubstr("On average, fitter"))));
}

} // namespace
} // namespace evod::protocol
