#include "client/viewer/world/new_world.h"

#include "tests/unit/viewer/world/population_of.h"

#include <gmock/gmock.h>

namespace evod::viewer {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const NewWorldForm& wanted) {
    const auto request = create_request(wanted);
    return request ? "accepted" : request.error().what;
}

TEST(NewWorld, NamesAreTheServersAndSafeForFiles) {
    EXPECT_EQ(name_problem("name", "Trade_offs-2"), "");
    EXPECT_EQ(name_problem("name", std::string(64, 'x')), "");
    for (const std::string bad : {"", "a b", "../a", "a.csv", "ä", "a/b"}) {
        EXPECT_EQ(name_problem("name", bad),
                  "name: got \"" + bad + "\", allowed 1 to 64 characters of a-z A-Z 0-9 _ -");
    }
    EXPECT_NE(name_problem("name", std::string(65, 'x')), "");
}

TEST(NewWorld, SuggestsANameThatNoWorldHas) {
    const std::vector<std::string> used{"default", "default-2", "default-3", "w9"};
    EXPECT_EQ(unused_name("islands", used), "islands");
    EXPECT_EQ(unused_name("default", used), "default-4");
    EXPECT_EQ(unused_name("default-2", used), "default-4");
    EXPECT_EQ(unused_name("w9", used), "w9-2") << "the number is part of the name";
    const std::string longest(64, 'x');
    EXPECT_EQ(unused_name(longest, std::vector{longest}), std::string(62, 'x') + "-2");
}

TEST(NewWorld, WritesParametersAsAnExperiment) {
    evod::v1::ParameterSet set;
    const auto add = [&](const char* name) -> evod::v1::ParameterState& {
        auto& parameter = *set.add_parameters();
        parameter.set_name(name);
        return parameter;
    };
    add("mutation_chance").mutable_value()->set_real(0.1);
    auto& size = add("population_size");
    size.mutable_value()->set_count(50);
    size.mutable_pending()->set_count(60);
    add("mutate_survivors").mutable_value()->set_flag(true);
    add("selection").mutable_value()->set_choice("roulette");
    for (const auto& [generation, chance] : {std::pair{20u, 0.05}, {40u, 1e-7}}) {
        auto& later = *set.add_schedule();
        later.set_name("mutation_chance");
        later.set_generation(generation);
        later.mutable_value()->set_real(chance);
    }
    EXPECT_EQ(experiment_json(set), R"({
  "mutation_chance": {"1": 0.1, "20": 0.05, "40": 1e-07},
  "population_size": 60,
  "mutate_survivors": true,
  "selection": "roulette"
}
)");
}

TEST(NewWorld, ARequestContainsWhatTheUserChose) {
    const auto request = create_request({.name = "w", .seed = "18446744073709551615", .experiment_json = "{}"});
    ASSERT_TRUE(request);
    EXPECT_EQ(request->create_world().name(), "w");
    EXPECT_EQ(request->create_world().seed(), 18446744073709551615u);
    EXPECT_EQ(request->create_world().experiment_json(), "{}");
    EXPECT_EQ(request->create_world().parameters_size(), 0);
    EXPECT_FALSE(create_request({.name = "w"})->create_world().has_seed()) << "the server chooses one";
}

TEST(NewWorld, APopulationSetsTheSizeOfTheWorld) {
    const std::vector<float> two(12, 100);
    const auto request = create_request({.name = "w", .population = population_of({two, two, two})});
    ASSERT_TRUE(request);
    const auto& command = request->create_world();
    EXPECT_EQ(command.population_size(), 3);
    EXPECT_EQ(command.population(2).genes_size(), 12);
    ASSERT_EQ(command.parameters_size(), 2);
    EXPECT_EQ(command.parameters(0).name(), "population_size");
    EXPECT_EQ(command.parameters(0).value().count(), 2u);
    EXPECT_EQ(command.parameters(1).name(), "island_count");
    EXPECT_EQ(command.parameters(1).value().count(), 3u);
}

TEST(NewWorld, RefusalsNameTheField) {
    EXPECT_THAT(refusal_of({.name = "a b"}), StartsWith("name: got \"a b\""));
    EXPECT_THAT(refusal_of({.name = "w", .seed = "-1"}), StartsWith("seed: got \"-1\", allowed"));
    EXPECT_EQ(refusal_of({.name = "w", .population = population_of({std::vector<float>(12), std::vector<float>(6)})}),
              "population: got islands of 2 and 1 organisms, allowed the same number on each island");
    EXPECT_THAT(refusal_of({.name = "w", .population = population_of({std::vector<float>(300'000)})}),
                StartsWith("population: too large for a request"));
    EXPECT_THAT(refusal_of({.name = "w", .experiment_json = std::string(2'000'000, ' ')}),
                HasSubstr("parameters: got 2000000 bytes"));
}

} // namespace
} // namespace evod::viewer
