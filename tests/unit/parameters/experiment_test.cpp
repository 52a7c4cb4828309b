#include "server/parameters/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace evod::parameters {
namespace {

using testing::HasSubstr;

/// The refusal of a text as text; empty if the text is accepted.
std::string refusal_of(std::string_view text) {
    const auto result = parse_experiment(text);
    return result ? "" : to_text(result.error());
}

TEST(Experiment, HasDefaultsForUnnamedParameters) {
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
    for (const char* bad : {"-1", "1.5", "18446744073709551616", "\"7\"", "null"}) {
        EXPECT_THAT(refusal_of(std::string{"{\"seed\": "} + bad + "}"), HasSubstr("seed (line 1)")) << bad;
    }
}

TEST(Experiment, ReferencePopulationDefaultsToThePopulation) {
    EXPECT_EQ(parse_experiment(R"({"population_size": 80})")->parameters.reference_population, 80u);
    EXPECT_EQ(
        parse_experiment(R"({"population_size": 80, "reference_population": 40})")->parameters.reference_population,
        40u);
    EXPECT_EQ(parse_experiment(R"({"reference_population": 40})")->parameters.population_size, 50u);
    EXPECT_EQ(parse_experiment("{}")->parameters.reference_population, 50u);
    // A wrong population is reported once.
    const auto refused = parse_experiment(R"({"population_size": 0})");
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().violations.size(), 1u);
}

TEST(Experiment, PredatorsHaveTheValuesOfThePrey) {
    const auto read = [](const char* text) { return parse_experiment(text)->parameters; };
    EXPECT_EQ(read(R"({"mutation_chance": 0.3})").predator_mutation_chance, 0.3);
    EXPECT_EQ(read(R"({"mutation_chance": 0.3, "predator_mutation_chance": 0.1})").predator_mutation_chance, 0.1);
    EXPECT_EQ(read(R"({"predator_mutation_chance": 0.1})").mutation_chance, 0.15);
    EXPECT_EQ(read(R"({"mutation_chance": {"1": 0.3, "9": 0.1}})").predator_mutation_chance, 0.3);
    EXPECT_EQ(read(R"({"births": "asexual"})").predator_births, Births::Asexual);
    // A wrong value is reported once; values of predators that do not fit together are reported, too.
    EXPECT_EQ(parse_experiment(R"({"mutation_chance": 3})").error().violations.size(), 1u);
    EXPECT_EQ(parse_experiment(R"({"initial_gene_min": 130})").error().violations.size(), 1u);
    EXPECT_THAT(refusal_of(R"({"predator_initial_gene_min": 130})"), HasSubstr("predator_initial_gene_max (line 1)"));
}

TEST(Experiment, WritesPredatorsThatDifferFromThePrey) {
    Parameters p;
    p.mutation_chance = 0.3;
    EXPECT_THAT(to_experiment_text(p), HasSubstr("\"predator_mutation_chance\": 0.15"));
    p.predator_mutation_chance = 0.3;
    EXPECT_THAT(to_experiment_text(p), testing::Not(HasSubstr("predator")));
    for (const Written written : {Written::Differences, Written::Everything}) {
        EXPECT_TRUE(parse_experiment(to_experiment_text(p, written))->parameters == p);
    }
}

TEST(Experiment, ReportsTheLineOfBrokenJson) {
    EXPECT_THAT(refusal_of("{\n  \"food_count\": 3,\n  \"respawn\" true\n}"), HasSubstr("line 3"));
    EXPECT_THAT(refusal_of("{\n  \"food_count\": 3\n"), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of("{}\n\n}"), HasSubstr("line 3"));
    EXPECT_THAT(refusal_of(""), HasSubstr("line 1"));
    EXPECT_THAT(refusal_of("[1, 2]"), HasSubstr("a JSON object"));
    EXPECT_THAT(refusal_of("3"), HasSubstr("a JSON object"));
    EXPECT_THAT(refusal_of(std::string(100'000, '[')), HasSubstr("not JSON"));
}

TEST(Experiment, NamesEveryWrongFieldWithItsLine) {
    const auto refused = parse_experiment("{\n  \"food_cuont\": 3,\n  \"tick_s\": -1,\n\n  \"respawn\": null,\n"
                                          "  \"description\": 4,\n  \"selection\": [\"roulette\"]\n}");
    ASSERT_FALSE(refused.has_value());
    std::vector<std::string> fields;
    for (const base::Violation& violation : refused.error().violations) {
        fields.push_back(violation.field);
    }
    EXPECT_THAT(fields, testing::UnorderedElementsAre("food_cuont (line 2)", "tick_s (line 3)", "respawn (line 5)",
                                                      "description (line 6)", "selection (line 7)"));
    EXPECT_THAT(to_text(refused.error()), HasSubstr("did you mean food_count"));
}

TEST(Experiment, ReportsTheLineOfTheFieldNotOfSimilarText) {
    EXPECT_THAT(refusal_of("{\n\"description\": \"tick_s\",\n\"tick_s\": -1\n}"), HasSubstr("tick_s (line 3)"));
}

TEST(Experiment, RefusesARepeatedField) {
    const std::string refusal = refusal_of("{\n\"food_count\": 3,\n\"tick_s\": 0.01,\n\"food_count\": 30\n}");
    EXPECT_THAT(refusal, HasSubstr("food_count (line 4)"));
    EXPECT_THAT(refusal, HasSubstr("twice"));
    EXPECT_THAT(refusal_of(R"({"seed": 1, "seed": 2})"), HasSubstr("seed (line 1)"));
}

TEST(Experiment, RefusesInvalidNumbers) {
    for (const char* text : {R"({"tick_s": NaN})", R"({"tick_s": Infinity})", R"({"tick_s": 1e999})",
                             R"({"food_count": -3})", R"({"food_count": 2.5})", R"({"food_count": 5000000000})"}) {
        EXPECT_NE(refusal_of(text), "") << text;
    }
}

TEST(Experiment, IsReadBackFromItsOwnText) {
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

TEST(Experiment, MayHaveValuesByGeneration) {
    const auto experiment = parse_experiment(R"({"mutation_chance": {"1": 0.2, "30": 0.05, "60": 1}, "elite_count": 3,
        "selection": {"30": "tournament"}, "food_count": {"1": 30}})");
    ASSERT_TRUE(experiment) << to_text(experiment.error());
    EXPECT_EQ(experiment->parameters.mutation_chance, 0.2);
    EXPECT_EQ(experiment->parameters.selection, evolution::SelectionMethod::Roulette) << "the default until the first";
    EXPECT_EQ(experiment->parameters.food_count, 30u);
    EXPECT_FALSE(experiment->schedule.holds("food_count")) << "nothing changes";
    const auto& changes = experiment->schedule.changes();
    ASSERT_EQ(changes.size(), 3u);
    EXPECT_THAT(changes.at(1), testing::ElementsAre(Assignment{"selection", std::string{"roulette"}},
                                                    Assignment{"mutation_chance", 0.2}));
    EXPECT_THAT(changes.at(30), testing::ElementsAre(Assignment{"selection", std::string{"tournament"}},
                                                     Assignment{"mutation_chance", 0.05}));
    EXPECT_THAT(changes.at(60), testing::ElementsAre(Assignment{"mutation_chance", 1.0}));
    EXPECT_TRUE(parse_experiment("{}")->schedule.empty());
}

TEST(Experiment, ReferencePopulationIsTheFirstScheduledOne) {
    const auto experiment =
        parse_experiment(R"({"population_size": {"1": 30, "5": 60}, "scale_with_population": true})");
    ASSERT_TRUE(experiment) << to_text(experiment.error());
    EXPECT_EQ(experiment->parameters.reference_population, 30u);
    EXPECT_EQ(parse_experiment(R"({"population_size": {"5": 60}})")->parameters.reference_population, 50u);
    const auto given =
        parse_experiment(R"({"population_size": {"1": 30, "5": 60}, "reference_population": {"5": 60}})");
    ASSERT_TRUE(given) << to_text(given.error());
    EXPECT_EQ(given->parameters.reference_population, 50u) << "given, though not for generation 1: its default";
}

TEST(Experiment, ItsScheduleIsReadBackFromItsOwnText) {
    for (const char* text :
         {R"({"mutation_chance": {"1": 0.2, "30": 0.05}, "respawn": {"7": false},
              "crossover": {"2": "none", "3": "uniform"}})",
          R"({"population_size": {"1": 30, "5": 60}})", R"({"population_size": {"5": 60}, "reference_population": 7})",
          R"({"food_health": {"18446744073709551615": 0.1}})", "{}"}) {
        const auto experiment = parse_experiment(text);
        ASSERT_TRUE(experiment) << to_text(experiment.error());
        for (const Written written : {Written::Differences, Written::Everything}) {
            const std::string again = to_experiment_text(experiment->parameters, written, experiment->schedule);
            const auto read = parse_experiment(again);
            ASSERT_TRUE(read) << again << to_text(read.error());
            EXPECT_TRUE(read->parameters == experiment->parameters) << again;
            EXPECT_EQ(read->schedule, experiment->schedule) << again;
        }
        const auto alone = parse_schedule(to_schedule_text(experiment->schedule));
        ASSERT_TRUE(alone) << to_text(alone.error());
        EXPECT_EQ(*alone, experiment->schedule);
    }
    for (const char* text : {"[]", R"({"food_count": 3})", R"({"food_count": {"2": 3}})", R"({"x": {"1": 3}})",
                             R"({"island_count": {"1": 1, "2": 3}})", R"({"tick_s": {"1": -1, "2": 0.1}})"}) {
        EXPECT_FALSE(parse_schedule(text)) << text;
    }
}

TEST(Experiment, NamesScheduleErrorsByGenerationAndLine) {
    const std::string refusal = refusal_of(R"({
  "mutation_chance": {
    "1": 0.2,
    "30": 1.5,
    "0": 0.1,
    "x": 0.1, "030": 1,
    "40": null,
    "40": 0.1
  },
  "island_count": {"2": 3},
  "food_cuont": {"2": 3},
  "food_count": {},
  "tick_s": {"2": -1}
})");
    EXPECT_THAT(refusal, HasSubstr("mutation_chance at generation 30 (line 4): got 1.5, allowed 0 to 1"));
    EXPECT_THAT(refusal, HasSubstr("mutation_chance (line 5): got \"0\", allowed generations as keys"));
    EXPECT_THAT(refusal, HasSubstr("mutation_chance (line 6): got \"x\""));
    EXPECT_THAT(refusal, HasSubstr("mutation_chance (line 6): got \"030\""));
    EXPECT_THAT(refusal, HasSubstr("mutation_chance at generation 40 (line 8): got given twice"));
    EXPECT_THAT(refusal, HasSubstr("island_count (line 10): got values by generation, allowed one value"));
    EXPECT_THAT(refusal, HasSubstr("food_cuont (line 11)"));
    EXPECT_THAT(refusal, HasSubstr("did you mean food_count"));
    EXPECT_THAT(refusal, HasSubstr("food_count (line 12): got {}"));
    EXPECT_THAT(refusal, HasSubstr("tick_s at generation 2 (line 13): got -1"));
}

TEST(Experiment, EveryCombinationOfAScheduleIsValidated) {
    const std::string refusal =
        refusal_of("{\n\"impulse_max\": {\n\"2\": 300,\n\"7\": 90},\n\"impulse_min\": {\"5\": 100}\n}");
    EXPECT_THAT(refusal, HasSubstr("impulse_max at generation 7 (line 4): got 90, allowed at least impulse_min (100)"));
    EXPECT_THAT(refusal_of("{\"impulse_min\":\n{\"5\": 260}}"),
                HasSubstr("impulse_max at generation 5 (line 2): got 250"));
    // The new organisms are as large as the breeding parameters before the change allow.
    EXPECT_EQ(refusal_of(R"({"population_size": {"2": 250}, "body_size_max": {"2": 100}, "island_width_px": 1280})"),
              "");
    EXPECT_THAT(refusal_of(R"({"population_size": {"2": 900}, "body_size_max": {"2": 60}})"),
                HasSubstr("bred with the previous values of breeding parameters"));
    EXPECT_EQ(refusal_of(R"({"population_size": {"3": 900}, "body_size_max": {"2": 60}})"), "");
}

TEST(Experiment, TheSizeOfAScheduleIsLimited) {
    const auto steps = [](std::size_t count) {
        std::string text = "{\"food_health\": {\"1\": 0";
        for (std::size_t i = 0; i < count; ++i) {
            text += ", \"" + std::to_string(i + 2) + "\": " + std::to_string(i % 7);
        }
        return text + "}}";
    };
    EXPECT_EQ(refusal_of(steps(Schedule::values_max)), "");
    EXPECT_THAT(refusal_of(steps(Schedule::values_max + 1)), HasSubstr("the schedule: got 4097, allowed at most 4096"));
}

TEST(ExperimentsOfTheRepository, AreAllAccepted) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator{EVOD_SOURCE_FOLDER "/experiments"}) {
        if (entry.path().extension() != ".json") {
            continue;
        }
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

TEST(Experiment, KeepsEveryBitOfANumber) {
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
} // namespace evod::parameters
