#include "client/viewer/world/experiment.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void add(evod::v1::ParameterSet& set, const char* name, double number) {
    evod::v1::ParameterState& state = *set.add_parameters();
    state.set_name(name);
    state.mutable_value()->set_real(number);
}

evod::v1::ParameterSet parameters(const char* fitness, const char* selection) {
    evod::v1::ParameterSet set;
    add(set, "population_size", 50);
    add(set, "food_health", 25);
    add(set, "poison_harm", 40);
    add(set, "health_loss_per_s", 6);
    add(set, "fitness_per_second", 1);
    add(set, "fitness_per_health", 1);
    for (const auto& [name, choice] : {std::pair{"fitness", fitness}, {"selection", selection}}) {
        evod::v1::ParameterState& state = *set.add_parameters();
        state.set_name(name);
        state.mutable_value()->set_choice(choice);
    }
    return set;
}

TEST(ExperimentText, SaysWhatTheOrganismsTryToDo) {
    EXPECT_EQ(
        experiment_text(parameters("life", "roulette")),
        "50 organisms seek food (+25 health) and avoid poison (−40). Each loses 6 health per second and dies at 0. "
        "Fitness is the time lived plus the health at the end. On average, fitter organisms have more offspring "
        "(roulette selection).");
}

TEST(ExperimentText, SaysThatNetworksSteerTheOrganisms) {
    evod::v1::ParameterSet set = parameters("life", "roulette");
    evod::v1::ParameterState& controller = *set.add_parameters();
    controller.set_name("controller");
    controller.mutable_value()->set_choice("network");
    EXPECT_THAT(
        experiment_text(set),
        testing::StartsWith("50 organisms, each steered by an evolving neural network, eat food (+25 health) and "
                            "poison (−40); a line shows where each heads. Each loses 6 health"));
}

TEST(ExperimentText, LeavesOutWhatTheExperimentLacks) {
    evod::v1::ParameterSet set = parameters("life", "roulette");
    add(set, "poison_count", 0);
    for (evod::v1::ParameterState& state : *set.mutable_parameters()) {
        if (state.name() == "health_loss_per_s") {
            state.mutable_value()->set_real(0);
        }
    }
    EXPECT_THAT(experiment_text(set),
                testing::StartsWith("50 organisms seek food (+25 health). They lose no health over time. Fitness is"));
}

/// The sentence about fitness with these weights of seconds, health, food and poison.
std::string fitness_text(double second, double health, double food, double poison) {
    evod::v1::ParameterSet set = parameters("life", "roulette");
    for (evod::v1::ParameterState& state : *set.mutable_parameters()) {
        if (state.name() == "fitness_per_second" || state.name() == "fitness_per_health") {
            state.mutable_value()->set_real(state.name() == "fitness_per_second" ? second : health);
        }
    }
    add(set, "fitness_per_food", food);
    add(set, "fitness_per_poison", poison);
    const std::string text = experiment_text(set);
    const std::size_t begin = text.find("Fitness is");
    return text.substr(begin, text.find('.', begin) - begin);
}

TEST(ExperimentText, StatesTheWeightsOfTheFitness) {
    EXPECT_EQ(fitness_text(1, 1, 0, 0), "Fitness is the time lived plus the health at the end");
    EXPECT_EQ(fitness_text(0, 2, 10, -4), "Fitness is 2 × the health at the end plus 10 × the food eaten minus 4 × the "
                                          "poison eaten");
    EXPECT_EQ(fitness_text(0, 0, 1, 0), "Fitness is the food eaten");
    EXPECT_EQ(fitness_text(0, 0, 0, -3), "Fitness is −3 × the poison eaten");
    EXPECT_EQ(fitness_text(0, 0, 0, 0), "Fitness is 0 for all organisms");
}

TEST(ExperimentText, NamesFitnessOfTheGenesAndItsSelection) {
    EXPECT_THAT(experiment_text(parameters("rastrigin", "random")),
                AllOf(HasSubstr("from the genes alone (rastrigin)"), HasSubstr("chosen at random")));
    EXPECT_THAT(experiment_text(parameters("gene_sum", "truncation")), HasSubstr("Only the fittest have offspring."));
    EXPECT_THAT(experiment_text(parameters("external", "random")), HasSubstr("Fitness comes from a client"));
    EXPECT_THAT(experiment_text(parameters("life", "stochastic_universal")),
                HasSubstr("(stochastic universal selection)"));
}

TEST(ExperimentText, ClaimsNothingThatShufflingOrGeneCostsMakeFalse) {
    evod::v1::ParameterSet set = parameters("life", "roulette");
    add(set, "impulse_cost", 0);
    EXPECT_THAT(experiment_text(set), HasSubstr("Each loses 6 health per second and dies"));
    add(set, "food_radius_cost", 0.2);
    EXPECT_THAT(experiment_text(set),
                HasSubstr("Each loses 6 health per second, more or less with its genes, and dies"));
    auto& shuffled = *set.add_parameters();
    shuffled.set_name("shuffle_fitness");
    shuffled.mutable_value()->set_flag(true);
    EXPECT_THAT(experiment_text(set), AllOf(HasSubstr("fitter organisms have no more offspring than others"),
                                            Not(HasSubstr("On average, fitter"))));
}

} // namespace
} // namespace evod::viewer
