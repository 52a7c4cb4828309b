#include "server/access/certificate.h"

#include <boost/asio/ip/address.hpp>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

namespace evod::access {
namespace {

using base::Refusal;
using base::RefusalCode;
using base::Result;

template <class T, void (*Free)(T*)>
struct Freed {
    void operator()(T* it) const { Free(it); }
};
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY, EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509, X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION, X509_EXTENSION_free>>;

bool is_host_name(const std::string& host) {
    return !host.empty() && host.size() <= 253 && std::ranges::all_of(host, [](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    });
}

/// Returns "IP:10.0.0.7" or "DNS:lab.example"; empty if the host is neither an IP address nor a name.
std::string alternative_name(const std::string& host) {
    boost::system::error_code error;
    const auto address = boost::asio::ip::make_address(host, error);
    if (!error) {
        return "IP:" + address.to_string();
    }
    return is_host_name(host) ? "DNS:" + host : std::string{};
}

bool add_extension(X509* certificate, int which, const std::string& value) {
    X509V3_CTX context;
    X509V3_set_ctx_nodb(&context);
    X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
    const Extension extension{X509V3_EXT_conf_nid(nullptr, &context, which, value.c_str())};
    return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

Certificate certificate_of(EVP_PKEY* key, const std::string& names, const std::string& common_name) {
    Certificate certificate{X509_new()};
    unsigned char serial[16];
    bool good = certificate && RAND_bytes(serial, sizeof serial) == 1;
    serial[0] = static_cast<unsigned char>((serial[0] & 0x7f) | 0x40); // a positive number of exactly 16 bytes
    constexpr long day_s = 24 * 60 * 60;
    good = good && X509_set_version(certificate.get(), X509_VERSION_3) == 1 &&
           ASN1_STRING_set(X509_get_serialNumber(certificate.get()), serial, sizeof serial) == 1 &&
           // The certificate is valid from yesterday, because the clock of a client may be slow.
           X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -day_s) != nullptr &&
           X509_gmtime_adj(X509_getm_notAfter(certificate.get()), certificate_days * day_s) != nullptr &&
           X509_set_pubkey(certificate.get(), key) == 1;
    if (!good) {
        return nullptr;
    }
    X509_NAME* subject = X509_get_subject_name(certificate.get());
    good = X509_NAME_add_entry_by_txt(subject, "CN", MBSTRING_ASC,
                                      reinterpret_cast<const unsigned char*>(common_name.c_str()), -1, -1, 0) == 1 &&
           X509_set_issuer_name(certificate.get(), subject) == 1 &&
           add_extension(certificate.get(), NID_basic_constraints, "critical,CA:TRUE") &&
           add_extension(certificate.get(), NID_key_usage, "critical,digitalSignature,keyCertSign") &&
           add_extension(certificate.get(), NID_ext_key_usage, "serverAuth,clientAuth") &&
           add_extension(certificate.get(), NID_subject_key_identifier, "hash") &&
           add_extension(certificate.get(), NID_subject_alt_name, names) &&
           X509_sign(certificate.get(), key, EVP_sha256()) > 0;
    return good ? std::move(certificate) : nullptr;
}

template <class Write>
Result<void> write_pem(const std::string& path, mode_t mode, const Write& write) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor < 0) {
        return refusal(errno == EEXIST ? RefusalCode::AlreadyExists : RefusalCode::Unavailable,
                       errno == EEXIST ? path + " exists already: move it away, or name another folder with --folder"
                                       : "cannot create the file " + path + ": " + std::strerror(errno));
    }
    std::FILE* file = ::fdopen(descriptor, "w");
    const bool written = write(file) == 1;
    if (std::fclose(file) != 0 || !written) {
        ::unlink(path.c_str());
        return refusal(RefusalCode::Unavailable, "cannot write the file " + path + ": the disk may be full");
    }
    return {};
}

} // namespace

Result<void> create_certificate(const std::vector<std::string>& hosts, const std::string& folder) {
    std::string names;
    for (const std::string& host : hosts) {
        const std::string name = alternative_name(host);
        if (name.empty()) {
            return refusal(RefusalCode::InvalidArgument,
                           "host: got \"" + host + "\", allowed a host name or an IP address");
        }
        names += (names.empty() ? "" : ",") + name;
    }
    const Key key{EVP_EC_gen("P-256")};
    const std::string common_name = hosts.front().substr(0, 64);
    const Certificate certificate = key ? certificate_of(key.get(), names, common_name) : nullptr;
    if (!certificate) {
        return refusal(RefusalCode::Unavailable, "OpenSSL cannot create the certificate");
    }
    const std::string key_path = folder + "/evod.key", certificate_path = folder + "/evod.crt";
    if (::access(certificate_path.c_str(), F_OK) == 0) {
        return refusal(RefusalCode::AlreadyExists,
                       certificate_path + " exists already: move it away, or name another folder with --folder");
    }
    if (auto written = write_pem(key_path, 0600,
                                 [&](std::FILE* file) {
                                     return PEM_write_PrivateKey(file, key.get(), nullptr, nullptr, 0, nullptr,
                                                                 nullptr);
                                 });
        !written) {
        return written;
    }
    return write_pem(certificate_path, 0644, [&](std::FILE* file) { return PEM_write_X509(file, certificate.get()); });
}

} // namespace evod::access
