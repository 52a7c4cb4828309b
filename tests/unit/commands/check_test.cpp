#include "tests/unit/commands/program.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Check : public testing::Test {
  protected:
    Ended check(const std::string& text) const {
        std::ofstream{path} << text;
        return run_command(add_check_command, {"check", path});
    }

    const recording::TemporaryFolder folder;
    const std::string path = folder.path() + "/experiment.json";
};

TEST_F(Check, PrintsWhatTheFileChanges) {
    const Ended ended = check(R"({"description": "A test.", "population_size": 4, "food_count": 60})");
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.errors, "");
    EXPECT_THAT(ended.output, AllOf(HasSubstr(path + ": valid\nA test.\n"), HasSubstr("\"population_size\": 4")));
    EXPECT_THAT(ended.output, Not(HasSubstr("tick_s")));
}

TEST_F(Check, ReportsThatTheFileChangesNothing) {
    const Ended ended = check("{}");
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.output, path + ": valid\nEvery parameter has its default.\n");
}

TEST_F(Check, NamesFileAndFieldOfAnError) {
    const Ended ended = check(R"({"mutation_chance": 1.5})");
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(ended.output, "");
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("evod: " + path), HasSubstr("mutation_chance"), HasSubstr("1.5")));
}

TEST_F(Check, ComparesTheIntegratorsWithTheExactSolution) {
    const Ended ended = run_command(add_check_command, {"check", "--integrators"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.errors, "");
    EXPECT_THAT(ended.output, HasSubstr("Exact: position ½at² = 5.760 m, speed at = 4.800 m/s\n"));
    EXPECT_THAT(ended.output, HasSubstr("\n0.80       3      3.840   -1.920      7.680   +1.920    4.800\n"
                                        "0.40       6      4.800   -0.960      6.720   +0.960    4.800\n"
                                        "0.20      12      5.280   -0.480      6.240   +0.480    4.800\n"
                                        "0.10      24      5.520   -0.240      6.000   +0.240    4.800\n"
                                        "0.05      48      5.640   -0.120      5.880   +0.120    4.800\n"));
}

TEST_F(Check, TakesAFileOrTheIntegratorsNotBoth) {
    std::ofstream{path} << "{}";
    const Ended ended = run_command(add_check_command, {"check", "--integrators", path});
    EXPECT_EQ(ended.status, command_line::exit_usage);
    EXPECT_EQ(ended.output, "");
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("--integrators"), HasSubstr("experiment")));
}

TEST_F(Check, NeedsAFile) {
    const Ended nothing = run_command(add_check_command, {"check"});
    EXPECT_EQ(nothing.status, command_line::exit_usage);
    EXPECT_THAT(nothing.errors, HasSubstr("experiment: required unless --integrators is given"));
    const Ended ended = run_command(add_check_command, {"check", folder.path() + "/none.json"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, HasSubstr("/none.json"));
}

} // namespace
} // namespace evod::commands
