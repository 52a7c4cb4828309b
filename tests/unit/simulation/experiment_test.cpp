#include "server/simulation/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace evod::simulation {
namespace {

using testing::HasSubstr;

/// The refusal of a text as one text; empty if it is accepted.
std::string refusal_of(std::string_view text) {
    const auto result = parse_experiment(text);
    return result ? "" : to_text(result.error());
}

TEST(Experiment, HasTheDefaultsForWhatItDoesNotName) {
    const auto experiment = parse_experiment(R"({"description": "x", "seed": 7, "food_count": 30, "respawn_s": 2,
                                                 "flee_rule": "always", "respawn": true})");
    ASSERT_TRUE(experiment.has_value());
    EXPECT_EQ(experiment->seed, base::Seed{7});
    EXPECT_EQ(experiment->description, "x");
    Parameters expected;
    expected.food_count = 30;
    expected.respawn_s = 2;
    expected.flee_rule = FleeRule::Always;
    EXPECT_TRUE(experiment->parameters == expected);
    EXPECT_FALSE(parse_experiment("{}")->seed.has_value());
    EXPECT_TRUE(parse_experiment(" {}\n\n")->parameters == Parameters{});
}

TEST(Experiment, KeepsAllBitsOfASeed) {
    EXPECT_EQ(parse_experiment(R"({"seed": 18446744073709551615})")->seed, base::Seed{~std::uint64_t{0}});
    EXPECT_EQ(parse_experiment(R"({"seed": 9223372036854775808})")->seed, base::Seed{std::uint64_t{1} << 63});
    EXPECT_EQ(parse_experiment(R"({"seed": 0})")->seed, base::Seed{0});
    for (const char* bad : {"-1", "1.5", "18446744073709551616", "\"7\"", "null"})
        EXPECT_THAT(refusal_of(std::string{"{\"seed\": "} + bad + "}"), HasSubstr("seed (line 1)")) << bad;
}

TEST(Experiment, LetsTheReferencePopulationFollowItsOwnPopulation) {
    EXPECT_EQ(parse_experiment(R"({"population_size": 80})")->parameters.reference_population, 80u);
    EXPECT_EQ(
        parse_experiment(R"({"population_size": 80, "reference_population": 40})")->parameters.reference_population,
        40u);
    EXPECT_EQ(parse_experiment(R"({"reference_population": 40})")->parameters.population_size, 50u);
    EXPECT_EQ(parse_experiment("{}")->parameters.reference_population, 50u);
    // A wrong population is told once.
    const auto refused = parse_experiment(R"({"population_size": 0})");
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().violations.size(), 1u);
}

TEST(Experiment, SaysOnWhichLineTheJsonIsBroken) {
    EXPECT_THAT(refusal_of("{\n  \"food_count\": 3,\n  \"respawn\" true\n}"), HasSubstr("line 3"));
    EXPECT_THAT(refusal_of("{\n  \"food_count\": 3\n"), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of("{}\n\n}"), HasSubstr("line 3"));
    EXPECT_THAT(refusal_of(""), HasSubstr("line 1"));
    EXPECT_THAT(refusal_of("[1, 2]"), HasSubstr("a JSON object"));
    EXPECT_THAT(refusal_of("3"), HasSubstr("a JSON object"));
    EXPECT_THAT(refusal_of(std::string(100'000, '[')), HasSubstr("not JSON"));
}

TEST(Experiment, NamesEveryFieldThatIsWrongWithItsLine) {
    const auto refused = parse_experiment("{\n  \"food_cuont\": 3,\n  \"tick_s\": -1,\n\n  \"respawn\": null,\n"
                                          "  \"description\": 4,\n  \"selection\": [\"roulette\"]\n}");
    ASSERT_FALSE(refused.has_value());
    std::vector<std::string> fields;
    for (const base::Violation& violation : refused.error().violations)
        fields.push_back(violation.field);
    EXPECT_THAT(fields, testing::UnorderedElementsAre("food_cuont (line 2)", "tick_s (line 3)", "respawn (line 5)",
                                                      "description (line 6)", "selection (line 7)"));
    EXPECT_THAT(to_text(refused.error()), HasSubstr("did you mean food_count"));
}

TEST(Experiment, TellsTheLineOfTheFieldNotOfATextThatIsLikeIt) {
    EXPECT_THAT(refusal_of("{\n\"description\": \"tick_s\",\n\"tick_s\": -1\n}"), HasSubstr("tick_s (line 3)"));
}

TEST(Experiment, RefusesAFieldThatIsGivenTwice) {
    const std::string refusal = refusal_of("{\n\"food_count\": 3,\n\"tick_s\": 0.01,\n\"food_count\": 30\n}");
    EXPECT_THAT(refusal, HasSubstr("food_count (line 4)"));
    EXPECT_THAT(refusal, HasSubstr("twice"));
    EXPECT_THAT(refusal_of(R"({"seed": 1, "seed": 2})"), HasSubstr("seed (line 1)"));
}

TEST(Experiment, RefusesNumbersThatAreNone) {
    for (const char* text : {R"({"tick_s": NaN})", R"({"tick_s": Infinity})", R"({"tick_s": 1e999})",
                             R"({"food_count": -3})", R"({"food_count": 2.5})", R"({"food_count": 5000000000})"})
        EXPECT_NE(refusal_of(text), "") << text;
}

TEST(Experiment, OfItsOwnTextIsTheSame) {
    Parameters p;
    p.food_count = 99;
    p.tick_s = 1.0 / 30;
    p.selection = evolution::SelectionMethod::Truncation;
    p.respawn = false;
    p.reference_population = 60;
    p.population_size = 70;
    const std::string text = to_experiment_text(p);
    const auto read = parse_experiment(text);
    ASSERT_TRUE(read.has_value()) << text;
    EXPECT_TRUE(read->parameters == p) << text;
    EXPECT_EQ(to_experiment_text({}), "{}\n");

    Parameters larger; // with the default reference
    larger.population_size = 70;
    EXPECT_TRUE(parse_experiment(to_experiment_text(larger))->parameters == larger) << to_experiment_text(larger);
}

TEST(ExperimentsOfTheRepository, AreAllAccepted) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator{EVOD_SOURCE_FOLDER "/experiments"}) {
        if (entry.path().extension() != ".json")
            continue;
        std::ifstream file{entry.path()};
        std::stringstream text;
        text << file.rdbuf();
        EXPECT_EQ(refusal_of(text.str()), "") << entry.path();
        EXPECT_FALSE(parse_experiment(text.str())->description.empty()) << entry.path();
        EXPECT_TRUE(entry.path().stem() != "default" || parse_experiment(text.str())->parameters == Parameters{});
        ++count;
    }
    EXPECT_GE(count, 5);
}

TEST(Experiment, GivesBackEveryBitOfANumber) {
    base::RandomStream random{base::RandomKey{base::Seed{3}, base::Purpose::ScenarioTest, 0, 0}, 0};
    for (int trial = 0; trial < 2000; ++trial) {
        Parameters parameters;
        parameters.mutation_chance = random.uniform();
        parameters.food_health = 0.1 + trial * 1e-5;
        const auto read = parse_experiment(to_experiment_text(parameters, Written::Everything));
        ASSERT_TRUE(read) << to_text(read.error());
        ASSERT_EQ(read->parameters.mutation_chance, parameters.mutation_chance);
        ASSERT_EQ(read->parameters.food_health, parameters.food_health);
    }
}

} // namespace
} // namespace evod::simulation
