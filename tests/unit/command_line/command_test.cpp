#include "proto/command_line/command.h"

#include "proto/command_line/number.h"

#include <gmock/gmock.h>

#include <cstdlib>

namespace evod::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A program with an option of its own and two commands.
struct Program {
    Command app{"lab", "A laboratory.", "lab 1.2"};
    std::optional<std::uint64_t> seed, run_seed;
    std::string ran, out, err;

    Program() {
        app.add_option("--seed", &seed, "Seed").check(WholeNumber{1, 9});
        auto& run = app.add_command("run", "Runs.");
        run.add_option("--seed", &run_seed, "Seed").check(WholeNumber{1, 9});
        run.action([this] { ran = "run"; });
        auto& token = app.add_command("token", "Tokens.");
        token.add_command("list", "Lists.").action([this] {
            ran = "token list";
            return 7;
        });
    }

    /// returns  the exit status.
    int call(std::vector<const char*> words) {
        words.insert(words.begin(), "lab");
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const auto ended = app.parse(static_cast<int>(words.size()), words.data());
        const int status = ended ? *ended : app.run();
        out = testing::internal::GetCapturedStdout();
        err = testing::internal::GetCapturedStderr();
        return status;
    }
};

TEST(Command, RunsTheCommandThatWasGiven) {
    Program program;
    EXPECT_EQ(program.call({"run", "--seed", "4"}), 0);
    EXPECT_EQ(program.ran, "run");
    EXPECT_EQ(program.run_seed, 4u);
    EXPECT_EQ(program.seed, std::nullopt);
    EXPECT_EQ(program.call({"token", "list"}), 7);
    EXPECT_EQ(program.ran, "token list");
}

TEST(Command, WithoutActionNeedsASubcommand) {
    Program program;
    EXPECT_EQ(program.call({}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("A subcommand is required"));
    EXPECT_EQ(program.call({"token"}), exit_usage);
    program.app.action([&] { program.ran = "lab"; });
    EXPECT_EQ(program.call({}), 0);
    EXPECT_EQ(program.ran, "lab");
}

TEST(Command, ListsItsSubcommandsAfterAnUnknownOne) {
    Program program;
    program.app.action([] {});
    EXPECT_EQ(program.call({"walk"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("not expected: walk"));
    EXPECT_THAT(program.err, HasSubstr("Commands are run token\n"));
}

TEST(Command, PrintsHelpAndVersionWithStatusZero) {
    Program program;
    EXPECT_EQ(program.call({"--version"}), 0);
    EXPECT_EQ(program.out, "lab 1.2\n");
    EXPECT_EQ(program.call({"run", "--help"}), 0);
    EXPECT_THAT(program.out, HasSubstr("Usage: lab run [OPTIONS]"));
    EXPECT_EQ(program.ran, "");
}

TEST(Command, HandsOptionsDownToTheSubcommand) {
    Program program;
    program.app.hand_options_down("the laboratory");
    EXPECT_EQ(program.call({"--seed", "4", "run"}), 0);
    EXPECT_EQ(program.run_seed, 4u);
    EXPECT_EQ(program.call({"--seed", "4", "run", "--seed", "5"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("--seed: given twice, before run and after it"));
    EXPECT_EQ(program.call({"--seed", "4", "token", "list"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("an option of the laboratory that lab token list does not use"));
}

TEST(Command, TakesOptionsAfterTheSubcommandIfAllowed) {
    Command app{"lab", "A laboratory.", "1"};
    std::string world;
    app.add_option("--world", &world, "World");
    app.accept_options_after_commands();
    app.add_command("run", "Runs.").action([] {});
    const char* const words[] = {"lab", "run", "--world", "calm"};
    EXPECT_EQ(app.parse(4, words), std::nullopt);
    EXPECT_EQ(world, "calm");
}

TEST(Command, NamesItsOptionsAndSubcommands) {
    const Program program;
    EXPECT_THAT(program.app.option_names(), ElementsAre("--help", "--version", "--seed"));
    ASSERT_EQ(program.app.commands().size(), 2u);
    EXPECT_EQ(program.app.commands().front().name(), "run");
}

TEST(Command, RejectsAsParseDoes) {
    const Program program;
    testing::internal::CaptureStderr();
    EXPECT_EQ(program.app.reject("--size: too large"), exit_usage);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "--size: too large\nRun with --help for more information.\n");
}

TEST(Option, RejectsWhatItsCheckRejects) {
    Program program;
    EXPECT_EQ(program.call({"--seed", "10", "run"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("--seed: must be a whole number, 1 to 9, not 10"));
}

TEST(Option, IsGivenByTheEnvironmentToo) {
    Program program;
    std::string server;
    const Option option = program.app.add_option("--server", &server, "Server").environment("LAB_SERVER");
    ::setenv("LAB_SERVER", "far", 1);
    EXPECT_EQ(program.call({"run"}), 0);
    ::unsetenv("LAB_SERVER");
    EXPECT_TRUE(option.is_given());
    EXPECT_EQ(server, "far");
}

} // namespace
} // namespace evod::command_line
