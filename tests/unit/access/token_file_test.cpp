#include "server/access/token_file.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include <sys/stat.h>

namespace evod::access {
namespace {

using base::RefusalCode;
using testing::HasSubstr;

TEST(TokenFile, ATokenIsFoundByItsSecretOnly) {
    const support::TemporaryFolder folder;
    const auto anna = add_token(folder.path(), "anna", Role::Viewer),
               karl = add_token(folder.path(), "karl", Role::Admin);
    ASSERT_TRUE(anna && karl);
    const auto tokens = read_tokens(folder.path());
    ASSERT_TRUE(tokens) << to_text(tokens.error());
    ASSERT_EQ(tokens->size(), 2u);
    EXPECT_EQ(find(*tokens, digest_of(*anna))->name, "anna");
    EXPECT_EQ(find(*tokens, digest_of(*karl))->role, Role::Admin);
    EXPECT_EQ(find(*tokens, digest_of("anna")), nullptr);
    EXPECT_EQ(find(*tokens, digest_of("")), nullptr);
    EXPECT_EQ(*parse_tokens(to_text(*tokens)), *tokens);
}

TEST(TokenFile, NamesAreUniqueAndRevokedOnesFree) {
    const support::TemporaryFolder folder;
    ASSERT_TRUE(add_token(folder.path(), "anna", Role::Viewer));
    EXPECT_EQ(add_token(folder.path(), "anna", Role::Admin).error().code, RefusalCode::AlreadyExists);
    ASSERT_TRUE(revoke_token(folder.path(), "anna"));
    EXPECT_TRUE(read_tokens(folder.path())->empty());
    EXPECT_EQ(revoke_token(folder.path(), "anna").error().code, RefusalCode::NotFound);
    for (const char* name : {"", "a b", "a\n", "\xc3\xa4", "a/b"}) {
        EXPECT_EQ(add_token(folder.path(), name, Role::Viewer).error().code, RefusalCode::InvalidArgument) << name;
    }
}

TEST(TokenFile, IsRefusedIfOtherUsersHaveAccess) {
    const support::TemporaryFolder folder;
    ASSERT_TRUE(add_token(folder.path(), "anna", Role::Viewer));
    const std::string path = token_file_of(folder.path());
    for (const mode_t mode : {0640, 0604, 0660, 0601}) {
        ASSERT_EQ(::chmod(path.c_str(), mode), 0);
        EXPECT_EQ(read_tokens(folder.path()).error().code, RefusalCode::FailedPrecondition);
    }
    ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
    std::filesystem::rename(path, path + "2");
    std::filesystem::create_symlink(path + "2", path);
    EXPECT_FALSE(read_tokens(folder.path()));
}

TEST(TokenFile, ARefusalNamesTheInvalidLine) {
    const std::string digest(64, 'a');
    const auto wrong = [](const std::string& text) {
        const auto tokens = parse_tokens(text);
        return tokens ? "nothing" : tokens.error().message;
    };
    const std::string head = "# evod tokens 1\n", good = "anna viewer " + digest + " 2026-11-22\n";
    EXPECT_EQ(wrong(head), "nothing");
    EXPECT_EQ(wrong(head + good), "nothing");
    EXPECT_THAT(wrong(""), HasSubstr("line 1"));
    EXPECT_THAT(wrong("# evod tokens 2\n"), HasSubstr("line 1"));
    EXPECT_THAT(wrong(head + good + good), HasSubstr("line 3"));
    for (const std::string& line :
         {std::string{"\n"}, "anna viewer " + digest + "\n", "anna boss " + digest + " 2026-11-22\n",
          "anna viewer " + digest.substr(1) + " 2026-11-22\n", "anna viewer " + digest + " 2026-11-22 x\n",
          "an/na viewer " + digest + " 2026-11-22\n", "anna viewer " + digest + " 2026-11-22"}) {
        EXPECT_THAT(wrong(head + line), HasSubstr("line 2")) << line;
    }
}

} // namespace
} // namespace evod::access
