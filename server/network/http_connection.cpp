#include "server/network/http_connection.h"

#include "server/network/detached.h"
#include "server/network/no_throw.h"
#include "server/protocol/public_text.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/write.hpp>

#include <algorithm>
#include <array>
#include <sstream>

namespace evod::network {
namespace {

constexpr std::string_view session_path = "/session";

bool is_too_long(boost::system::error_code error) {
    return error == http::error::header_limit || error == http::error::buffer_overflow;
}

HttpAnswer refused(http::status status, std::string text) {
    return {.status = status, .text = std::move(text) + "\n"};
}

/// Returns an error page if the request is invalid; nullopt if it is valid. Does not check path and Host.
std::optional<HttpAnswer> fault_of(boost::system::error_code error,
                                   const http::request_parser<http::empty_body>& parser) {
    if (is_too_long(error)) {
        return refused(http::status::request_header_fields_too_large, "the header is larger than " +
                                                                          std::to_string(http_header_bytes_max) +
                                                                          " bytes: send fewer or shorter fields");
    }
    if (error) {
        return refused(http::status::bad_request, "this is not an HTTP/1.1 request: " + error.message());
    }
    if (parser.get().method() != http::verb::get && parser.get().method() != http::verb::head) {
        HttpAnswer answer =
            refused(http::status::method_not_allowed, "this server does not support other methods: use GET or HEAD");
        answer.fields.emplace_back(http::field::allow, "GET, HEAD");
        return answer;
    }
    // A proxy and this server could disagree about where the body ends, and the rest would be read as another request.
    if (parser.get().count(http::field::transfer_encoding) > 0 || !parser.is_done()) {
        return refused(http::status::bad_request, "send the request without a body");
    }
    return std::nullopt;
}

std::optional<std::string> field_of(const http::request<http::empty_body>& request, http::field name) {
    const auto found = request.find(name);
    return found == request.end() ? std::nullopt : std::optional{std::string{found->value()}};
}

/// The path of a request, without the query.
std::string path_of(const http::request<http::empty_body>& request) {
    const std::string target{request.target()};
    return target.substr(0, target.find('?'));
}

/// Waits until the client has received everything, or receives nothing for http_farewell_timeout.
asio::awaitable<void> wait_until_received(Transport& transport) {
    constexpr int looks = 10;
    asio::steady_timer pause{transport.socket().get_executor()};
    std::uint64_t not_taken = transport.progress().not_taken;
    for (int idle_looks = 0; not_taken > 0 && idle_looks < looks; ++idle_looks) {
        pause.expires_after(std::chrono::milliseconds{http_farewell_timeout} / looks);
        co_await pause.async_wait(no_throw);
        if (const auto before = std::exchange(not_taken, transport.progress().not_taken); not_taken < before) {
            idle_looks = 0;
        }
    }
}

} // namespace

HttpConnection::HttpConnection(tcp::socket socket, HttpService& service, bool full)
    : service_{service}
    , full_{full}
    , transport_{std::make_unique<Transport>(std::move(socket), service.tls)}
    , address_prefix_{address_key(transport_->peer().address())}
    , arrived_{transport_->local().address()}
    , tls_{service.tls != nullptr}
    , deadline_{transport_->socket().get_executor()} {
    boost::system::error_code ignored; // without the option the connection works, but less quickly
    transport_->socket().set_option(tcp::no_delay{true}, ignored);
}

void HttpConnection::start() {
    asio::co_spawn(
        transport_->socket().get_executor(), [self = shared_from_this()] { return self->serve(); }, detached);
}

void HttpConnection::close() {
    over_ = true;
    if (!transport_) {
        return;
    }
    // The system would keep for minutes what the client does not read.
    if (sending_ || transport_->progress().not_taken > 0) {
        transport_->abort();
    } else {
        transport_->close();
    }
}

void HttpConnection::limit_time(std::chrono::seconds time, std::optional<Limit> limit) {
    const std::uint64_t number = ++deadline_number_, not_taken = transport_->progress().not_taken;
    deadline_.expires_after(time);
    deadline_.async_wait([weak = weak_from_this(), number, not_taken, time, limit](boost::system::error_code error) {
        const auto self = weak.lock();
        if (!self || error || number != self->deadline_number_ || self->over_) {
            return;
        }
        if (const auto left = self->transport_->progress().not_taken; !self->sending_ && left > 0 && left < not_taken) {
            return self->limit_time(time, limit); // the client still receives the answer before
        }
        if (limit) {
            self->service_.limit_counters.met(*limit);
        }
        self->close();
    });
}

asio::awaitable<void> HttpConnection::serve() {
    limit_time(http_request_timeout, Limit::HttpRequestTimeout);
    if (const auto error = co_await transport_->begin(); error == Transport::not_tls()) {
        co_await send(refused(http::status::bad_request, "this server requires TLS: use https:// in place of http://"),
                      11, false, false);
        co_await say_goodbye();
    } else if (!error) {
        while (!over_ && co_await serve_one()) {
            limit_time(http_request_timeout, Limit::HttpRequestTimeout);
        }
    }
    ++deadline_number_;
    deadline_.cancel();
    if (transport_) {
        co_await wait_until_received(*transport_);
    }
    close();
    service_.ended(*this);
}

asio::awaitable<bool> HttpConnection::serve_one() {
    Parser parser;
    // The parser applies its limit only approximately. read_request() checks the exact limit.
    parser.header_limit(2 * http_header_bytes_max);
    host_.clear();
    waits_for_request_ = true;
    std::optional<HttpAnswer> answer = co_await read_request(parser);
    if (over_) {
        co_return false;
    }
    waits_for_request_ = false;
    limit_time(http_request_timeout, Limit::HttpRequestTimeout);
    const Request& request = parser.get();
    const bool keep_alive = !answer && !full_ && request.keep_alive();
    if (full_) {
        answer = refused(http::status::service_unavailable,
                         std::to_string(http_connections_max) +
                             " connections are open already: close one, or try again in a few seconds");
    }
    if (!answer) {
        answer = co_await answer_to(request);
    }
    const bool upgrades = answer->status == http::status::switching_protocols;
    const bool sent = co_await send(*std::move(answer), request.version() == 10 ? 10 : 11,
                                    request.method() == http::verb::head, keep_alive || upgrades);
    if (!sent || over_) {
        co_return false;
    }
    if (upgrades) {
        become_session();
        co_return false;
    }
    if (!keep_alive) {
        co_await say_goodbye();
    }
    co_return keep_alive;
}

asio::awaitable<std::optional<HttpAnswer>> HttpConnection::read_request(Parser& parser) {
    std::array<char, 4096> bytes;
    boost::system::error_code error;
    std::size_t header_bytes = 0;
    for (;;) {
        if (!received_.empty()) {
            const std::size_t parsed = parser.put(asio::buffer(received_), error);
            header_bytes += parsed;
            received_.erase(0, parsed);
            if (header_bytes > http_header_bytes_max || received_.size() > 2 * http_header_bytes_max) {
                error = http::error::header_limit;
            }
            if (parser.is_header_done() || (error && error != http::error::need_more)) {
                break;
            }
        }
        const auto [read_error, count] = co_await transport_->receive_some(asio::buffer(bytes));
        if (read_error || over_) {
            over_ = true; // the client has disconnected or is too slow
            co_return std::nullopt;
        }
        received_.append(bytes.data(), count);
    }
    if (is_too_long(error)) {
        service_.limit_counters.met(Limit::HttpHeaderBytes);
    }
    co_return fault_of(error == http::error::need_more ? boost::system::error_code{} : error, parser);
}

asio::awaitable<HttpAnswer> HttpConnection::answer_to(const Request& request) {
    if (auto refusal = refusal_of_host(request)) {
        co_return *std::move(refusal);
    }
    const std::string path = path_of(request);
    if (path == session_path) {
        if (auto refusal = refusal_of_upgrade(request, path)) {
            co_return *std::move(refusal);
        }
        HttpAnswer answer{.status = http::status::switching_protocols};
        answer.fields.emplace_back(http::field::upgrade, "websocket");
        answer.fields.emplace_back(http::field::connection, "Upgrade");
        answer.fields.emplace_back(http::field::sec_websocket_accept,
                                   *websocket_accept(*field_of(request, http::field::sec_websocket_key)));
        co_return answer;
    }
    const auto page = service_.pages.find(path);
    if (page == service_.pages.end()) {
        co_return file(request, path);
    }
    if (page->second.needs_token) {
        if (auto refusal = refusal_of_token(request)) {
            co_return *std::move(refusal);
        }
    }
    co_return co_await page->second.make();
}

std::optional<HttpAnswer> HttpConnection::refusal_of_host(const Request& request) {
    const auto host = field_of(request, http::field::host);
    if (!host || request.count(http::field::host) != 1) {
        return refused(http::status::bad_request, "the request needs exactly one Host field");
    }
    if (!service_.host_names.allows(*host, arrived_)) {
        service_.traffic.http_refused_hosts.add();
        return refused(http::status::forbidden,
                       "this server is not known under the name in the address: use its IP address, or start evod with "
                       "--http-host NAME");
    }
    host_ = *host;
    return std::nullopt;
}

std::optional<HttpAnswer> HttpConnection::refusal_of_upgrade(const Request& request, const std::string& path) {
    const auto origin = field_of(request, http::field::origin);
    if (!origin || request.count(http::field::origin) != 1 || !is_own_origin(*origin, host_, tls_)) {
        service_.traffic.http_refused_origins.add();
        return refused(http::status::forbidden, "only a page of this server may open " + path +
                                                    ": the Origin field must be " + (tls_ ? "https://" : "http://") +
                                                    host_);
    }
    const bool asks = request.method() == http::verb::get && request.version() == 11 &&
                      http::token_list{request[http::field::upgrade]}.exists("websocket") &&
                      http::token_list{request[http::field::connection]}.exists("upgrade");
    if (!asks || request[http::field::sec_websocket_version] != "13") {
        HttpAnswer answer =
            refused(http::status::upgrade_required, path + " accepts only WebSocket handshakes (RFC 6455, version 13)");
        answer.fields.emplace_back(http::field::upgrade, "websocket");
        answer.fields.emplace_back(http::field::connection, "Upgrade");
        answer.fields.emplace_back(http::field::sec_websocket_version, "13");
        return answer;
    }
    const auto key = field_of(request, http::field::sec_websocket_key);
    if (!key || request.count(http::field::sec_websocket_key) != 1 || !websocket_accept(*key)) {
        return refused(http::status::bad_request, "Sec-WebSocket-Key must be the Base64 of 16 bytes");
    }
    return std::nullopt;
}

std::optional<HttpAnswer> HttpConnection::refusal_of_token(const Request& request) {
    const std::string token = bearer_token(request[http::field::authorization]);
    const auto user = service_.admit(token, address_prefix_);
    if (user) {
        return std::nullopt;
    }
    service_.traffic.http_refused_tokens.add();
    const auto code = user.error().code;
    const std::string why = protocol::public_text(user.error().message);
    HttpAnswer answer = refused(code == base::RefusalCode::Unauthenticated     ? http::status::unauthorized
                                : code == base::RefusalCode::ResourceExhausted ? http::status::too_many_requests
                                                                               : http::status::service_unavailable,
                                why);
    if (code == base::RefusalCode::Unauthenticated) {
        answer.text = why + "; send it as Authorization: Bearer TOKEN\n";
        answer.fields.emplace_back(http::field::www_authenticate, "Bearer realm=\"evod\"");
    }
    return answer;
}

HttpAnswer HttpConnection::file(const Request& request, const std::string& path) const {
    const auto found =
        std::ranges::find(service_.files, path, [](const HttpFile& file) { return file.compressed.path; });
    if (found == service_.files.end()) {
        return no_such_page();
    }
    const bool compressed = accepts_gzip(request[http::field::accept_encoding]);
    std::string etag = found->compressed.etag;
    if (!compressed) {
        etag.insert(1, "plain-"); // other bytes need another tag
    }
    HttpAnswer answer{.type = std::string{found->compressed.type}};
    answer.fields.emplace_back(http::field::etag, etag);
    answer.fields.emplace_back(http::field::cache_control, "no-cache");
    answer.fields.emplace_back(http::field::vary, "Accept-Encoding");
    if (has_entity_tag(request[http::field::if_none_match], etag)) {
        answer.status = http::status::not_modified;
        return answer;
    }
    if (compressed) {
        answer.fields.emplace_back(http::field::content_encoding, "gzip");
    }
    answer.stored = compressed ? found->compressed.bytes : found->plain;
    return answer;
}

HttpAnswer HttpConnection::no_such_page() const {
    std::string paths;
    for (const HttpFile& file : service_.files) {
        paths += std::string{file.compressed.path} + ", ";
    }
    for (const auto& [path, page] : service_.pages) {
        paths += path + ", ";
    }
    return refused(http::status::not_found, "no such page; available: " + paths + std::string{session_path});
}

asio::awaitable<bool> HttpConnection::send(HttpAnswer answer, unsigned version, bool only_header, bool keep_alive) {
    const std::string_view body = answer.stored.empty() ? std::string_view{answer.text} : answer.stored;
    http::response<http::empty_body> head{answer.status, version};
    head.keep_alive(keep_alive);
    for (const auto& [name, value] : answer.fields) {
        head.set(name, value);
    }
    if (head.count(http::field::cache_control) == 0) {
        head.set(http::field::cache_control, "no-store");
    }
    head.set("Content-Security-Policy", content_security_policy(host_, tls_, service_.embedders));
    head.set("X-Content-Type-Options", "nosniff");
    head.set("Cross-Origin-Opener-Policy", "same-origin");
    head.set("Cross-Origin-Resource-Policy", "same-origin");
    head.set("Referrer-Policy", "no-referrer");
    const bool has_body =
        answer.status != http::status::not_modified && answer.status != http::status::switching_protocols;
    if (has_body) {
        head.set(http::field::content_type, answer.type);
        head.content_length(body.size());
    }
    std::ostringstream text;
    text << head.base();
    const std::string header = text.str();
    std::vector<asio::const_buffer> buffers{asio::buffer(header)};
    if (has_body && !only_header) {
        buffers.push_back(asio::buffer(body));
    }
    sending_ = true;
    const auto [error, count] = co_await transport_->write(buffers);
    sending_ = false;
    co_return !error;
}

asio::awaitable<void> HttpConnection::say_goodbye() {
    limit_time(http_farewell_timeout, std::nullopt);
    asio::co_spawn(
        transport_->socket().get_executor(), [self = shared_from_this()] { return self->transport_->finish(); },
        detached);
    std::array<char, 4096> bytes;
    for (bool goes_on = true; goes_on;) {
        const auto [error, count] = co_await transport_->receive_some(asio::buffer(bytes));
        goes_on = !error;
    }
}

void HttpConnection::become_session() {
    ++deadline_number_;
    deadline_.cancel();
    transport_->begin_websocket(std::exchange(received_, {}));
    service_.session(std::move(transport_));
}

} // namespace evod::network
