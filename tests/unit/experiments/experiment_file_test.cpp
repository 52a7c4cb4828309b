#include "server/experiments/experiment_file.h"

#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <fstream>

namespace evod::experiments {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

parameters::Experiment scheduled() {
    const auto experiment =
        parameters::parse_experiment(R"({"tournament_size": 5, "tournament_winners": {"5": 4}, "seed": 2})");
    EXPECT_TRUE(experiment) << to_text(experiment.error());
    return *experiment;
}

TEST(ExperimentFile, ErrorsBeginWithThePath) {
    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/a.json";
    std::ofstream{path} << "{\n\"food_count\": -1}";
    const std::string refused = to_text(load_experiment(path).error());
    EXPECT_THAT(refused, StartsWith(path + ": "));
    EXPECT_THAT(refused, HasSubstr("food_count (line 2): got -1"));
    EXPECT_THAT(to_text(load_experiment("/nowhere/a.json").error()), HasSubstr("/nowhere/a.json"));
}

TEST(ExperimentFile, AChangeHoldsInAllGenerations) {
    const auto changed = with_changes(scheduled(), {"tournament_winners=2", "food_count=7"});
    ASSERT_TRUE(changed) << to_text(changed.error());
    EXPECT_EQ(changed->parameters.tournament_winners, 2u);
    EXPECT_EQ(changed->parameters.food_count, 7u);
    EXPECT_FALSE(changed->schedule.holds("tournament_winners"));
    EXPECT_EQ(changed->seed, base::Seed{2});
}

TEST(ExperimentFile, EveryInvalidChangeIsReported) {
    const auto refused = with_changes({}, {"food_count", "mutation_chance=2", "selection=luck", "food=1"});
    ASSERT_FALSE(refused);
    const std::string text = to_text(refused.error());
    EXPECT_THAT(text, HasSubstr("--set: got food_count, allowed name=value"));
    EXPECT_THAT(text, HasSubstr("--set mutation_chance: got 2"));
    EXPECT_THAT(text, HasSubstr("--set selection: got luck"));
    EXPECT_THAT(text, HasSubstr("--set food"));
}

TEST(ExperimentFile, AScheduleMustFitTheChanges) {
    parameters::Experiment experiment = scheduled();
    EXPECT_TRUE(match_schedule_to_parameters(experiment));
    experiment.parameters.tournament_size = 3;
    const auto refused = match_schedule_to_parameters(experiment);
    ASSERT_FALSE(refused);
    EXPECT_THAT(to_text(refused.error()), HasSubstr("at generation 5"));
}

TEST(ExperimentFile, AWorldIsNamedLikeItsFile) {
    EXPECT_EQ(world_name("/a/b/classic-2.json"), "classic-2");
    EXPECT_EQ(world_name("my world.json"), "my_world");
    EXPECT_EQ(world_name(""), "default");
    EXPECT_EQ(world_name(std::string(100, 'n') + ".json"), std::string(64, 'n'));
}

} // namespace
} // namespace evod::experiments
