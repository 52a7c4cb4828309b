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
    EXPECT_EQ(to_proto(parameters::ParameterSet::all_in_effect({}), nullptr).summary(), experiment_summary({}));
}

TEST(ExperimentSummary, SaysThatNetworksSteerTheOrganisms) {
    EXPECT_THAT(
        experiment_summary(with({{"controller", std::string{"network"}}})),
        StartsWith("50 organisms, each steered by an evolving neural network, gain health from food (+25) and lose "
                   "it from poison (−40); a line shows where each heads. Each loses 6 health"));
}

TEST(ExperimentSummary, LeavesOutWhatTheExperimentLacks) {
    Parameters parameters;
    parameters.population_size = 12'000;
    parameters.poison_count = 0;
    parameters.health_loss_per_s = 0;
    EXPECT_THAT(experiment_summary(parameters),
                StartsWith("12,000 organisms seek food (+25 health). They lose no health over time. Fitness is"));
}

TEST(ExperimentSummary, SaysHowAColonyLives) {
    Parameters parameters;
    parameters.reproduction = parameters::Reproduction::Births;
    parameters.predator_count = 20;
    parameters.predator_from = 10;
    EXPECT_THAT(
        experiment_summary(parameters),
        testing::EndsWith("and dies at 0. From interval 10 on, 20 predators hunt them. Fitness is the number of "
                          "children. There are no generations: two organisms with at least 120 health have a "
                          "child and pay for it with health."));
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

TEST(ExperimentSummary, SaysWhatIslandsExchange) {
    const auto text = [](std::vector<parameters::Assignment> more) {
        more.push_back({"island_count", std::uint32_t{3}});
        return experiment_summary(with(more));
    };
    EXPECT_THAT(text({}), AllOf(StartsWith("On each of 3 islands: 50 organisms seek"), HasSubstr("Nothing migrates")));
    EXPECT_THAT(
        text({{"migration", std::string{"fully_connected"}}, {"migration_epoch", std::uint32_t{1}}}),
        HasSubstr("After each generation, each island sends a copy of its best organism to every other island."));
    EXPECT_THAT(text({{"migration", std::string{"random"}},
                      {"migrant_count", std::uint32_t{2}},
                      {"emigrants", std::string{"random"}}}),
                HasSubstr("Every 10 generations, each island sends copies of 2 random organisms to a random other "));
}

TEST(ExperimentSummary, SaysHowGenerationsFollowEachOther) {
    const auto text = [](const char* model) {
        return experiment_summary(with({{"population_model", std::string{model}}, {"elite_count", std::uint32_t{2}}}));
    };
    EXPECT_THAT(text("generational"), HasSubstr("Each generation replaces all organisms except the 2 best."));
    EXPECT_THAT(text("steady_state"), HasSubstr("Each generation replaces only the 2 worst organisms."));
    EXPECT_THAT(text("hybrid"), Not(HasSubstr("replaces")));
}

TEST(ExperimentSummary, NamesObstaclesAndFreeGenesAndMissingBodies) {
    EXPECT_THAT(experiment_summary(with({{"obstacle_count", std::uint32_t{5}}, {"crate_count", std::uint32_t{1}}})),
                HasSubstr("avoid poison (−40) among 5 obstacles and 1 crate. "));
    EXPECT_THAT(experiment_summary(with({{"free_genes", std::uint32_t{4}}})),
                HasSubstr("Each has 4 free genes, which its body does not use. "));
    EXPECT_THAT(experiment_summary(with({{"fitness", std::string{"rastrigin"}}})),
                StartsWith("50 organisms have no bodies; only their genes count. Fitness is computed from the genes"));
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
