#include "client/core/session.h"

#include "proto/files/input_file.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/asio/write.hpp>

#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <thread>
#include <utility>

namespace evod::core {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t read_bytes = 256 << 10;

/// Enables TCP keepalive, which detects a peer that disappeared without closing the connection, such as a suspended
/// laptop.
void enable_keepalive(asio::ip::tcp::socket& socket) {
    error_code ignored; // if the system lacks an option, the socket still works
    socket.set_option(asio::ip::tcp::no_delay{true}, ignored);
    socket.set_option(asio::socket_base::keep_alive{true}, ignored);
    const int idle_s = 10, interval_s = 5, probes = 3;
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPINTVL, &interval_s, sizeof interval_s);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
}

/// Returns the cause of a TLS error and how to fix it; empty if the cause is unknown.
std::string explain_tls_error(const error_code& error) {
    if (error == asio::ssl::error::stream_truncated || error == asio::error::eof ||
        error == asio::error::connection_reset) {
        return "it closed the connection: it may not use TLS, which --ca, --tls, --cert and EVOD_CA require";
    }
    if (error.category() != asio::error::get_ssl_category()) {
        return {};
    }
    switch (ERR_GET_REASON(static_cast<unsigned long>(error.value()))) {
    case SSL_R_WRONG_VERSION_NUMBER:
        return "it does not use TLS: leave out --ca, --tls, --cert and EVOD_CA";
    case SSL_R_UNSUPPORTED_PROTOCOL:
    case SSL_R_TLSV1_ALERT_PROTOCOL_VERSION:
        return "no common TLS version: the server requires 1.2 or newer";
    case SSL_R_TLSV13_ALERT_CERTIFICATE_REQUIRED:
    case SSL_R_SSLV3_ALERT_HANDSHAKE_FAILURE:
        return "it requires a client certificate: give one with --cert and --key";
    case SSL_R_TLSV1_ALERT_UNKNOWN_CA:
    case SSL_R_SSLV3_ALERT_BAD_CERTIFICATE:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_UNKNOWN:
        return "it does not trust the certificate of --cert: the server's --tls-client-ca determines which it trusts";
    case SSL_R_SSLV3_ALERT_CERTIFICATE_EXPIRED:
        return "the certificate of --cert has expired: create another";
    default:
        return {};
    }
}

std::string text_of(const ASN1_TIME* time) {
    const std::unique_ptr<BIO, decltype(&BIO_free)> out{BIO_new(BIO_s_mem()), BIO_free};
    if (!out || time == nullptr || ASN1_TIME_print(out.get(), time) != 1) {
        return "an unknown time";
    }
    char* text = nullptr;
    const long length = BIO_get_mem_data(out.get(), &text);
    return {text, static_cast<std::size_t>(length)};
}

/// Returns the host names and addresses in a certificate: "localhost, 127.0.0.1". Control characters become '?'.
std::string names_of(const X509* certificate) {
    const std::unique_ptr<GENERAL_NAMES, decltype(&GENERAL_NAMES_free)> names{
        static_cast<GENERAL_NAMES*>(X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)),
        GENERAL_NAMES_free};
    std::string text;
    for (int i = 0; names && i < sk_GENERAL_NAME_num(names.get()); ++i) {
        const GENERAL_NAME* name = sk_GENERAL_NAME_value(names.get(), i);
        if (name->type != GEN_DNS && name->type != GEN_IPADD) {
            continue;
        }
        const ASN1_STRING* bytes = name->type == GEN_DNS ? name->d.dNSName : name->d.iPAddress;
        const unsigned char* data = ASN1_STRING_get0_data(bytes);
        const auto size = static_cast<std::size_t>(ASN1_STRING_length(bytes));
        text += text.empty() ? "" : ", ";
        if (name->type == GEN_DNS) {
            std::transform(data, data + size, std::back_inserter(text),
                           [](unsigned char c) { return c > 0x20 && c < 0x7f ? static_cast<char>(c) : '?'; });
        } else if (size == 4) {
            text +=
                asio::ip::address_v4{asio::ip::address_v4::bytes_type{data[0], data[1], data[2], data[3]}}.to_string();
        } else if (size == 16) {
            asio::ip::address_v6::bytes_type address;
            std::copy_n(data, size, address.begin());
            text += asio::ip::address_v6{address}.to_string();
        }
    }
    return text.empty() ? "no name" : text;
}

/// Returns why a server's certificate is not trusted, and how to fix it.
///
/// certificate  the certificate that was rejected; nullptr: unknown.
std::string explain_distrust(int verdict, const X509* certificate, const Options::Tls& files) {
    const std::string why = X509_verify_cert_error_string(verdict);
    if (certificate == nullptr) {
        return why;
    }
    switch (verdict) {
    case X509_V_ERR_HOSTNAME_MISMATCH:
        return "it is for other names (" + names_of(certificate) + "): reach the server by one of them";
    case X509_V_ERR_CERT_HAS_EXPIRED:
        return "it expired on " + text_of(X509_get0_notAfter(certificate)) +
               ": the server needs a new one, for example from evod certificate; or is this machine's clock "
               "right?";
    case X509_V_ERR_CERT_NOT_YET_VALID:
        return "it is valid from " + text_of(X509_get0_notBefore(certificate)) + " on: is this machine's clock right?";
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
        return why + (files.ca.empty()
                          ? ": no authority of this system has signed it; give the server's evod.crt with --ca"
                          : ": " + files.ca + " has not signed it; is it the server's current evod.crt?");
    default:
        return why;
    }
}

std::string reason_of(const error_code& error, const Endpoint& server) {
    if (error == asio::error::connection_refused) {
        return "no server at " + to_text(server) + ": start one with `evod`";
    }
    if (error == asio::error::host_not_found || error == asio::error::host_not_found_try_again ||
        error == asio::error::no_data) {
        return "the host " + server.host + " is unknown: check its name";
    }
    if (error == asio::error::eof || error == asio::error::connection_reset || error == asio::error::broken_pipe ||
        error == asio::ssl::error::stream_truncated) {
        return "the server at " + to_text(server) + " closed the connection";
    }
    const std::string tls = explain_tls_error(error);
    return "the connection with " + to_text(server) + " failed: " + (tls.empty() ? error.message() : tls);
}

} // namespace

Session::Session(std::shared_ptr<asio::io_context> io, const Options& options, ProtocolState& protocol,
                 std::function<void()> changed)
    : io_{std::move(io)}
    , options_{options}
    , protocol_{protocol}
    , changed_{std::move(changed)}
    , socket_{*io_}
    , received_(read_bytes) {}

void Session::start() {
    const std::string host = options_.server.host, service = std::to_string(options_.server.port);
    error_code not_an_address;
    if (const auto address = asio::ip::make_address(host, not_an_address); !not_an_address) {
        asio::post(*io_, [self = shared_from_this(), address, host, service] {
            const asio::ip::tcp::endpoint endpoint{address, self->options_.server.port};
            self->handle_addresses({}, Addresses::create(endpoint, host, service));
        });
        return;
    }
    // A separate thread looks up the name, because getaddrinfo() may block for half a minute and cannot be cancelled.
    // The thread may outlive the session.
    std::thread{[io = io_, of = weak_from_this(), host, service] {
        asio::io_context unused;
        asio::ip::tcp::resolver resolver{unused};
        error_code error;
        const auto addresses = resolver.resolve(host, service, asio::ip::resolver_base::numeric_service, error);
        asio::post(*io, [of, error, addresses] {
            if (const auto session = of.lock()) {
                session->handle_addresses(error, addresses);
            }
        });
    }}.detach();
}

void Session::handle_addresses(const error_code& error, const Addresses& addresses) {
    if (ended_) {
        return;
    }
    if (error) {
        end({.reason = reason_of(error, options_.server)});
        return;
    }
    asio::async_connect(socket_, addresses, [self = shared_from_this()](const error_code& failed, const auto&) {
        if (self->ended_) {
            return;
        }
        if (failed) {
            self->end({.reason = reason_of(failed, self->options_.server)});
            return;
        }
        enable_keepalive(self->socket_);
        if (self->options_.tls) {
            self->perform_handshake();
        } else {
            self->begin();
        }
    });
}

std::string Session::load_tls_files() {
    const Options::Tls& files = *options_.tls;
    error_code error;
    std::string unreadable;
    const auto unusable = [&](const std::string& file, const char* also = "") {
        return file + " cannot be used for TLS: " + (unreadable.empty() ? error.message() + also : unreadable);
    };
    // Reads a file and passes its contents to `use`. Returns false after an error.
    const auto load = [&](const std::string& file, const auto& use) {
        const auto text = evod::files::read_input(file, "a PEM file", evod::files::pem_bytes_max);
        if (!text) {
            unreadable = text.error().why;
            return false;
        }
        use(asio::buffer(*text));
        return !error;
    };
    if (files.ca.empty()) {
        tls_context_->set_default_verify_paths(error);
        if (error) {
            return unusable("--tls: the certificates of this system");
        }
    } else if (!load(files.ca, [&](const auto& pem) { tls_context_->add_certificate_authority(pem, error); })) {
        return unusable("--ca: " + files.ca);
    } else if (sk_X509_OBJECT_num(X509_STORE_get0_objects(SSL_CTX_get_cert_store(tls_context_->native_handle()))) ==
               0) {
        unreadable = "it contains no certificate";
        return unusable("--ca: " + files.ca);
    }
    if (files.certificate.empty()) {
        return {};
    }
    if (!load(files.certificate, [&](const auto& pem) { tls_context_->use_certificate_chain(pem, error); })) {
        return unusable("--cert: " + files.certificate);
    }
    if (!load(files.key.empty() ? files.certificate : files.key,
              [&](const auto& pem) { tls_context_->use_private_key(pem, asio::ssl::context::pem, error); })) {
        return files.key.empty() ? unusable("--cert: " + files.certificate,
                                            ": if it does not contain the key, give the key with --key")
                                 : unusable("--key: " + files.key);
    }
    return {};
}

void Session::perform_handshake() {
    namespace ssl = asio::ssl;
    tls_context_.emplace(ssl::context::tls_client);
    SSL_CTX_set_min_proto_version(tls_context_->native_handle(), TLS1_2_VERSION);
    tls_context_->set_verify_mode(ssl::verify_peer);
    if (std::string unusable = load_tls_files(); !unusable.empty()) {
        end({.reason = std::move(unusable), .final = true});
        return;
    }
    tls_.emplace(socket_, *tls_context_);
    // The callback may use `this`, because the session owns the stream and outlives it.
    tls_->set_verify_callback(
        [this, named = ssl::host_name_verification{options_.server.host}](bool good, ssl::verify_context& context) {
            X509_STORE_CTX* const store = context.native_handle();
            const bool believed = named(good, context);
            if (good && !believed) {
                X509_STORE_CTX_set_error(store, X509_V_ERR_HOSTNAME_MISMATCH);
            }
            if (!believed) {
                distrust_ = explain_distrust(X509_STORE_CTX_get_error(store), X509_STORE_CTX_get_current_cert(store),
                                             *options_.tls);
            }
            return believed;
        });
    // The TLS extension server_name must not contain an IP address (RFC 6066, section 3); strict servers reject one.
    if (error_code not_an_address; asio::ip::make_address(options_.server.host, not_an_address), not_an_address) {
        SSL_set_tlsext_host_name(tls_->native_handle(), options_.server.host.c_str());
    }
    tls_->async_handshake(ssl::stream_base::client, [self = shared_from_this()](const error_code& error) {
        if (self->ended_) {
            return;
        }
        if (!error) {
            self->begin();
            return;
        }
        const std::string explained = explain_tls_error(error);
        const bool by_tls = error.category() == asio::error::get_ssl_category();
        const std::string why = !self->distrust_.empty() ? "its certificate is not trusted: " + self->distrust_
                                : explained.empty()      ? error.message()
                                                         : explained;
        self->end({.reason = "no TLS with " + to_text(self->options_.server) + ": " + why,
                   .final = !self->distrust_.empty() || (by_tls && !explained.empty())});
    });
}

void Session::begin() {
    protocol_.opened(Clock::now());
    changed_();
    if (!ended_) {
        read();
    }
}

void Session::read() {
    auto done = [self = shared_from_this()](const error_code& error, std::size_t length) {
        if (self->ended_) {
            return;
        }
        if (error) {
            self->end(self->lost(error));
            return;
        }
        self->has_received_ = true;
        self->protocol_.received(std::span{self->received_}.first(length), Clock::now());
        self->changed_();
        if (!self->ended_) {
            self->read();
        }
    };
    if (tls_) {
        tls_->async_read_some(asio::buffer(received_), std::move(done));
    } else {
        socket_.async_read_some(asio::buffer(received_), std::move(done));
    }
}

Ending Session::lost(const error_code& error) const {
    const bool by_tls = error.category() == asio::error::get_ssl_category();
    // With TLS 1.3, only this error reports that the server rejected the client's certificate. Another attempt would
    // fail too.
    const bool not_taken = !has_received_ && by_tls && !explain_tls_error(error).empty();
    // The server's message about a rejected client certificate may be lost with the connection.
    const bool without_message = tls_ && !has_received_ && !by_tls;
    return {.reason = reason_of(error, options_.server) +
                      (without_message ? ": it may require another client certificate, see --cert" : ""),
            .final = not_taken};
}

void Session::send(std::string bytes) {
    to_send_.push_back(std::move(bytes));
    if (to_send_.size() == 1) {
        write();
    }
}

void Session::write() {
    auto done = [self = shared_from_this()](const error_code& error, std::size_t) {
        // After a write error the server's last message may still arrive; read() then ends the session.
        if (self->ended_ || error) {
            return;
        }
        self->to_send_.pop_front();
        if (!self->to_send_.empty()) {
            self->write();
        }
    };
    if (tls_) {
        asio::async_write(*tls_, asio::buffer(to_send_.front()), std::move(done));
    } else {
        asio::async_write(socket_, asio::buffer(to_send_.front()), std::move(done));
    }
}

void Session::close() {
    ended_ = true;
    error_code ignored;
    socket_.close(ignored);
}

void Session::end(Ending ending) {
    if (!ended_) {
        close();
        protocol_.lost(std::move(ending), Clock::now());
        changed_();
    }
}

} // namespace evod::core
