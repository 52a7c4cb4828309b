#include "client/core/credentials.h"

#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace evod::core {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class CredentialsTest : public testing::Test {
  protected:
    CredentialsTest() { ::unsetenv("EVOD_TOKEN"); }

    void write_token(const std::string& text, fs::perms permissions = fs::perms::owner_read | fs::perms::owner_write) {
        credentials.token_file = folder + "/token";
        std::ofstream{credentials.token_file} << text;
        fs::permissions(credentials.token_file, permissions);
    }
    std::string refusal() {
        const auto applied = apply(credentials, options);
        EXPECT_FALSE(applied);
        return applied ? "" : applied.error().what;
    }

    support::TemporaryFolder temporary;
    const std::string& folder = temporary.path();
    Credentials credentials;
    Options options;
};

TEST_F(CredentialsTest, TheTokenComesFromFileOrEnvironment) {
    ASSERT_TRUE(apply(credentials, options));
    EXPECT_EQ(options.token, "");
    ::setenv("EVOD_TOKEN", "evod_environment", 1);
    ASSERT_TRUE(apply(credentials, options));
    EXPECT_EQ(options.token, "evod_environment");
    write_token("evod_file\n");
    ASSERT_TRUE(apply(credentials, options)) << "the file takes precedence";
    EXPECT_EQ(options.token, "evod_file");
    ::unsetenv("EVOD_TOKEN");
}

TEST_F(CredentialsTest, ATokenFileMustBePrivateAndHoldAToken) {
    for (const fs::perms others : {fs::perms::group_read, fs::perms::others_read, fs::perms::others_write}) {
        write_token("evod_file\n", fs::perms::owner_read | others);
        EXPECT_THAT(refusal(),
                    HasSubstr("--token-file: " + credentials.token_file + ": other users can read the file"));
    }
    fs::remove(credentials.token_file);
    write_token(" \n");
    EXPECT_THAT(refusal(), HasSubstr("the file contains no token"));
    credentials.token_file = folder + "/none";
    EXPECT_THAT(refusal(), HasSubstr("/none: cannot be read: No such file"));
}

TEST_F(CredentialsTest, AnyFileOfTlsAsksForTls) {
    ASSERT_TRUE(apply(credentials, options));
    EXPECT_FALSE(options.tls);
    for (Credentials wanted :
         {Credentials{.token_file = {}, .tls = true, .files = {}},
          Credentials{.token_file = {}, .tls = false, .files = {.ca = "ca", .certificate = {}, .key = {}}},
          Credentials{.token_file = {}, .tls = false, .files = {.ca = {}, .certificate = "crt", .key = "key"}}}) {
        Options asked;
        ASSERT_TRUE(apply(wanted, asked));
        ASSERT_TRUE(asked.tls);
        EXPECT_EQ(asked.tls->ca, wanted.files.ca);
        EXPECT_EQ(asked.tls->key, wanted.files.key);
    }
}

TEST_F(CredentialsTest, AKeyNeedsItsCertificate) {
    credentials.files.key = "evod.key";
    EXPECT_THAT(refusal(), HasSubstr("--key: evod.key requires the certificate of this key: give --cert too"));
}

} // namespace
} // namespace evod::core
