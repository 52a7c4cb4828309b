#include "server/access/tls.h"

#include "server/files/regular_file.h"

#include <openssl/ssl.h>

#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace evod::access {

namespace ssl = boost::asio::ssl;
using base::Refusal;
using base::RefusalCode;
using base::Result;

namespace {

Refusal refusal(std::string message) {
    return {.code = RefusalCode::FailedPrecondition, .message = std::move(message), .violations = {}};
}

} // namespace

Result<std::unique_ptr<ssl::context>> server_context(const TlsFiles& files) {
    struct stat about {};
    if (::stat(files.key.c_str(), &about) != 0) {
        return refusal("--tls-key: cannot read " + files.key + ": " + std::strerror(errno));
    }
    if ((about.st_mode & 007) != 0) {
        return refusal("--tls-key: all users can access " + files.key + ": run chmod 600 on it");
    }
    auto context = std::make_unique<ssl::context>(ssl::context::tls_server);
    SSL_CTX_set_min_proto_version(context->native_handle(), TLS1_2_VERSION);
    SSL_CTX_set_options(context->native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
    // Reads a file and passes its contents to `use`.
    const auto load = [](const char* option, const std::string& file, const auto& use) -> Result<void> {
        const auto text = files::read_file(file, "a PEM file", files::pem_bytes_max);
        if (!text) {
            return refusal(std::string{option} + ": " + text.error().message);
        }
        boost::system::error_code error;
        use(boost::asio::buffer(*text), error);
        if (error) {
            return refusal(std::string{option} + ": cannot use " + file + ": " + error.message());
        }
        return {};
    };
    auto loaded = load("--tls-cert", files.certificate,
                       [&](const auto& pem, auto& error) { context->use_certificate_chain(pem, error); });
    if (loaded) {
        loaded = load("--tls-key", files.key,
                      [&](const auto& pem, auto& error) { context->use_private_key(pem, ssl::context::pem, error); });
    }
    if (!loaded) {
        return loaded.error();
    }
    if (SSL_CTX_check_private_key(context->native_handle()) != 1) {
        return refusal("--tls-key: " + files.key + " is not the private key for the certificate in " +
                       files.certificate);
    }
    if (files.client_ca) {
        loaded = load("--tls-client-ca", *files.client_ca,
                      [&](const auto& pem, auto& error) { context->add_certificate_authority(pem, error); });
        if (!loaded) {
            return loaded.error();
        }
        context->set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert);
    }
    return context;
}

} // namespace evod::access
