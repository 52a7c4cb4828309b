#include "client/ctl/experiment_file.h"
#include "client/ctl/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::ctl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

v1::ParameterDescription parameter(const std::string& name, v1::ParameterKind kind, double min = 0, double max = 0) {
    v1::ParameterDescription description;
    description.set_name(name);
    description.set_kind(kind);
    description.set_min(min);
    description.set_max(max);
    return description;
}

Registry small_registry() {
    v1::Description description;
    *description.add_parameters() = parameter("mutation_chance", v1::PARAMETER_KIND_REAL, 0, 1);
    *description.add_parameters() = parameter("population_size", v1::PARAMETER_KIND_COUNT, 2, 4'000'000);
    *description.add_parameters() = parameter("reference_population", v1::PARAMETER_KIND_COUNT, 1, 4'000'000);
    *description.add_parameters() = parameter("respawn", v1::PARAMETER_KIND_FLAG);
    auto& selection = *description.add_parameters() = parameter("selection", v1::PARAMETER_KIND_CHOICE);
    selection.add_choices("roulette");
    selection.add_choices("tournament");
    return Registry{description};
}

std::string set(const std::string& word) {
    const auto assignments = small_registry().assignments({word});
    return assignments ? to_text(assignments->front().value()) : assignments.error().lines.front();
}

TEST(Assignments, TakeTheKindFromTheRegistry) {
    const auto assignments = small_registry().assignments(
        {"mutation_chance=1e-2", "population_size=1e6", "respawn=off", "selection=tournament"});
    ASSERT_TRUE(assignments);
    EXPECT_EQ((*assignments)[0].value().real(), 0.01);
    EXPECT_EQ((*assignments)[1].value().count(), 1'000'000U);
    EXPECT_TRUE((*assignments)[2].value().has_flag());
    EXPECT_FALSE((*assignments)[2].value().flag());
    EXPECT_EQ((*assignments)[3].value().choice(), "tournament");
}

TEST(Assignments, NameTheErrorAndWhatIsAllowed) {
    EXPECT_EQ(set("mutation_chanse=1"), "there is no parameter 'mutation_chanse'; did you mean mutation_chance?");
    EXPECT_EQ(set("mutation_chance"), "'mutation_chance' has no value: write mutation_chance=VALUE, allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance=high"), "mutation_chance: got 'high', allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance=nan"), "mutation_chance: got 'nan', allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance=0.5x"), "mutation_chance: got '0.5x', allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance="), "mutation_chance: got '', allowed 0 to 1");
    EXPECT_EQ(set("population_size=1.5"), "population_size: got '1.5', allowed 2 to 4000000, whole");
    EXPECT_EQ(set("population_size=-1"), "population_size: got '-1', allowed 2 to 4000000, whole");
    EXPECT_EQ(set("population_size=1e10"), "population_size: got '1e10', allowed 2 to 4000000, whole");
    EXPECT_EQ(set("respawn=maybe"), "respawn: got 'maybe', allowed true or false");
    EXPECT_EQ(set("selection=turnament"),
              "selection: got 'turnament', allowed roulette, tournament; did you mean tournament?");
}

TEST(Assignments, ReportEveryMistakeTogether) {
    const auto assignments = small_registry().assignments({"respawn=maybe", "selection=roulette", "zebra=1"});
    ASSERT_FALSE(assignments);
    EXPECT_EQ(assignments.error().lines.size(), 2U);
}

TEST(Assignments, LeaveRangesToTheServer) {
    EXPECT_EQ(set("mutation_chance=1.5"), "1.5");
}

TEST(ExperimentFile, ContainsParametersSeedAndDescription) {
    const auto file = parse_experiment(
        R"({"description": "a test", "seed": 18446744073709551615, "mutation_chance": 1, "respawn": true,
            "selection": "tournament"})",
        small_registry());
    ASSERT_TRUE(file);
    EXPECT_EQ(file->description, "a test");
    EXPECT_EQ(file->seed, 18446744073709551615U);
    ASSERT_EQ(file->parameters.size(), 3U);
    EXPECT_EQ(file->parameters[0].value().real(), 1) << "a whole JSON number is a real where the registry says so";
}

TEST(ExperimentFile, ReferencePopulationFollowsThePopulation) {
    const auto alone = parse_experiment(R"({"population_size": 20})", small_registry());
    ASSERT_TRUE(alone);
    ASSERT_EQ(alone->parameters.size(), 2U);
    EXPECT_EQ(alone->parameters[1].name(), "reference_population");
    EXPECT_EQ(alone->parameters[1].value().count(), 20U);
    const auto both = parse_experiment(R"({"reference_population": 5, "population_size": 20})", small_registry());
    EXPECT_EQ(both->parameters.size(), 2U);
    EXPECT_EQ(both->parameters[0].value().count(), 5U);
}

TEST(ExperimentFile, MayHaveValuesByGeneration) {
    const auto file = parse_experiment(
        R"({"mutation_chance": {"1": 0.2, "30": 0.05}, "selection": {"5": "tournament"}, "population_size": {"1": 20, "9": 40}})",
        small_registry());
    ASSERT_TRUE(file) << file.error().lines.front();
    ASSERT_EQ(file->parameters.size(), 3U);
    EXPECT_EQ(file->parameters[0].value().real(), 0.2);
    EXPECT_EQ(file->parameters[2].name(), "reference_population");
    EXPECT_EQ(file->parameters[2].value().count(), 20U);
    ASSERT_EQ(file->schedule.size(), 3U);
    EXPECT_EQ(file->schedule[0].generation(), 30U);
    EXPECT_EQ(file->schedule[0].value().real(), 0.05);
    EXPECT_EQ(file->schedule[1].value().choice(), "tournament");
    const auto wrong = parse_experiment(
        R"({"mutation_chance": {"0": 0.2, "x": 1, "007": 1, "30": "much"}, "respawn": {}, "selection": {"2": [1]}})",
        small_registry());
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().lines,
                ElementsAre(HasSubstr("mutation_chance: got \"0\", allowed generations as keys"),
                            HasSubstr("got \"x\""), HasSubstr("got \"007\""),
                            HasSubstr("mutation_chance at generation 30: got \"much\", allowed 0 to 1"),
                            HasSubstr("respawn: got {}, allowed a generation and its value"),
                            HasSubstr("selection at generation 2: got [1]")));
    v1::Description at_reset;
    *at_reset.add_parameters() = parameter("island_count", v1::PARAMETER_KIND_COUNT, 1, 9);
    at_reset.mutable_parameters(0)->set_effect(v1::PARAMETER_EFFECT_RESET);
    EXPECT_THAT(parse_experiment(R"({"island_count": {"2": 3}})", Registry{at_reset}).error().lines,
                ElementsAre(HasSubstr("it can change only at a reset")));
}

TEST(ExperimentFile, ErrorsAreNamed) {
    const auto mistakes = [](std::string_view text) {
        const auto file = parse_experiment(text, small_registry());
        return file ? std::vector<std::string>{} : file.error().lines;
    };
    EXPECT_THAT(mistakes(R"({"mutation_chance": "0.5", "zebra": 1, "seed": -1, "respawn": [1]})"),
                ElementsAre("mutation_chance: got \"0.5\", allowed 0 to 1", "there is no parameter 'zebra'",
                            "seed: got -1, allowed 0 to 2^64 - 1, whole", "respawn: got [1], allowed true or false"));
    EXPECT_THAT(mistakes("[]"), ElementsAre(HasSubstr("an experiment is a JSON object")));
    EXPECT_THAT(mistakes("{\n\"seed\": 1,\n}"), ElementsAre(HasSubstr("line 3")));
    EXPECT_THAT(mistakes("{} {}"), ElementsAre("line 1: more than one JSON value"));
    EXPECT_THAT(mistakes(""), ElementsAre(HasSubstr("line 1")));
    EXPECT_THAT(mistakes("{"), ElementsAre(HasSubstr("line 1")));
}

} // namespace
} // namespace evod::ctl
