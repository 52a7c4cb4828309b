#include "tests/unit/commands/program.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace evod::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SweepCommand : public testing::Test {
  protected:
    SweepCommand() {
        std::ofstream{path} << R"({"experiment": )" << small_experiment
                            << R"(, "grid": {"food_count": [5, 9]}, "replicates": 2, "generations": 1, "seed": 4})";
    }
    Ended sweep(std::vector<std::string> words) const {
        words.insert(words.begin(), {"sweep", path, "--out", out});
        return run_command(add_sweep_command, std::move(words));
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/sweep.json", out = folder.path() + "/out";
};

TEST_F(SweepCommand, ADryRunPrintsCellsAndWritesNothing) {
    const Ended ended = sweep({"--dry-run"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output, AllOf(HasSubstr("2 cells of 2 replicates, 4 runs, seed 4\n"),
                                    HasSubstr("\ncell\tfood_count\n0\t5\n1\t9\n")));
    EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(SweepCommand, PrintsWhatProgramsNeedAsJson) {
    const Ended plan = sweep({"--dry-run", "--json"});
    EXPECT_EQ(plan.status, 0) << plan.errors;
    EXPECT_THAT(plan.output,
                AllOf(HasSubstr(R"({"evod":")"), HasSubstr(R"("model":)"), HasSubstr(R"("seed":4,"seeds":[)"),
                      HasSubstr(R"("parameters":["food_count"],"cells":[["5"],["9"]]})")));
    std::filesystem::create_directory(out);
    const Ended early = sweep({"--gather", "--json"});
    EXPECT_EQ(early.status, 0) << early.errors;
    EXPECT_THAT(early.output, AllOf(HasSubstr(R"({"missing":[{"run":0,"cell":0,"replicate":0,"seed":)"),
                                    HasSubstr(out + "/parts/cell-1-replicate-1.csv")));
    for (const std::string run : {"0", "1", "2", "3"}) {
        const std::string part = out + "/parts/cell-" + std::to_string(std::stoi(run) / 2) + "-replicate-" +
                                 std::to_string(std::stoi(run) % 2) + ".csv";
        const Ended ended = run_command(add_sweep_command, {"sweep", path, "--run", run, "--part", part, "--json"});
        EXPECT_EQ(ended.status, 0) << ended.errors;
        EXPECT_THAT(ended.output,
                    AllOf(HasSubstr("{\"run\":" + run + ","), HasSubstr(R"("outcome":"generation_limit","rows":1})")));
    }
    EXPECT_THAT(sweep({"--gather", "--json"}).output,
                HasSubstr(R"("rows":4,"outcomes":{"generation_limit":4},"missing":[]})"));
    const std::string table = contents_of(out + "/runs.csv");
    std::filesystem::remove_all(out);
    const Ended whole = sweep({"--jobs", "1", "--json"});
    EXPECT_THAT(whole.output, AllOf(HasSubstr("{\"progress\":"), HasSubstr(R"("missing":[]})")));
    EXPECT_EQ(contents_of(out + "/runs.csv"), table);
    EXPECT_THAT(run_command(add_sweep_command, {"sweep", path, "--run", "4", "--part", out}).errors,
                HasSubstr("--run: got 4, allowed 0 to 3"));
}

TEST_F(SweepCommand, RunsWhatIsMissing) {
    const Ended ended = sweep({"--jobs", "1"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output, AllOf(HasSubstr("4 runs in "), HasSubstr("4 rows; runs by outcome: generation_limit 4")));
    const std::string table = contents_of(out + "/runs.csv");
    EXPECT_THAT(table, AllOf(HasSubstr("\n0,0,"), HasSubstr("\n0,1,"), HasSubstr("\n1,0,"), HasSubstr("\n1,1,")));
    const Ended again = sweep({"--jobs", "1"});
    EXPECT_EQ(again.status, 0) << again.errors;
    EXPECT_THAT(again.output, HasSubstr("4 finished before"));
    EXPECT_EQ(contents_of(out + "/runs.csv"), table);
}

TEST_F(SweepCommand, GatherNamesTheMissingRuns) {
    const Ended early = sweep({"--gather"});
    EXPECT_EQ(early.status, 1);
    EXPECT_THAT(early.errors, HasSubstr(out + ": no such folder"));
    ASSERT_EQ(sweep({"--array-index", "1", "--jobs", "1"}).status, 0);
    const Ended missing = sweep({"--gather"});
    EXPECT_EQ(missing.status, 1);
    EXPECT_THAT(missing.errors, HasSubstr("2 of 4 runs are missing: cell-0-replicate-0, cell-0-replicate-1\n"));
    ASSERT_EQ(sweep({"--array-index", "0", "--jobs", "1"}).status, 0);
    EXPECT_EQ(sweep({"--gather"}).status, 0);
}

TEST_F(SweepCommand, ACellOutOfRangeIsNamed) {
    const Ended ended = sweep({"--array-index", "2"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, HasSubstr("--array-index: got 2, allowed 0 to 1"));
    EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(SweepCommand, OptionsThatContradictAreRejected) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"--gather", "--jobs", "2"},
                                                  {"--gather", "--run-files"},
                                                  {"--gather", "--array-index", "0"},
                                                  {"--dry-run", "--gather"},
                                                  {"--dry-run", "--run-files"},
                                                  {"--jobs", "0"}}) {
        EXPECT_EQ(sweep(words).status, command_line::exit_usage) << words[0] << " " << words[1];
    }
}

} // namespace
} // namespace evod::commands
