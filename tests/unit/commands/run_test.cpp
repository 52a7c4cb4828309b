#include "tests/unit/commands/program.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace evod::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Run : public testing::Test {
  protected:
    Run() { std::ofstream{path} << small_experiment; }
    Ended run(std::vector<std::string> words, const std::string& threads = "1") const {
        words.insert(words.begin(), {"run", path, "--threads", threads});
        return run_command(add_run_command, std::move(words));
    }
    /// The hash in the summary.
    static std::string state_of(const Ended& ended) {
        const std::size_t at = ended.output.find("; state ");
        return at == std::string::npos ? "" : ended.output.substr(at, ended.output.find('\n', at) - at);
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/small.json";
};

TEST_F(Run, EndsAtTheGenerationLimit) {
    const Ended ended = run({"--seed", "3", "--generations", "2"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_EQ(ended.errors, "");
    EXPECT_THAT(ended.output, AllOf(testing::StartsWith("seed 3\n"),
                                    HasSubstr("\nended: generation_limit was reached\n2 generations, ")));
}

TEST_F(Run, PrintsItsResultAsJson) {
    const Ended ended = run({"--seed", "3", "--generations", "2", "--json"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_EQ(std::ranges::count(ended.output, '\n'), 1) << ended.output;
    EXPECT_THAT(ended.output,
                testing::StartsWith(R"({"seed":3,"outcome":"generation_limit","generations":2,"ticks":)"));
    for (const char* member :
         {"simulated_s", "state_hash", "start_s", "tick_s", "turnover_s", "exchange_s", "organism_ticks"}) {
        EXPECT_THAT(ended.output, HasSubstr(",\"" + std::string{member} + "\":"));
    }
}

TEST_F(Run, TheSeedDecidesTheResult) {
    const std::string first = state_of(run({"--seed", "3", "--generations", "1"}));
    EXPECT_NE(first, "");
    EXPECT_EQ(state_of(run({"--seed", "3", "--generations", "1"}, "2")), first);
    EXPECT_NE(state_of(run({"--seed", "4", "--generations", "1"})), first);
    std::ofstream{path} << R"({"seed": 3, )" + std::string{small_experiment}.substr(1);
    EXPECT_EQ(state_of(run({"--generations", "1"})), first) << "the seed of the file";
}

TEST_F(Run, StagnationHasAStatusOfItsOwn) {
    const Ended ended = run({"--seed", "3", "--set", "stagnation_limit=1", "--set", "mutation_chance=0", "--set",
                             "crossover_chance=0", "--generations", "0"});
    EXPECT_EQ(ended.status, 3) << ended.errors;
    EXPECT_THAT(ended.output, HasSubstr("ended: the best fitness did not improve"));
}

TEST_F(Run, WritesARowPerGeneration) {
    const std::string csv = folder.path() + "/statistics.csv";
    ASSERT_EQ(run({"--seed", "3", "--generations", "3", "--csv", csv}).status, 0);
    const std::string text = contents_of(csv);
    EXPECT_EQ(std::ranges::count(text, '\n'), 1 + 3);
    EXPECT_THAT(text, testing::StartsWith("generation,"));
    EXPECT_THAT(text, HasSubstr("\n3,0,"));
}

TEST_F(Run, InvalidValuesAreNamedByTheirOption) {
    const Ended ended = run({"--set", "mutation_chance=1.5", "--set", "food_count", "--set", "no_such=1"});
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.output, "");
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("evod: "), HasSubstr("--set mutation_chance: got 1.5"),
                                    HasSubstr("--set: got food_count, allowed name=value"), HasSubstr("no_such")));
    EXPECT_EQ(run({"--generations", "4294967296"}).status, command_line::exit_usage);
    EXPECT_EQ(run({}, "0").status, command_line::exit_usage);
}

TEST_F(Run, FilesAreNamedByTheirOption) {
    const Ended csv = run({"--csv", "/nowhere/a.csv"});
    EXPECT_EQ(csv.status, 1);
    EXPECT_THAT(csv.errors, HasSubstr("--csv: cannot write /nowhere/a.csv"));
    EXPECT_THAT(csv.output, Not(HasSubstr("seed"))) << "it fails before the run";
    const Ended population = run({"--population", "/nowhere/a.csv"});
    EXPECT_EQ(population.status, 1);
    EXPECT_THAT(population.errors, AllOf(HasSubstr("--population: "), HasSubstr("/nowhere/a.csv")));
    const Ended experiment = run_command(add_run_command, {"run", "/nowhere/a.json"});
    EXPECT_EQ(experiment.status, 1);
    EXPECT_THAT(experiment.errors, HasSubstr("/nowhere/a.json"));
}

} // namespace
} // namespace evod::commands
