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
    EXPECT_THAT(program.err, HasSubstr("lab: COMMAND: got nothing, allowed run, token\nSee lab --help\n"));
    EXPECT_EQ(program.call({"token"}), exit_usage);
    program.app.action([&] { program.ran = "lab"; });
    EXPECT_EQ(program.call({}), 0);
    EXPECT_EQ(program.ran, "lab");
}

TEST(Command, ListsItsSubcommandsAfterAnUnknownOne) {
    Program program;
    program.app.action([] {});
    EXPECT_EQ(program.call({"walk"}), exit_usage);
    EXPECT_EQ(program.err, "lab: walk: unknown command; commands are run, token\nSee lab --help\n");
    EXPECT_EQ(program.call({"tokn", "--any", "list"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("lab: tokn: unknown command; did you mean token?\n"));
}

TEST(Command, PrintsHelpAndVersionWithStatusZero) {
    Program program;
    for (const char* option : {"--version", "-V"}) {
        EXPECT_EQ(program.call({option}), 0);
        EXPECT_EQ(program.out, "lab 1.2\n");
    }
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

TEST(Command, DescribesItsOptionsAndSubcommands) {
    Command app{"lab", "A laboratory.", "lab 1.2"};
    std::uint16_t port = 7;
    std::vector<std::string> words;
    std::string format;
    app.option_group("Listening");
    app.add_option("--port", &port, "Port").show_default().environment("LAB_PORT");
    app.option_group("Output");
    app.add_option("--format", &format, "Format").choices({"csv", "jsonl"}).required();
    app.add_option("NAME", &words, "Names");
    const auto options = app.options();
    ASSERT_EQ(options.size(), 5u);
    EXPECT_THAT(options[0].names, ElementsAre("-h", "--help"));
    EXPECT_THAT(options[1].names, ElementsAre("-V", "--version"));
    EXPECT_EQ(options[1].value, "");
    EXPECT_EQ(options[2].value, "NUMBER");
    EXPECT_EQ(options[2].default_value, "7");
    EXPECT_EQ(options[2].environment, "LAB_PORT");
    EXPECT_EQ(options[2].group, "Listening");
    EXPECT_THAT(options[3].choices, ElementsAre("csv", "jsonl"));
    EXPECT_TRUE(options[3].is_required);
    EXPECT_EQ(options[4].positional, "NAME");
    EXPECT_TRUE(options[4].is_list);

    const Program program;
    ASSERT_EQ(program.app.commands().size(), 2u);
    EXPECT_EQ(program.app.command("token")->help(), "Tokens.");
    EXPECT_EQ(program.app.command("walk"), nullptr);
}

TEST(Command, GroupsTheOptionsInItsHelp) {
    Command app{"lab", "A laboratory.", "1"};
    bool fast = false, loud = false;
    app.add_flag("--fast", &fast, "Speed");
    app.option_group("Noise");
    app.add_flag("--loud", &loud, std::string(80, 'x') + " " + std::string(80, 'y'));
    const std::string help = app.help_text();
    EXPECT_THAT(help, testing::ContainsRegex("Options:\n(.+\n)+\nNoise:\n  --loud +x+\n +y+\n"));
}

TEST(Command, ASubcommandHasAFooterOfItsOwn) {
    Program program;
    program.app.footer("Only for the laboratory.");
    program.app.add_command("walk", "Walks.");
    EXPECT_EQ(program.app.command("walk")->footer(), "");
}

TEST(Command, RejectsAsParseDoes) {
    const Program program;
    testing::internal::CaptureStderr();
    EXPECT_EQ(program.app.reject("--size: too large"), exit_usage);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "lab: --size: too large\nSee lab --help\n");
}

TEST(Option, RejectsWhatItsCheckRejects) {
    Program program;
    EXPECT_EQ(program.call({"--seed", "10", "run"}), exit_usage);
    EXPECT_THAT(program.err, HasSubstr("lab: --seed: got 10, allowed a whole number, 1 to 9\n"));
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
