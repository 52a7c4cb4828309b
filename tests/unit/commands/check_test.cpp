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

TEST_F(Check, NeedsAFile) {
    EXPECT_EQ(run_command(add_check_command, {"check"}).status, command_line::exit_usage);
    const Ended ended = run_command(add_check_command, {"check", folder.path() + "/none.json"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.errors, HasSubstr("/none.json"));
}

} // namespace
} // namespace evod::commands
