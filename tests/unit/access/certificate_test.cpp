#include "server/access/certificate.h"

#include "server/access/tls.h"
#include "tests/support/temporary_folder.h"

#include <gmock/gmock.h>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

namespace evod::access {
namespace {

namespace fs = std::filesystem;
using base::RefusalCode;
using testing::HasSubstr;

class CertificateTest : public testing::Test {
  protected:
    using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
    Certificate read() const {
        std::FILE* const file = std::fopen((folder + "/evod.crt").c_str(), "r");
        Certificate certificate{file == nullptr ? nullptr : PEM_read_X509(file, nullptr, nullptr, nullptr), X509_free};
        if (file != nullptr) {
            std::fclose(file);
        }
        return certificate;
    }
    std::string text_of(const std::string& name) const {
        std::ifstream file{folder + "/" + name};
        return {std::istreambuf_iterator<char>{file}, {}};
    }

    support::TemporaryFolder temporary;
    const std::string& folder = temporary.path();
};

TEST_F(CertificateTest, CoversAllHostsItIsMadeFor) {
    ASSERT_TRUE(create_certificate({"lab.example", "10.0.0.7", "::1"}, folder));
    const Certificate certificate = read();
    ASSERT_TRUE(certificate);
    EXPECT_EQ(X509_check_host(certificate.get(), "lab.example", 0, 0, nullptr), 1);
    EXPECT_EQ(X509_check_host(certificate.get(), "other.example", 0, 0, nullptr), 0);
    EXPECT_EQ(X509_check_ip_asc(certificate.get(), "10.0.0.7", 0), 1);
    EXPECT_EQ(X509_check_ip_asc(certificate.get(), "::1", 0), 1);
    EXPECT_EQ(X509_check_ip_asc(certificate.get(), "10.0.0.8", 0), 0);
}

TEST_F(CertificateTest, IsSignedByItsOwnKeyAndValidNow) {
    ASSERT_TRUE(create_certificate({"localhost"}, folder));
    const Certificate certificate = read();
    ASSERT_TRUE(certificate);
    EXPECT_EQ(X509_verify(certificate.get(), X509_get0_pubkey(certificate.get())), 1);
    EXPECT_EQ(X509_cmp_current_time(X509_get0_notBefore(certificate.get())), -1);
    int days = 0, seconds = 0;
    ASSERT_EQ(ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate.get())), 1);
    EXPECT_GE(days, certificate_days - 1);
    EXPECT_LE(days, certificate_days);
    const auto context =
        server_context({.certificate = folder + "/evod.crt", .key = folder + "/evod.key", .client_ca = {}});
    ASSERT_TRUE(context) << to_text(context.error());
    EXPECT_TRUE(*context);
}

TEST_F(CertificateTest, OnlyTheOwnerCanReadTheKey) {
    ASSERT_TRUE(create_certificate({"localhost"}, folder));
    EXPECT_EQ(fs::status(folder + "/evod.key").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(CertificateTest, FilesAreNeverReplaced) {
    ASSERT_TRUE(create_certificate({"localhost"}, folder));
    const std::string key = text_of("evod.key"), certificate = text_of("evod.crt");
    const auto again = create_certificate({"localhost"}, folder);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, RefusalCode::AlreadyExists);
    EXPECT_THAT(again.error().message, HasSubstr("evod.crt"));
    fs::remove(folder + "/evod.crt");
    const auto beside_key = create_certificate({"localhost"}, folder);
    ASSERT_FALSE(beside_key);
    EXPECT_THAT(beside_key.error().message, HasSubstr("evod.key exists already"));
    EXPECT_FALSE(fs::exists(folder + "/evod.crt"));
    EXPECT_EQ(text_of("evod.key"), key);
}

TEST_F(CertificateTest, RefusesWhatIsNoHost) {
    for (const char* wrong : {"", "a b", "a,DNS:b", "lab_1", "http://lab", "1.2.3.4/8", "\xc3\xa4"}) {
        const auto refused = create_certificate({"localhost", wrong}, folder);
        ASSERT_FALSE(refused) << wrong;
        EXPECT_EQ(refused.error().code, RefusalCode::InvalidArgument);
        EXPECT_THAT(refused.error().message, HasSubstr("\"" + std::string{wrong} + "\""));
    }
    EXPECT_FALSE(create_certificate({std::string(254, 'a')}, folder));
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(CertificateTest, NamesTheFileThatCannotBeWritten) {
    const auto refused = create_certificate({"localhost"}, folder + "/nowhere");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, RefusalCode::Unavailable);
    EXPECT_THAT(refused.error().message, HasSubstr(folder + "/nowhere/evod.key"));
}

} // namespace
} // namespace evod::access
