#include "tests/unit/commands/program.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

namespace evod::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Compare : public testing::Test {
  protected:
    Compare() {
        std::ofstream{path} << small_experiment;
        std::filesystem::copy(path, other);
    }
    Ended compare(std::vector<std::string> words) const {
        words.insert(words.begin(), "compare");
        return run_command(add_compare_command, std::move(words));
    }
    /// The fewest and shortest runs that can be compared.
    Ended compare_quickly(std::vector<std::string> words) const {
        words.insert(words.begin(), {path, other, "--replicates", "2", "--generations", "2", "--seed", "3"});
        return compare(std::move(words));
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/a.json", other = folder.path() + "/b.json",
                      csv = folder.path() + "/runs.csv";
};

TEST_F(Compare, PrintsTheRiseOfEveryWorld) {
    const Ended ended = compare_quickly({"--csv", csv, "--jobs", "1"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output, HasSubstr("2 replicates of 2 generations, from seed 3\nrise: mean fitness of generation "
                                        "2 minus that of generation 1\n"));
    EXPECT_THAT(ended.errors, HasSubstr("--replicates: fewer than 20 replicates can show only large differences"));
    const std::string runs = contents_of(csv);
    EXPECT_GT(std::ranges::count(runs, '\n'), 2 * 2 * 2) << runs;
    EXPECT_EQ(compare_quickly({"--jobs", "2"}).output, ended.output) << "any number of jobs gives the same result";
}

TEST_F(Compare, PrintsItsResultAsJson) {
    const Ended ended = compare_quickly({"--jobs", "1", "--json"});
    EXPECT_EQ(ended.status, 0) << ended.errors;
    EXPECT_THAT(ended.output,
                AllOf(HasSubstr(R"({"progress":)"),
                      HasSubstr(R"({"seed":3,"generations":2,"worlds":[{"name":"a","first":)"),
                      HasSubstr(R"(}],"not_run":[],"differences":[{"other":"b","difference":)"),
                      HasSubstr(R"(}],"conclusions":")"), HasSubstr(R"("report":"a: 2 replicates of 2 generations)")));
    for (const char* member :
         {"last", "rise", "rise_low", "rise_high", "extinct", "changes", "low", "high", "g", "p", "adjusted"}) {
        EXPECT_THAT(ended.output, HasSubstr(",\"" + std::string{member} + "\":"));
    }
}

TEST_F(Compare, FilesAreCheckedBeforeTheRuns) {
    const Ended ended = compare_quickly({"--csv", csv, "--plot", "/nowhere/plot.svg"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(ended.output, "");
    EXPECT_THAT(ended.errors, HasSubstr("--plot: cannot write /nowhere/plot.svg"));
    EXPECT_FALSE(std::filesystem::exists(csv)) << "the check leaves no file";
    std::ofstream{csv} << "before";
    EXPECT_THAT(compare_quickly({"--csv", csv, "--plot", "/nowhere/plot.svg"}).status, 1);
    EXPECT_EQ(contents_of(csv), "before");
}

TEST_F(Compare, TooFewOrTooManyAreRejected) {
    for (const std::vector<std::string>& words : {std::vector<std::string>{"--replicates", "1"},
                                                  {"--generations", "1"},
                                                  {"--replicates", "10001"},
                                                  {"--jobs", "0"},
                                                  {"--seed", "-1"},
                                                  std::vector<std::string>(13, path)}) {
        EXPECT_EQ(compare(words).status, command_line::exit_usage) << words[0] << " " << words[1];
    }
}

TEST_F(Compare, NamesTheFileThatCannotBeRead) {
    const Ended ended = compare({path, folder.path() + "/none.json"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("evod: "), HasSubstr("/none.json")));
}

} // namespace
} // namespace evod::commands
