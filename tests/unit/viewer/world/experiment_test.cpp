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

TEST(ExperimentText, NamesFitnessOfTheGenesAndItsSelection) {
    EXPECT_THAT(experiment_text(parameters("rastrigin", "random")),
                AllOf(HasSubstr("from the genes alone (rastrigin)"), HasSubstr("chosen at random")));
    EXPECT_THAT(experiment_text(parameters("gene_sum", "truncation")), HasSubstr("Only the fittest have offspring."));
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
