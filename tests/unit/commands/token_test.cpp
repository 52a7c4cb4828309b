#include "server/access/token_file.h"
#include "tests/unit/commands/program.h"
#include "tests/unit/recording/recorded_run.h"

#include <gmock/gmock.h>

namespace evod::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Token : public testing::Test {
  protected:
    Ended token(std::vector<std::string> words) const {
        words.insert(words.begin(), "token");
        words.insert(words.end(), {"--data", folder.path()});
        return run_command(add_token_command, std::move(words));
    }

    const recording::TemporaryFolder folder;
};

TEST_F(Token, AddPrintsOnlyTheSecretToStdout) {
    const Ended ended = token({"add", "anna", "--role", "controller"});
    EXPECT_EQ(ended.status, 0);
    ASSERT_THAT(ended.output, testing::EndsWith("\n"));
    const std::string secret = ended.output.substr(0, ended.output.size() - 1);
    EXPECT_EQ(secret.find_first_of(" \n"), std::string::npos);
    EXPECT_THAT(ended.errors, AllOf(HasSubstr("anna, role controller"), HasSubstr("EVOD_TOKEN")));
    const auto tokens = access::read_tokens(folder.path());
    ASSERT_TRUE(tokens) << to_text(tokens.error());
    const access::Token* found = access::find(*tokens, access::digest_of(secret));
    ASSERT_NE(found, nullptr);
    EXPECT_EQ(found->name, "anna");
    EXPECT_EQ(found->role, access::Role::Controller);
}

TEST_F(Token, ListsNamesAndRolesButNoSecrets) {
    const Ended empty = token({"list"});
    EXPECT_EQ(empty.status, 0);
    EXPECT_THAT(empty.errors, HasSubstr("there are no tokens in " + folder.path()));
    const std::string secret = token({"add", "anna", "--role", "viewer"}).output;
    ASSERT_FALSE(secret.empty());
    const Ended ended = token({"list"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.errors, "");
    EXPECT_THAT(ended.output, AllOf(HasSubstr("NAME "), HasSubstr("\nanna "), HasSubstr(" viewer ")));
    EXPECT_EQ(ended.output.find(secret.substr(0, secret.size() - 1)), std::string::npos);
}

TEST_F(Token, RevokedOnesAreGone) {
    token({"add", "anna", "--role", "viewer"});
    EXPECT_EQ(token({"revoke", "anna"}).status, 0);
    EXPECT_TRUE(access::read_tokens(folder.path())->empty());
    const Ended again = token({"revoke", "anna"});
    EXPECT_EQ(again.status, 1);
    EXPECT_THAT(again.errors, AllOf(HasSubstr("evod: "), HasSubstr("anna")));
}

TEST_F(Token, WrongNamesAndRolesAreRefused) {
    EXPECT_EQ(token({"add", "a b", "--role", "viewer"}).status, 1);
    EXPECT_EQ(token({"add", "anna", "--role", "owner"}).status, command_line::exit_usage);
    EXPECT_EQ(token({"add", "anna"}).status, command_line::exit_usage) << "a role is required";
    EXPECT_EQ(token({}).status, command_line::exit_usage) << "a subcommand is required";
    EXPECT_TRUE(access::read_tokens(folder.path())->empty());
}

} // namespace
} // namespace evod::commands
