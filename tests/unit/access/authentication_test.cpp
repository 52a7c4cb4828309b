#include "server/access/authentication.h"

#include "server/access/certificate.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <openssl/pem.h>

#include <cstdio>
#include <filesystem>

namespace evod::access {
namespace {

using base::RefusalCode;
using std::chrono::milliseconds;

class AuthenticationTest : public testing::Test {
  protected:
    support::TemporaryFolder temporary;
    const std::string& folder = temporary.path();
    Authenticator::Clock::time_point now;
};

TEST_F(AuthenticationTest, ARequiredTokenMustExist) {
    EXPECT_EQ(Authenticator::open(folder, true).error().code, RefusalCode::FailedPrecondition);
    EXPECT_EQ(Authenticator::open(std::nullopt, true).error().code, RefusalCode::FailedPrecondition);
    auto authenticator = Authenticator::open(std::nullopt, false);
    ASSERT_TRUE(authenticator);
    EXPECT_EQ(authenticator->admit("", "a", now)->role, Role::Admin);
    EXPECT_EQ(authenticator->admit("evod_x", "a", now).error().code, RefusalCode::Unauthenticated);
}

TEST_F(AuthenticationTest, EachFailureDoublesTheWaitOfItsAddress) {
    const std::string secret = *add_token(folder, "anna", Role::Viewer);
    auto authenticator = *Authenticator::open(folder, true);
    milliseconds delay = Authenticator::delay_min;
    for (int failures = 1; failures <= 12; ++failures, delay = std::min(delay * 2, Authenticator::delay_max)) {
        EXPECT_EQ(authenticator.admit("wrong", "a", now).error().code, RefusalCode::Unauthenticated);
        now += delay - milliseconds{1};
        EXPECT_EQ(authenticator.admit("another", "a", now).error().code, RefusalCode::ResourceExhausted);
        EXPECT_EQ(authenticator.admit("", "a", now).error().code, RefusalCode::Unauthenticated) << "a token is missing";
        now += milliseconds{1};
    }
    EXPECT_EQ(authenticator.failed_login_count(), 12u);
    EXPECT_EQ(authenticator.admit(secret, "a", now)->name, "anna");
    // A successful login or a long time resets the wait.
    EXPECT_EQ(authenticator.admit("wrong", "a", now).error().code, RefusalCode::Unauthenticated);
    EXPECT_TRUE(authenticator.admit(secret, "a", now + Authenticator::delay_min));
}

TEST_F(AuthenticationTest, AKnownTokenIsAlwaysAdmitted) {
    const std::string secret = *add_token(folder, "anna", Role::Viewer);
    auto authenticator = *Authenticator::open(folder, true);
    for (int i = 0; i < 100; ++i, now += milliseconds{200}) { // a stale token behind the same NAT
        EXPECT_FALSE(authenticator.admit("stale", "a", now));
        EXPECT_TRUE(authenticator.admit(secret, "a", now));
    }
}

TEST_F(AuthenticationTest, AMissingTokenIsRefusedWithoutAWait) {
    const std::string secret = *add_token(folder, "anna", Role::Viewer);
    auto authenticator = *Authenticator::open(folder, true);
    EXPECT_EQ(authenticator.admit("", "a", now).error().code, RefusalCode::Unauthenticated);
    EXPECT_TRUE(authenticator.admit(secret, "a", now));
}

TEST_F(AuthenticationTest, TheOldestAddressesAreForgottenFirst) {
    auto authenticator = *Authenticator::open(folder, false);
    for (std::size_t i = 0; i < Authenticator::addresses_max + 1; ++i, now += std::chrono::microseconds{10}) {
        EXPECT_FALSE(authenticator.admit("wrong", std::to_string(i), now));
    }
    EXPECT_EQ(authenticator.admit("wrong", "0", now).error().code, RefusalCode::Unauthenticated); // forgotten
    EXPECT_EQ(authenticator.admit("wrong", "2", now).error().code, RefusalCode::ResourceExhausted);
}

TEST_F(AuthenticationTest, AChangedFileIsReadAgain) {
    const std::string anna = *add_token(folder, "anna", Role::Viewer), karl = *add_token(folder, "karl", Role::Admin);
    auto authenticator = *Authenticator::open(folder, true);
    const AuthenticatedUser user = *authenticator.admit(anna, "a", now);
    EXPECT_FALSE(authenticator.refresh());
    ASSERT_TRUE(revoke_token(folder, "anna"));
    EXPECT_TRUE(authenticator.refresh());
    EXPECT_FALSE(authenticator.is_still_valid(user));
    EXPECT_TRUE(authenticator.is_still_valid(*authenticator.admit(karl, "a", now)));
    // The name alone does not identify the token.
    ASSERT_TRUE(add_token(folder, "anna", Role::Viewer));
    EXPECT_TRUE(authenticator.refresh());
    EXPECT_FALSE(authenticator.is_still_valid(user));
    std::filesystem::permissions(token_file_of(folder), std::filesystem::perms::others_read,
                                 std::filesystem::perm_options::add);
    EXPECT_TRUE(authenticator.refresh());
    ASSERT_TRUE(authenticator.file_problem());
    EXPECT_EQ(authenticator.admit(karl, "a", now).error().code, RefusalCode::Unavailable);
}

TEST_F(AuthenticationTest, ACreatedCertificateCanBeLoaded) {
    for (int i = 0; i < 300; ++i) {
        ASSERT_TRUE(create_certificate({"lab.example", "10.0.0.7", "::1"}, folder));
        std::FILE* file = std::fopen((folder + "/evod.crt").c_str(), "r");
        X509* certificate = PEM_read_X509(file, nullptr, nullptr, nullptr);
        ASSERT_NE(certificate, nullptr);
        X509_free(certificate);
        std::fclose(file);
        std::filesystem::remove(folder + "/evod.crt");
        std::filesystem::remove(folder + "/evod.key");
    }
    EXPECT_EQ(create_certificate({"not a host"}, folder).error().code, RefusalCode::InvalidArgument);
}

} // namespace
} // namespace evod::access
