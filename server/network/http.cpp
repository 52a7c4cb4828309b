#include "server/network/http.h"

#include "server/network/detached.h"
#include "server/network/limits.h"
#include "server/network/no_throw.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include <array>
#include <optional>
#include <tuple>
#include <utility>

namespace evod::network {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;

namespace {

using Parser = http::request_parser<http::empty_body>;

bool is_too_long(boost::system::error_code error) {
    return error == http::error::header_limit || error == http::error::buffer_overflow;
}

/// Returns an error page if the request is invalid; nullopt if it is valid. Does not check the path.
std::optional<Http::Page> fault_of(boost::system::error_code error, const Parser& request) {
    if (is_too_long(error)) {
        return Http::Page{.status = http::status::request_header_fields_too_large,
                          .text = "the header is larger than " + std::to_string(http_header_bytes_max) +
                                  " bytes: send fewer or shorter fields\n"};
    }
    if (error) {
        return Http::Page{.status = http::status::bad_request,
                          .text = "this is not an HTTP/1.1 request: " + error.message() + "\n"};
    }
    if (request.get().method() != http::verb::get && request.get().method() != http::verb::head) {
        return Http::Page{.status = http::status::method_not_allowed,
                          .text = "this server does not support other methods: use GET or HEAD\n"};
    }
    if (!request.is_done()) {
        return Http::Page{.status = http::status::bad_request, .text = "send the request without a body\n"};
    }
    return std::nullopt;
}

http::response<http::string_body> response_of(Http::Page page, unsigned version, bool keep_alive) {
    http::response<http::string_body> response{page.status, version};
    response.set(http::field::content_type, page.type);
    response.set(http::field::cache_control, "no-store");
    if (page.status == http::status::method_not_allowed) {
        response.set(http::field::allow, "GET, HEAD");
    }
    response.body() = std::move(page.text);
    response.keep_alive(keep_alive);
    response.prepare_payload();
    return response;
}

/// Reads and discards input for a limited time before the connection is closed. If unread bytes remained, closing would
/// discard the answer before the client receives it.
asio::awaitable<void> discard_input(boost::beast::tcp_stream& stream) {
    boost::system::error_code ignored; // the peer may have closed the connection
    stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream.expires_after(http_farewell_timeout);
    std::array<char, 4096> bytes;
    for (;;) {
        const auto [error, count] = co_await stream.async_read_some(asio::buffer(bytes), no_throw);
        if (error) {
            co_return;
        }
    }
}

} // namespace

base::Result<std::unique_ptr<Http>> Http::open(asio::io_context& context, const std::string& address,
                                               std::uint16_t port, Pages pages, LimitCounters& counters) {
    auto listener = Listener::open(context, address, port, {.address = "--http-bind", .port = "--http-port"});
    if (!listener) {
        return listener.error();
    }
    return std::unique_ptr<Http>{new Http{context, *std::move(listener), std::move(pages), counters}};
}

void Http::start() {
    const auto accepted = [this](tcp::socket socket) {
        const bool full = connections_.size() >= http_connections_max;
        if (full) {
            counters_.met(Limit::HttpConnections);
        }
        if (closed_ || connections_.size() >= 2 * http_connections_max) {
            return;
        }
        asio::co_spawn(context_, serve(std::move(socket), full), detached);
    };
    asio::co_spawn(context_, listener_.accept(accepted), detached);
}

void Http::close() {
    closed_ = true;
    listener_.close();
    for (boost::beast::tcp_stream* connection : connections_) {
        connection->close();
    }
}

asio::awaitable<void> Http::serve(tcp::socket socket, bool full) {
    boost::beast::tcp_stream stream{std::move(socket)};
    connections_.insert(&stream);
    // The buffer may contain a complete request and the start of the next one.
    boost::beast::flat_buffer buffer{2 * http_header_bytes_max};
    boost::system::error_code error;
    for (bool goes_on = true; goes_on && !closed_;) {
        Parser request;
        // The parser applies its limit only approximately. The exact limit is checked below.
        request.header_limit(2 * http_header_bytes_max);
        stream.expires_after(http_request_timeout);
        std::size_t header_bytes = 0;
        std::tie(error, header_bytes) = co_await http::async_read_header(stream, buffer, request, no_throw);
        if (!error && header_bytes > http_header_bytes_max) {
            error = http::error::header_limit;
        }
        if (closed_ || (error && error.category() != make_error_code(http::error::bad_method).category()) ||
            error == http::error::end_of_stream) {
            break; // the client has disconnected or is too slow
        }
        if (is_too_long(error)) {
            counters_.met(Limit::HttpHeaderBytes);
        }
        auto answer = fault_of(error, request);
        goes_on = !answer && !full && request.get().keep_alive();
        if (full) {
            answer = Page{.status = http::status::service_unavailable,
                          .text = std::to_string(http_connections_max) +
                                  " connections are open already: close one, or try again in a few seconds\n"};
        }
        if (!answer) {
            answer = co_await page(std::string{request.get().target()});
        }
        const auto response = response_of(*std::move(answer), request.get().version() == 10 ? 10 : 11, goes_on);
        http::response_serializer<http::string_body> serializer{response};
        stream.expires_after(http_request_timeout);
        if (request.get().method() == http::verb::head) {
            std::tie(error, std::ignore) = co_await http::async_write_header(stream, serializer, no_throw);
        } else {
            std::tie(error, std::ignore) = co_await http::async_write(stream, serializer, no_throw);
        }
        if (error) {
            break;
        }
        if (!goes_on) {
            co_await discard_input(stream);
        }
    }
    if (error == boost::beast::error::timeout) {
        counters_.met(Limit::HttpRequestTimeout);
    }
    connections_.erase(&stream);
}

asio::awaitable<Http::Page> Http::page(std::string target) {
    const auto found = pages_.find(target.substr(0, target.find('?')));
    if (found != pages_.end()) {
        co_return co_await found->second();
    }
    std::string known;
    for (const auto& [path, make] : pages_) {
        known += (known.empty() ? "" : " and ") + path;
    }
    co_return Page{.status = http::status::not_found, .text = "no such page; available: " + known + "\n"};
}

} // namespace evod::network
