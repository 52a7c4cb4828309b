#include "server/parameters/schedule.h"

#include "tests/unit/parameters/assignments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <type_traits>
#include <vector>

namespace evod::parameters {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

std::vector<std::string> names_at(const Schedule& schedule, std::uint64_t generation) {
    std::vector<std::string> names;
    for (const Assignment& assignment : schedule.at(generation)) {
        names.push_back(assignment.name);
    }
    return names;
}

Schedule cooling() {
    Schedule schedule;
    schedule.add(3, {"mutation_step", 5.0});
    schedule.add(3, {"food_count", 7u});
    schedule.add(5, {"mutation_step", 2u});
    return schedule;
}

TEST(Schedule, OrdersValuesByTheRegistry) {
    EXPECT_THAT(names_at(cooling(), 3), ElementsAre("food_count", "mutation_step"));
    EXPECT_TRUE(cooling().at(4).empty());
    EXPECT_TRUE(Schedule{}.empty());
    EXPECT_TRUE(cooling().holds("food_count"));
    EXPECT_FALSE(cooling().holds("mutation_chance"));
}

TEST(Schedule, StoresACountOfARealParameterAsAReal) {
    EXPECT_EQ(cooling().at(5)[0].value, ParameterValue{2.0});
}

TEST(Schedule, BeginsWithTheParametersOfTheRun) {
    Schedule schedule = cooling();
    Parameters parameters;
    parameters.food_count = 40;
    schedule.begin_with(parameters);
    EXPECT_THAT(names_at(schedule, 1), ElementsAre("food_count", "mutation_step"));
    EXPECT_EQ(schedule.at(1)[0].value, ParameterValue{40u});
    EXPECT_EQ(schedule.value_count(), 3u) << "values of generation 1 do not count";
}

TEST(Schedule, RemovesAllValuesOfAParameter) {
    Schedule schedule = cooling();
    schedule.remove("mutation_step");
    EXPECT_THAT(names_at(schedule, 3), ElementsAre("food_count"));
    EXPECT_FALSE(schedule.changes().contains(5));
    schedule.remove("food_count");
    EXPECT_TRUE(schedule.empty());
}

TEST(Schedule, OnlyParametersOfARunningWorldCanBeScheduled) {
    EXPECT_TRUE(can_be_scheduled(*find_parameter("population_size")));
    EXPECT_FALSE(can_be_scheduled(*find_parameter("island_count")));
}

TEST(Request, MustBeValidWithoutAReset) {
    ParameterSet set;
    set.active.island_count = 40; // remains until a reset
    set.active.population_size = set.requested.values.population_size = 90'000;
    set.active.scale_with_population = set.requested.values.scale_with_population = true;
    const std::vector<Assignment> larger{{"population_size", 200'000u}}; // 8 million organisms on 40 islands
    const auto refused = request_of(set, larger, "p.");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("until all of them have taken effect"));
    EXPECT_THAT(refused.error().violations, ElementsAre(Field(&base::Violation::field, "p.island_count")));
}

TEST(Request, MustBeValidFromTheNextTickOn) {
    ParameterSet set;
    set.active.selection = set.requested.values.selection = evolution::SelectionMethod::Tournament;
    set.active.tournament_replacement = set.requested.values.tournament_replacement = false;
    // The population grows with the next generation only, the tournament at once.
    const std::vector<Assignment> larger{{"population_size", 200u}, {"tournament_size", 150u}};
    const auto refused = request_of(set, larger, "p.");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("until all of them have taken effect"));
    ASSERT_TRUE(request_of(set, std::vector<Assignment>{{"population_size", 200u}}));
    EXPECT_TRUE(request_at_generation(set, larger)) << "there, the population grows first";
}

TEST(Request, AtAGenerationMustBeValidForItsBreeding) {
    const ParameterSet set;
    const std::vector<Assignment> assignments{{"population_size", 2u},
                                              {"selection", std::string{"tournament"}},
                                              {"tournament_replacement", false},
                                              {"tournament_size", 2u}};
    EXPECT_TRUE(request_of(set, assignments));
    EXPECT_TRUE(request_at_generation(set, assignments)) << "the present selection is roulette";
    ParameterSet tournament = set;
    tournament.active.selection = tournament.requested.values.selection = evolution::SelectionMethod::Tournament;
    tournament.active.tournament_replacement = tournament.requested.values.tournament_replacement = false;
    const auto refused = request_at_generation(tournament, assignments);
    ASSERT_FALSE(refused) << "a tournament of 3 needs a population of 3";
    EXPECT_THAT(refused.error().violations[0].allowed, HasSubstr("is bred with the previous values"));
}

TEST(RequestedParameters, AreNotConvertedImplicitly) {
    EXPECT_FALSE((std::is_convertible_v<Parameters, RequestedParameters>));
    EXPECT_FALSE((std::is_convertible_v<RequestedParameters, Parameters>));
}

TEST(BreedingWith, TakesOnlyTheValuesOfTheGeneration) {
    Parameters requested;
    requested.population_size = 80;
    requested.mutation_chance = 0.9;
    requested.island_count = 3;
    const Parameters breeding = breeding_with({}, RequestedParameters{requested});
    EXPECT_THAT(parameters_that_differ({}, breeding), ElementsAre(find_parameter("population_size")));
}

TEST(ScheduleFaults, AreThoseOfTheFirstInvalidGeneration) {
    Schedule schedule;
    schedule.add(2, {"impulse_min", 100.0});
    schedule.add(4, {"impulse_max", 90.0});
    schedule.add(6, {"impulse_max", 80.0});
    const std::vector<ScheduleFault> faults = faults_of(schedule, {});
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].generation, 4u);
    EXPECT_EQ(faults[0].violation.field, "impulse_max");
    schedule.remove("impulse_min");
    EXPECT_TRUE(faults_of(schedule, {}).empty());
}

TEST(Schedule, BirthsKeepTheIsland) {
    Parameters p;
    Schedule schedule;
    schedule.add(5, {"island_width_px", 2000.0});
    schedule.begin_with(p);
    EXPECT_TRUE(faults_of(schedule, p).empty());
    p.reproduction = Reproduction::Births;
    const auto faults = faults_of(schedule, p);
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].generation, 5u);
    EXPECT_EQ(faults[0].violation.field, "island_width_px");
}

} // namespace
} // namespace evod::parameters
