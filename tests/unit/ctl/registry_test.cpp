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
    EXPECT_EQ(set("mutation_chanse=1"), "mutation_chanse: unknown parameter; did you mean mutation_chance?");
    EXPECT_EQ(set("mutation_chance"), "mutation_chance: got no value, allowed mutation_chance=VALUE with 0 to 1");
    EXPECT_EQ(set("mutation_chance=high"), "mutation_chance: got high, allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance=nan"), "mutation_chance: got nan, allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance=0.5x"), "mutation_chance: got 0.5x, allowed 0 to 1");
    EXPECT_EQ(set("mutation_chance="), "mutation_chance: got nothing, allowed 0 to 1");
    EXPECT_EQ(set("population_size=1.5"), "population_size: got 1.5, allowed a whole number, 2 to 4000000");
    EXPECT_EQ(set("population_size=-1"), "population_size: got -1, allowed a whole number, 2 to 4000000");
    EXPECT_EQ(set("population_size=1e10"), "population_size: got 1e10, allowed a whole number, 2 to 4000000");
    EXPECT_EQ(set("respawn=maybe"), "respawn: got maybe, allowed true or false");
    EXPECT_EQ(set("selection=turnament"),
              "selection: got turnament, allowed roulette, tournament; did you mean tournament?");
}

TEST(Assignments, ReportEveryMistakeTogether) {
    const auto assignments = small_registry().assignments({"respawn=maybe", "selection=roulette", "zebra=1"});
    ASSERT_FALSE(assignments);
    EXPECT_EQ(assignments.error().lines.size(), 2U);
}

TEST(Assignments, LeaveRangesToTheServer) {
    EXPECT_EQ(set("mutation_chance=1.5"), "1.5");
}

} // namespace
} // namespace evod::ctl
