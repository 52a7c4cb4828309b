#include "server/experiments/sweep_file.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

namespace evod::experiments {
namespace {

using parameters::ParameterValue;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

base::Result<parameters::Experiment> none(const std::string& path) {
    return refusal(base::RefusalCode::NotFound, path + ": cannot be read");
}

Sweep sweep_of(const std::string& text) {
    const auto sweep = parse_sweep(text, none);
    EXPECT_TRUE(sweep) << to_text(sweep.error());
    return sweep ? *sweep : Sweep{};
}

std::string refusal_of(const std::string& text) {
    const auto sweep = parse_sweep(text, none);
    EXPECT_FALSE(sweep) << text;
    return sweep ? "" : to_text(sweep.error());
}

/// Of a parameter, in order of cells.
std::vector<std::string> column(const Sweep& sweep, std::string_view name) {
    std::vector<std::string> values;
    for (std::size_t i = 0; i < sweep.swept.size(); ++i) {
        if (sweep.swept[i]->name == name) {
            for (const auto& cell : sweep.cells) {
                values.push_back(parameters::to_text(cell[i]));
            }
        }
    }
    return values;
}

TEST(SweepFile, SeedsMayBeGiven) {
    const Sweep sweep = sweep_of(R"({"grid": {"food_count": [5, 7]}, "seeds": [11, 12, 13.0], "generations": 3})");
    EXPECT_EQ(sweep.replicates, 3u);
    EXPECT_EQ(sweep.seed_of(0), base::Seed{11});
    EXPECT_EQ(sweep.seed_of(2), base::Seed{13});
    const auto refused = [](const std::string& members) {
        return refusal_of(R"({"grid": {"food_count": [5, 7]}, "generations": 3, )" + members + "}");
    };
    EXPECT_THAT(refused(R"("seeds": [11, 11])"), HasSubstr("each seed once"));
    EXPECT_THAT(refused(R"("seeds": [])"), HasSubstr("a list of seeds"));
    EXPECT_THAT(refused(R"("seeds": [1, 2], "replicates": 3)"), HasSubstr("the number of seeds"));
    EXPECT_THAT(refused(R"("seed": [11, 12])"), HasSubstr("\"seeds\""));
}

TEST(SweepFile, ImpossibleCellsCanBeSkipped) {
    const std::string grid = R"({"experiment": {"selection": "tournament", "tournament_replacement": false},
        "grid": {"population_size": [10, 50], "tournament_size": [5, 20]}, "generations": 2)";
    EXPECT_THAT(refusal_of(grid + "}"), HasSubstr("cell 1 (population_size 10, tournament_size 20)"));
    EXPECT_THAT(refusal_of(grid + R"(, "skip_invalid": false})"), HasSubstr("cell 1"));
    const Sweep sweep = sweep_of(grid + R"(, "skip_invalid": true})");
    EXPECT_EQ(sweep.cells.size(), 3u);
    EXPECT_THAT(column(sweep, "tournament_size"), ElementsAre("5", "5", "20"));
    ASSERT_EQ(sweep.skipped.size(), 1u);
    EXPECT_THAT(sweep.skipped[0], HasSubstr("cell 1 (population_size 10, tournament_size 20)"));
    EXPECT_THAT(refusal_of(R"({"experiment": {"selection": "tournament", "tournament_replacement": false},
        "grid": {"population_size": [2], "tournament_size": [5, 20]}, "generations": 2, "skip_invalid": true})"),
                HasSubstr("cell 0"));
    EXPECT_THAT(refusal_of(grid + R"(, "skip_invalid": 1})"), HasSubstr("true or false"));
}

TEST(SweepFile, NumbersOfNumPyAreWholeNumbers) {
    const Sweep sweep = sweep_of(R"({"grid": {"population_size": [10.0, 15.0, 2e1]}, "replicates": 2.0,
        "generations": 3.0, "every": 2})");
    EXPECT_THAT(column(sweep, "population_size"), ElementsAre("10", "15", "20"));
    EXPECT_EQ(sweep.replicates, 2u);
    EXPECT_EQ(sweep.every, 2u);
    EXPECT_THAT(refusal_of(R"({"grid": {"population_size": [10.5]}, "generations": 3})"), HasSubstr("got 10.5"));
}

TEST(SweepFile, AGridHasEveryCombination) {
    const Sweep sweep =
        sweep_of(R"({"grid": {"selection": ["roulette", "tournament"], "mutate_survivors": [true, false],
        "food_count": [5, 7]}, "generations": 3})");
    EXPECT_EQ(sweep.cells.size(), 8u);
    EXPECT_EQ(sweep.run_count(), 8u);
    EXPECT_THAT(column(sweep, "food_count"), ElementsAre("5", "7", "5", "7", "5", "7", "5", "7"));
    EXPECT_THAT(column(sweep, "mutate_survivors"),
                ElementsAre("true", "true", "false", "false", "true", "true", "false", "false"));
    EXPECT_EQ(column(sweep, "selection")[3], "roulette");
    const parameters::Parameters last = sweep.parameters_of(7);
    EXPECT_EQ(last.selection, evolution::SelectionMethod::Tournament);
    EXPECT_FALSE(last.mutate_survivors);
    EXPECT_EQ(last.food_count, 7u);
    EXPECT_EQ(last.generation_limit, 3u);
    EXPECT_EQ(last.population_size, parameters::Parameters{}.population_size);
}

TEST(SweepFile, ARangeHasBothEndsAndEvenSteps) {
    const Sweep sweep =
        sweep_of(R"({"grid": {"mutation_step": {"from": 0.5, "to": 2.5, "steps": 5}}, "generations": 1})");
    EXPECT_THAT(column(sweep, "mutation_step"), ElementsAre("0.5", "1", "1.5", "2", "2.5"));
    const Sweep log = sweep_of(
        R"({"grid": {"mutation_step": {"from": 0.1, "to": 100, "steps": 4, "scale": "log"}}, "generations": 1})");
    ASSERT_EQ(log.cells.size(), 4u);
    EXPECT_EQ(std::get<double>(log.cells[0][0]), 0.1);
    EXPECT_NEAR(std::get<double>(log.cells[1][0]), 1, 1e-14);
    EXPECT_NEAR(std::get<double>(log.cells[2][0]), 10, 1e-13);
    EXPECT_EQ(std::get<double>(log.cells[3][0]), 100.0);
}

TEST(SweepFile, ARangeOfWholeNumbersHasEachNearestOnce) {
    const auto food = [](const char* range) {
        return column(sweep_of(std::string{R"({"generations": 1, "grid": {"food_count": )"} + range + "}}"),
                      "food_count");
    };
    EXPECT_THAT(food(R"({"from": 0, "to": 10, "steps": 5})"), ElementsAre("0", "3", "5", "8", "10"));
    EXPECT_THAT(food(R"({"from": 1, "to": 3, "steps": 9})"), ElementsAre("1", "2", "3"));
    EXPECT_THAT(food(R"({"from": 1, "to": 100, "steps": 3, "scale": "log"})"), ElementsAre("1", "10", "100"));
}

TEST(SweepFile, AListTakesOtherValuesFromTheExperiment) {
    const Sweep sweep = sweep_of(R"({"experiment": {"food_count": 9, "generation_limit": 4},
        "list": [{}, {"poison_count": 3}, {"food_count": 2, "generation_limit": 5}], "replicates": 3})");
    EXPECT_THAT(column(sweep, "poison_count"), ElementsAre("40", "3", "40"));
    EXPECT_THAT(column(sweep, "food_count"), ElementsAre("9", "9", "2"));
    EXPECT_THAT(column(sweep, "generation_limit"), ElementsAre("4", "4", "5"));
    EXPECT_EQ(sweep.run_count(), 9u);
    EXPECT_EQ(sweep.parameters_of(2).generation_limit, 5u);
}

TEST(SweepFile, ASweptParameterReplacesItsSchedule) {
    const Sweep sweep = sweep_of(R"({"experiment": {"mutation_chance": {"1": 0.2, "30": 0.05},
        "mutation_step": {"10": 5}, "generation_limit": {"1": 9, "4": 12}},
        "grid": {"mutation_chance": [0.1, 0.3]}, "generations": 40})");
    ASSERT_EQ(sweep.cells.size(), 2u);
    const parameters::Schedule schedule = sweep.schedule_of(1);
    EXPECT_FALSE(schedule.holds("mutation_chance"));
    EXPECT_FALSE(schedule.holds("generation_limit")) << "generations takes its place";
    ASSERT_EQ(schedule.at(10).size(), 1u);
    EXPECT_EQ(schedule.at(10)[0].name, "mutation_step");
    EXPECT_EQ(sweep.parameters_of(1).mutation_chance, 0.3);
    EXPECT_TRUE(faults_of(schedule, sweep.parameters_of(1)).empty());
    EXPECT_THAT(refusal_of(R"({"experiment": {"tournament_size": 5, "tournament_winners": {"5": 4}},
        "grid": {"tournament_size": [3, 5]}, "generations": 40})"),
                HasSubstr("cell 0 (tournament_size 3): tournament_size at generation 5"));
}

TEST(SweepFile, ALatinHypercubeSamplesEachPartOnce) {
    const Sweep sweep = sweep_of(R"({"generations": 1, "seed": 3, "latin_hypercube": {"samples": 40, "parameters": {
        "mutation_chance": {"from": 0.2, "to": 0.6}, "mutation_step": {"from": 1, "to": 100, "scale": "log"},
        "food_count": {"from": 1, "to": 4}, "selection": ["roulette", "random"]}}})");
    ASSERT_EQ(sweep.cells.size(), 40u);
    std::set<int> parts, parts_of_log;
    std::map<ParameterValue, int> counts, choices;
    for (const auto& cell : sweep.cells) {
        parts.insert(static_cast<int>(std::floor((std::get<double>(cell[0]) - 0.2) / 0.4 * 40)));
        parts_of_log.insert(static_cast<int>(std::floor(std::log10(std::get<double>(cell[1])) / 2 * 40)));
        ++counts[cell[2]];
        ++choices[cell[3]];
    }
    EXPECT_EQ(parts.size(), 40u);
    EXPECT_EQ(*parts.begin(), 0);
    EXPECT_EQ(*parts.rbegin(), 39);
    EXPECT_EQ(parts_of_log.size(), 40u);
    // Ten of each of four, twenty of each of two: every one has the same share.
    EXPECT_EQ(counts, (std::map<ParameterValue, int>{{1u, 10}, {2u, 10}, {3u, 10}, {4u, 10}}));
    EXPECT_EQ(choices, (std::map<ParameterValue, int>{{"roulette", 20}, {"random", 20}}));
}

TEST(SweepFile, ALatinHypercubeFollowsFromTheSeed) {
    const auto drawn = [](const std::string& seed) {
        return sweep_of(R"({"generations": 1, "latin_hypercube": {"samples": 16, "parameters": {"mutation_chance":
            {"from": 0, "to": 1}, "survivors": {"from": 0, "to": 1}}}, "seed": )" +
                        seed + "}");
    };
    EXPECT_EQ(drawn("5").cells, drawn("5").cells);
    EXPECT_NE(drawn("5").cells, drawn("6").cells);
    const Sweep sweep = drawn("5");
    EXPECT_NE(column(sweep, "mutation_chance"), column(sweep, "survivors"));
    EXPECT_EQ(column(sweep, "survivors")[0], "0.13972668521716183"); // must never change
}

TEST(SweepFile, TheSeedIsTheSweepsOrTheExperimentsOrOne) {
    const std::string rest = R"("list": [{}], "generations": 1)";
    EXPECT_EQ(sweep_of("{" + rest + "}").seed, base::Seed{1});
    EXPECT_EQ(sweep_of(R"({"experiment": {"seed": 9}, )" + rest + "}").seed, base::Seed{9});
    EXPECT_EQ(sweep_of(R"({"experiment": {"seed": 9}, "seed": 18446744073709551615, )" + rest + "}").seed,
              base::Seed{~std::uint64_t{0}});
}

TEST(SweepFile, AnExperimentIsLoadedByItsPath) {
    std::string asked;
    const auto sweep =
        parse_sweep(R"({"experiment": "a \u0022b\u0022.json", "list": [{}]})", [&](const std::string& path) {
            asked = path;
            parameters::Experiment experiment;
            experiment.parameters.stagnation_limit = 3;
            return base::Result<parameters::Experiment>{experiment};
        });
    ASSERT_TRUE(sweep) << to_text(sweep.error());
    EXPECT_EQ(asked, "a \"b\".json");
    EXPECT_EQ(sweep->parameters_of(0).stagnation_limit, 3u);
    EXPECT_THAT(refusal_of(R"({"experiment": "x.json", "list": [{}]})"), HasSubstr("x.json: cannot be read"));
}

TEST(SweepFile, ErrorsNameTheFieldAndItsLine) {
    const std::map<std::string, std::string> wrong{
        {"{\n\"list\": [{}],\n\"steps\": 3}", "steps (line 3): unknown name; did you mean seeds?"},
        {"{\n\"list\": [{}],\n\"seed\": 1, \"seed\": 1}", "seed (line 3): got given twice, allowed given once"},
        {R"({"generations": 3})", "grid: got none of them, allowed one of grid, list, latin_hypercube"},
        {"{\"list\": [{}],\n\"grid\": {\"food_count\": [1]}}", "grid (line 2): got list and grid, allowed one of grid"},
        {R"({"parameters": {"food_count": [1]}})", "parameters (line 1): unknown name; did you mean grid?"},
        {R"({"food_count": [1]})", "food_count (line 1): unknown name; did you mean grid.food_count?"},
        {R"({"list": [{}], "replicates": 0})", "replicates (line 1): got 0, allowed a whole number, 1 to 100000"},
        {R"({"list": [{}], "replicates": 2.5})", "replicates (line 1): got 2.5"},
        {R"({"list": [{}], "seed": -1})", "seed (line 1): got -1, allowed a whole number, 0 to 18446744073709551615"},
        {R"({"list": [{}], "generations": 0})", "generations (line 1): got 0, allowed a whole number, 1 to"},
        {R"({"list": [{}], "description": 1})", "description (line 1): got 1, allowed a text"},
        {R"({"list": [{}], "experiment": 1})", "experiment (line 1): got 1, allowed the path"},
        {"{\"list\": [{}],\n\"experiment\": {\"food_count\": 1,\n\"survivors\": 2}}",
         "experiment.survivors (line 3): got 2, allowed 0 to 1"},
        {R"({"grid": {}})", "grid (line 1): got {}, allowed an object"},
        {R"({"grid": []})", "grid (line 1): got [], allowed an object"},
        {"{\"grid\": {\n\"mutation_chanse\": [1]}}", "grid.mutation_chanse (line 2): unknown name; did you mean "
                                                     "mutation_chance"},
        {"{\"grid\": {\"mutation_chance\": [0.5,\n1.5]}}", "grid.mutation_chance[1] (line 2): got 1.5, allowed 0 to 1"},
        {R"({"grid": {"mutation_chance": [null]}})", "mutation_chance[0] (line 1): got null, allowed a number"},
        {R"({"grid": {"mutation_chance": []}})", "grid.mutation_chance (line 1): got [], allowed a list of values"},
        {R"({"grid": {"mutation_step": [5, 5.0]}})", "mutation_step[1] (line 1): got 5.0, allowed each value once"},
        {R"({"grid": {"selection": ["luck"]}})", "grid.selection[0] (line 1): got luck, allowed roulette"},
        {R"({"grid": {"selection": {"from": 0, "to": 1, "steps": 2}}})", "grid.selection (line 1): got {\"from\""},
        {R"({"grid": {"food_count": {"from": 1, "to": 2}}})", "food_count (line 1): got no steps, allowed from"},
        {R"({"grid": {"food_count": {"from": 1, "to": 2, "steps": 1}}})",
         "food_count.steps (line 1): got 1, allowed a"},
        {R"({"grid": {"food_count": {"from": 1, "to": 2.5, "steps": 2}}})", "food_count.to (line 1): got 2.5, allowed"},
        {R"({"grid": {"food_count": {"from": 2, "to": 2, "steps": 2}}})", "allowed a \"from\" less than \"to\""},
        {R"({"grid": {"food_count": {"from": 0, "to": 2, "steps": 2, "scale": "log"}}})",
         "above 0, at least 2.3e-308, if the scale is log"},
        {R"({"grid": {"mutation_chance": {"from": 5e-324, "to": 0.5, "steps": 3, "scale": "log"}}})",
         "above 0, at least 2.3e-308, if the scale is log"},
        {R"({"grid": {"food_count": {"from": 1, "to": 2, "steps": 2, "scale": "x"}}})",
         "scale (line 1): got \"x\", allowed"},
        {R"({"grid": {"food_count": {"from": 1, "to": 2, "step": 2}}})", "food_count.step (line 1): unknown name"},
        {R"({"list": []})", "list (line 1): got [], allowed a list of at least one object with parameter values"},
        {R"({"list": [1]})", "list (line 1): got [1]"},
        {"{\"list\": [{},\n{\"food\": 1}]}", "list[1].food (line 2): unknown name"},
        {R"({"list": [{"survivors": 7}]})", "list[0].survivors (line 1): got 7, allowed 0 to 1"},
        {R"({"list": [{"survivors": 1, "survivors": 0}]})", "list[0].survivors (line 1): got given twice"},
        {R"({"latin_hypercube": {"samples": 4}})", "latin_hypercube (line 1): got no parameters"},
        {R"({"latin_hypercube": {"samples": 0, "parameters": {}}})", "latin_hypercube.samples (line 1): got 0"},
        {R"({"latin_hypercube": {"samples": 1, "parameters": {}}})", "latin_hypercube.parameters (line 1): got {}"},
        {R"({"latin_hypercube": {"samples": 1, "parameters": {"survivors": {"from": 0, "to": 1, "steps": 3}}}})",
         "latin_hypercube.parameters.survivors.steps (line 1): unknown name, allowed from, to, scale"},
        {R"({"list": [{"generation_limit": 3}], "generations": 2})", "generations: got 2, allowed no value if"},
    };
    for (const auto& [text, words] : wrong) {
        EXPECT_THAT(refusal_of(text), HasSubstr(words)) << text;
    }
    // All errors are reported at once.
    const std::string all = refusal_of(R"({"grid": {"survivors": [2], "luck": [1]}, "replicates": 0, "seed": "x"})");
    for (const char* field : {"grid.survivors[0]", "grid.luck", "replicates", "seed"}) {
        EXPECT_THAT(all, HasSubstr(field));
    }
}

TEST(SweepFile, InvalidJsonIsReportedWithItsLine) {
    EXPECT_THAT(refusal_of("{\n\"list\": [{}]\n\"seed\": 1}"), HasSubstr("not JSON: line 3"));
    EXPECT_THAT(refusal_of(""), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of("{} {}"), HasSubstr("not JSON"));
    EXPECT_THAT(refusal_of("[]"), HasSubstr("expected a JSON object"));
}

TEST(SweepFile, ContradictoryValuesAreNamedWithTheirCell) {
    const std::string said =
        refusal_of(R"({"generations": 1, "grid": {"tournament_size": [2, 5], "tournament_winners": [1, 3]}})");
    EXPECT_THAT(
        said, HasSubstr("cell 1 (tournament_size 2, tournament_winners 3): tournament_size: got 2, allowed at least"));
    for (const char* good : {"cell 0", "cell 2", "cell 3"}) {
        EXPECT_THAT(said, Not(HasSubstr(good)));
    }
    const std::string many = refusal_of(R"({"generations": 1, "experiment": {"tournament_size": 300}, "grid":
        {"tournament_winners": {"from": 301, "to": 1000, "steps": 700}}})");
    EXPECT_THAT(many, HasSubstr("700 errors; the first 100 are"));
    EXPECT_EQ(std::ranges::count(many, '\n'), static_cast<std::ptrdiff_t>(violations_max));
}

TEST(SweepFile, ARunWithoutAnEndIsRefused) {
    EXPECT_THAT(refusal_of(R"({"list": [{}, {"food_count": 1}]})"),
                HasSubstr("generations: got nothing, allowed a criterion that ends a run"));
    EXPECT_THAT(refusal_of(R"({"list": [{"stagnation_limit": 5}, {"food_count": 1}]})"),
                HasSubstr("cell 1 (stagnation_limit 0, food_count 1): generation_limit: got nothing"));
    for (const char* criterion : {R"("generation_limit": 1)", R"("stagnation_limit": 1)",
                                  R"("stop_at_extinction": true)", R"("stop_at_target_fitness": true)"}) {
        sweep_of(std::string{R"({"list": [{}], "experiment": {)"} + criterion + "}}");
    }
}

TEST(SweepFile, HasAtMostAHundredThousandRuns) {
    const auto grid = [](const std::string& replicates) {
        return R"({"generations": 1, "replicates": )" + replicates + R"(, "grid": {
            "survivors": {"from": 0, "to": 1, "steps": 100}, "mutation_chance": {"from": 0, "to": 1, "steps": 100}}})";
    };
    EXPECT_EQ(sweep_of(grid("10")).run_count(), Sweep::runs_max);
    EXPECT_THAT(refusal_of(grid("11")), HasSubstr("allowed at most 100000 runs"));
    EXPECT_THAT(refusal_of(R"({"generations": 1, "replicates": 2, "latin_hypercube": {"samples": 100000, "parameters":
        {"survivors": {"from": 0, "to": 1}}}})"),
                HasSubstr("got 100000 cells of 2 replicates, allowed at most 100000 runs"));
    // The number of cells exceeds 64 bits.
    std::string huge = R"({"generations": 1, "grid": {)";
    for (const char* name : {"survivors", "mutation_chance", "crossover_chance", "rearrange_chance", "reset_chance"}) {
        huge += std::string{huge.back() == '{' ? "\"" : ", \""} + name + R"(": {"from": 0, "to": 1, "steps": 99999})";
    }
    EXPECT_THAT(refusal_of(huge + "}}"), HasSubstr("allowed at most 100000 runs"));
}

TEST(SweepFile, TheExamplesAreValid) {
    const auto sweep = load_sweep(EVOD_SOURCE_FOLDER "/experiments/sweeps/mutation.json");
    ASSERT_TRUE(sweep) << to_text(sweep.error());
    EXPECT_EQ(sweep->run_count(), 64u);
}

} // namespace
} // namespace evod::experiments
