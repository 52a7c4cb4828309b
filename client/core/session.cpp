#include "client/core/session.h"

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
#include <mutex>
#include <thread>
#include <utility>

namespace evod::core {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::size_t read_bytes = 256 << 10;

/// Enables TCP keepalive, which detects a peer that disappeared without closing the connection, such as a suspended
/// laptop.
void notice_silence(asio::ip::tcp::socket& socket) {
    error_code ignored; // if the system lacks an option, the socket still works
    socket.set_option(asio::ip::tcp::no_delay{true}, ignored);
    socket.set_option(asio::socket_base::keep_alive{true}, ignored);
    const int idle_s = 10, interval_s = 5, probes = 3;
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPINTVL, &interval_s, sizeof interval_s);
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
}

/// Returns the cause of a TLS error and how to fix it; empty if the cause is unknown.
std::string tls_reason_of(const error_code& error) {
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
std::string distrust_of(int verdict, const X509* certificate, const Options::Tls& files) {
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
    const std::string tls = tls_reason_of(error);
    return "the connection with " + to_text(server) + " failed: " + (tls.empty() ? error.message() : tls);
}

} // namespace

Session::Session(asio::io_context& io, const Options& options, Handlers handlers)
    : io_{io}, options_{options}, handlers_{std::move(handlers)}, socket_{io}, deadline_{io}, received_(read_bytes) {}

void Session::start() {
    start_deadline(options_.connect_timeout, "no connection with");
    look_up();
}

/// Looks up a host name on a separate thread, because getaddrinfo() may block for half a minute and cannot be
/// cancelled. The thread owns only this object, so it may outlive the Session.
struct Session::LookUp {
    std::mutex mutex;     // guards the other members
    asio::io_context* io; // nullptr: the session has cancelled the look-up
    std::weak_ptr<Session> of;
};

void Session::look_up() {
    const std::string host = options_.server.host, service = std::to_string(options_.server.port);
    error_code not_an_address;
    if (const auto address = asio::ip::make_address(host, not_an_address); !not_an_address) {
        asio::post(io_, [self = shared_from_this(), address, host, service] {
            const asio::ip::tcp::endpoint endpoint{address, self->options_.server.port};
            self->looked_up({}, asio::ip::tcp::resolver::results_type::create(endpoint, host, service));
        });
        return;
    }
    look_up_ = std::make_shared<LookUp>();
    look_up_->io = &io_;
    look_up_->of = weak_from_this();
    std::thread{[mine = look_up_, host, service] {
        asio::io_context unused;
        asio::ip::tcp::resolver resolver{unused};
        error_code error;
        const auto addresses = resolver.resolve(host, service, asio::ip::resolver_base::numeric_service, error);
        const std::lock_guard lock{mine->mutex};
        if (mine->io != nullptr) {
            asio::post(*mine->io, [of = mine->of, error, addresses] {
                if (const auto session = of.lock()) {
                    session->looked_up(error, addresses);
                }
            });
        }
    }}.detach();
}

void Session::looked_up(const error_code& error, const asio::ip::tcp::resolver::results_type& addresses) {
    if (ended_) {
        return;
    }
    if (error) {
        end({.reason = reason_of(error, options_.server)});
    } else {
        connect(addresses);
    }
}

void Session::cancel_look_up() {
    if (look_up_) {
        const std::lock_guard lock{look_up_->mutex};
        look_up_->io = nullptr;
    }
}

void Session::connect(const asio::ip::tcp::resolver::results_type& addresses) {
    asio::async_connect(socket_, addresses,
                        [self = shared_from_this()](const error_code& error, const asio::ip::tcp::endpoint&) {
                            if (self->ended_) {
                                return;
                            }
                            if (error) {
                                self->end({.reason = reason_of(error, self->options_.server)});
                                return;
                            }
                            notice_silence(self->socket_);
                            if (self->options_.tls) {
                                self->perform_handshake();
                            } else {
                                self->begin();
                            }
                        });
}

void Session::perform_handshake() {
    namespace ssl = asio::ssl;
    const Options::Tls& files = *options_.tls;
    tls_context_.emplace(ssl::context::tls_client);
    SSL_CTX_set_min_proto_version(tls_context_->native_handle(), TLS1_2_VERSION);
    tls_context_->set_verify_mode(ssl::verify_peer);
    error_code error;
    const auto fails = [&](const char* option, const std::string& file, const char* also = "") {
        if (error) {
            end({.reason = std::string{option} + ": " + file + " cannot be used for TLS: " + error.message() + also,
                 .final = true});
        }
        return error.failed();
    };
    if (files.ca.empty()) {
        tls_context_->set_default_verify_paths(error);
    } else {
        tls_context_->load_verify_file(files.ca, error);
    }
    if (files.ca.empty() ? fails("--tls", "the certificates of this system") : fails("--ca", files.ca)) {
        return;
    }
    if (!files.certificate.empty()) {
        tls_context_->use_certificate_chain_file(files.certificate, error);
        if (fails("--cert", files.certificate)) {
            return;
        }
        tls_context_->use_private_key_file(files.key.empty() ? files.certificate : files.key, ssl::context::pem, error);
        if (files.key.empty()
                ? fails("--cert", files.certificate, ": if it does not contain the key, give the key with --key")
                : fails("--key", files.key)) {
            return;
        }
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
                distrust_ =
                    distrust_of(X509_STORE_CTX_get_error(store), X509_STORE_CTX_get_current_cert(store), *options_.tls);
            }
            return believed;
        });
    // The TLS extension server_name must not contain an IP address (RFC 6066, section 3); strict servers reject one.
    if (error_code not_an_address; asio::ip::make_address(options_.server.host, not_an_address), not_an_address) {
        SSL_set_tlsext_host_name(tls_->native_handle(), options_.server.host.c_str());
    }
    tls_->async_handshake(ssl::stream_base::client, [self = shared_from_this()](const error_code& failed) {
        if (self->ended_) {
            return;
        }
        if (failed) {
            const std::string known = tls_reason_of(failed);
            const bool by_tls = failed.category() == asio::error::get_ssl_category();
            const std::string why = !self->distrust_.empty() ? "its certificate is not trusted: " + self->distrust_
                                    : known.empty()          ? failed.message()
                                                             : known;
            self->end({.reason = "no TLS with " + to_text(self->options_.server) + ": " + why,
                       .final = !self->distrust_.empty() || (by_tls && !known.empty())});
            return;
        }
        self->begin();
    });
}

void Session::begin() {
    send_hello();
    read();
}

void Session::send_hello() {
    evod::v1::ClientMessage message;
    auto& hello = *message.mutable_hello();
    hello.set_protocol_version(codec::protocol_version);
    hello.set_client_name(options_.client_name);
    hello.set_client_version(options_.client_version);
    hello.set_token(options_.token);
    hello.set_frame_bytes_max(static_cast<std::uint32_t>(*codec::client_limits.control_bytes_max));
    to_send_.push_back(codec::encode_frame(codec::Channel::Control, message));
    write();
    start_deadline(options_.connect_timeout, "no Welcome from");
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
        self->reader_.feed(std::span{self->received_}.first(length));
        self->handle_frames();
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

void Session::handle_frames() {
    while (!ended_) {
        const auto frame = reader_.next();
        if (!frame) {
            // A peer that never sent a valid message is not an evod server: reconnecting would not help. After a
            // Welcome the damage may be temporary.
            end({.reason = to_text(options_.server) +
                           (welcomed_ ? " sent damaged data: " : " is not an evod server: ") + frame.error().what,
                 .final = !welcomed_});
            return;
        }
        if (!*frame) {
            return;
        }
        if ((*frame)->channel == codec::Channel::Control) {
            handle_control((*frame)->body);
        } else if (!welcomed_) {
            end({.reason = to_text(options_.server) + " is not an evod server: its first message is a snapshot",
                 .final = true});
        } else if (auto snapshot = codec::parse_body<evod::v1::SnapshotFrame>((*frame)->body)) {
            handlers_.snapshot_received(*std::move(snapshot));
        } else {
            end({.reason = to_text(options_.server) + " sent damaged data: " + snapshot.error().what});
        }
    }
}

void Session::handle_control(std::span<const std::byte> body) {
    auto message = codec::parse_body<evod::v1::ServerMessage>(body);
    if (!message) {
        end({.reason = to_text(options_.server) + " sent damaged data: " + message.error().what});
    } else if (!welcomed_) {
        handle_first_message(*message);
    } else {
        if (message->has_goodbye()) {
            goodbye_ = message->goodbye().status();
        }
        going_away_ = going_away_ || message->event().has_server_going_away();
        handlers_.received(*std::move(message));
    }
}

void Session::handle_first_message(const evod::v1::ServerMessage& message) {
    if (message.has_goodbye()) {
        const auto code = message.goodbye().status().code();
        const bool later = code == evod::v1::CODE_RESOURCE_EXHAUSTED || code == evod::v1::CODE_UNAVAILABLE;
        end(refused(message.goodbye().status(), "refused us", !later));
    } else if (!message.has_welcome()) {
        end({.reason = to_text(options_.server) + " is not an evod server: its first message is not a Welcome",
             .final = true});
    } else if (message.welcome().protocol_version() != codec::protocol_version) {
        end({.reason = "the server at " + to_text(options_.server) + " uses protocol version " +
                       std::to_string(message.welcome().protocol_version()) + ", this program version " +
                       std::to_string(codec::protocol_version) + ": use a program of the server's version",
             .final = true});
    } else {
        deadline_.cancel();
        welcomed_ = true;
        handlers_.welcomed(message.welcome());
    }
}

Session::Ending Session::lost(const error_code& error) const {
    if (goodbye_) { // if the token was revoked, reconnecting would not help
        return refused(*goodbye_, "ended the session", goodbye_->code() == evod::v1::CODE_UNAUTHENTICATED);
    }
    // With TLS 1.3, only this error reports that the server rejected the client's certificate. Another attempt would
    // fail too.
    const bool not_taken =
        !welcomed_ && error.category() == asio::error::get_ssl_category() && !tls_reason_of(error).empty();
    // The server's message about a rejected client certificate may be lost with the connection.
    const bool without_message = tls_ && !welcomed_ && error.category() != asio::error::get_ssl_category();
    return {.reason = going_away_
                          ? "the server at " + to_text(options_.server) + " was shut down"
                          : reason_of(error, options_.server) +
                                (without_message ? ": it may require another client certificate, see --cert" : ""),
            .final = not_taken};
}

Session::Ending Session::refused(const evod::v1::Status& status, const char* did, bool final) const {
    return {.reason = "the server at " + to_text(options_.server) + " " + did + ": " + to_text(status),
            .final = final,
            .token_needed = status.code() == evod::v1::CODE_UNAUTHENTICATED,
            .refusal = status};
}

void Session::send(std::string frame) {
    to_send_.push_back(std::move(frame));
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

void Session::start_deadline(std::chrono::milliseconds timeout, std::string what) {
    deadline_.expires_after(timeout);
    deadline_.async_wait([self = shared_from_this(), timeout, what = std::move(what)](const error_code& error) {
        if (!error && !self->ended_ && !self->welcomed_) {
            self->end({.reason = what + " " + to_text(self->options_.server) + " within " +
                                 std::to_string(timeout.count()) + " ms: check the address and the network"});
        }
    });
}

void Session::close() {
    ended_ = true;
    cancel_look_up();
    deadline_.cancel();
    error_code ignored;
    socket_.close(ignored);
}

void Session::end(Ending ending) {
    if (!ended_) {
        close();
        handlers_.ended(std::move(ending));
    }
}

} // namespace evod::core
