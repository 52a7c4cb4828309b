#include "proto/command_line/completion.h"

#include <gmock/gmock.h>

namespace evod::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A program with an option that its commands accept too, and commands with values of several kinds.
class Completion : public testing::Test {
  protected:
    Completion() {
        app_.add_option("--world", &text_, "World");
        app_.accept_options_after_commands();
        auto& write = app_.add_command("write", "Writes.");
        write.add_option("--format", &text_, "Format").choices({"csv", "jsonl"});
        write.add_option("--set", &texts_, "Parameters");
        write.add_flag("--fast", &flag_, "Fast");
        write.add_option("KIND", &text_, "Kind").choices({"table", "tree"});
        write.add_option("FILE", &text_, "File");
        app_.add_command("token", "Tokens.").add_command("add", "Adds.");
        add_help_commands(app_);
    }

    std::vector<std::string> texts(const std::vector<std::string>& words) {
        std::vector<std::string> texts;
        for (const Candidate& candidate : candidates(app_, words, [&](const IncompleteWord& word) {
                 asked_ = word;
                 return std::vector<Candidate>{{"known", "from the server"}};
             })) {
            texts.push_back(candidate.text);
        }
        return texts;
    }

    Command app_{"lab", "A laboratory.", "lab 1.2"};
    std::string text_;
    std::vector<std::string> texts_;
    bool flag_ = false;
    IncompleteWord asked_;
};

TEST_F(Completion, OffersCommandsAndTheirOptions) {
    EXPECT_THAT(texts({"w"}), ElementsAre("write"));
    EXPECT_THAT(texts({"token", "a"}), ElementsAre("add"));
    EXPECT_THAT(texts({"write", "--f"}), ElementsAre("--format", "--fast"));
    EXPECT_THAT(texts({"write", "--wor"}), ElementsAre("--world"));
    EXPECT_THAT(texts({"--f"}), ElementsAre());
    EXPECT_THAT(texts({"help", "wr"}), ElementsAre("write"));
    EXPECT_THAT(texts({"complete", ""}), ElementsAre("bash", "zsh", "fish", "known"));
}

TEST_F(Completion, OffersTheValuesOfAnOption) {
    EXPECT_THAT(texts({"write", "--format", "c"}), ElementsAre("csv"));
    EXPECT_THAT(texts({"write", "--format=j"}), ElementsAre("--format=jsonl"));
    EXPECT_THAT(texts({"write", "--format", "csv", "t"}), ElementsAre("table", "tree"));
    EXPECT_THAT(texts({"write", "--fast", "ta"}), ElementsAre("table"));
    EXPECT_THAT(texts({"write", "table", "t"}), ElementsAre());
}

TEST_F(Completion, AsksTheProgramForOtherValues) {
    EXPECT_THAT(texts({"write", "--set", "a=1", "kn"}), ElementsAre("known"));
    EXPECT_EQ(asked_.command, "write");
    EXPECT_EQ(asked_.option, "--set");
    EXPECT_EQ(asked_.word, "kn");
    EXPECT_THAT(texts({"--world", "write", "write", "--world", "k"}), ElementsAre("known"));
    EXPECT_EQ(asked_.command, "write");
    EXPECT_EQ(asked_.option, "--world");
    texts({"token", "add", "k"});
    EXPECT_EQ(asked_.command, "token add");
    EXPECT_EQ(asked_.option, "");
}

TEST_F(Completion, ScriptsNameTheProgram) {
    for (const std::string& shell : shells) {
        EXPECT_THAT(completion_script(shell, "lab"), HasSubstr("Completion of lab for " + shell));
        EXPECT_THAT(completion_script(shell, "lab"), Not(HasSubstr("PROGRAM")));
    }
}

TEST_F(Completion, HelpIsThatOfTheCommand) {
    for (const auto& [words, usage] : {std::pair{std::vector{"lab", "help"}, "Usage: lab [OPTIONS]"},
                                       std::pair{std::vector{"lab", "help", "token", "add"}, "Usage: lab token add"}}) {
        ASSERT_EQ(app_.parse(static_cast<int>(words.size()), words.data()), std::nullopt);
        testing::internal::CaptureStdout();
        EXPECT_EQ(app_.run(), 0);
        EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr(usage));
    }
    const char* const wrong[] = {"lab", "help", "wirte"};
    ASSERT_EQ(app_.parse(3, wrong), std::nullopt);
    testing::internal::CaptureStderr();
    EXPECT_EQ(app_.run(), exit_usage);
    EXPECT_THAT(testing::internal::GetCapturedStderr(),
                HasSubstr("lab: COMMAND: got wirte, allowed write, token, help, complete, man; did you mean write?\n"));
}

} // namespace
} // namespace evod::command_line
