// HTTP connection: reads requests from one connection and answers them, until it ends or becomes a session.
//
// Owner        http.h. The coroutine keeps the connection alive until it has ended.
// Threads      the network thread.
// Full         limits.h limits the size of a header and the time for a request and its answer. A request has no body.
// Source       RFC 9110 and RFC 9112. Boost.Beast parses requests.
#pragma once

#include "server/access/authentication.h"
#include "server/base/result.h"
#include "server/metrics/traffic.h"
#include "server/network/http_rules.h"
#include "server/network/limits.h"
#include "server/network/transport.h"
#include "server/network/web_assets.h"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::network {

namespace http = boost::beast::http;

struct HttpAnswer {
    http::status status = http::status::ok;
    std::string text = {};
    std::string type = "text/plain; charset=utf-8";
    std::string_view stored = {}; // sent in place of `text`; bytes that exist as long as the server
    std::vector<std::pair<http::field, std::string>> fields = {};
};

struct HttpPage {
    std::function<asio::awaitable<HttpAnswer>()> make;
    bool needs_token = false; // whether only a client with a token may read it
};

/// A file that never changes while the server runs.
struct HttpFile {
    WebAsset compressed;
    std::string plain; // for clients that do not accept gzip
};

class HttpConnection;
using HttpConnectionPtr = std::shared_ptr<HttpConnection>;

/// The interface of the server that HTTP connections use.
struct HttpService {
    LimitCounters& limit_counters;
    metrics::Traffic& traffic;
    HostNames host_names;
    asio::ssl::context* tls = nullptr;       // nullptr: no TLS
    std::vector<std::string> embedders = {}; // origins whose pages may show the page in a frame
    std::vector<HttpFile> files = {};
    /// The key is the path of a page, such as "/metrics".
    std::map<std::string, HttpPage, std::less<>> pages = {};
    /// Authenticates a client by its token and address.
    std::function<base::Result<access::AuthenticatedUser>(const std::string& token, const std::string& address)> admit =
        {};
    /// Takes over a connection whose client has opened a WebSocket.
    std::function<void(std::unique_ptr<Transport>)> session = {};
    std::function<void(const HttpConnection&)> ended = {}; // called once, when the connection has ended
};

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
  public:
    /// full  true: there are too many connections, so the client receives only a 503.
    HttpConnection(tcp::socket socket, HttpService& service, bool full);

    void start();
    /// Closes the connection at once, and discards an answer of which a part is not sent yet. Does nothing to a session
    /// that it has become.
    void close();

    /// Whether no request is being answered.
    bool waits_for_request() const { return waits_for_request_; }
    /// The IPv4 address, or the /48 prefix of the IPv6 address.
    const std::string& address_prefix() const { return address_prefix_; }

  private:
    using Parser = http::request_parser<http::empty_body>;
    using Request = http::request<http::empty_body>;

    asio::awaitable<void> serve();
    /// Reads one request and answers it. Returns whether another one may follow.
    asio::awaitable<bool> serve_one();
    /// Reads the header of a request. Returns an error page if it is invalid, and error_ if the connection has ended.
    asio::awaitable<std::optional<HttpAnswer>> read_request(Parser& parser);
    asio::awaitable<HttpAnswer> answer_to(const Request& request);
    /// Checks where the request comes from and to which server. Returns the refusal, or nullopt.
    std::optional<HttpAnswer> refusal_of_host(const Request& request);
    std::optional<HttpAnswer> refusal_of_upgrade(const Request& request, const std::string& path);
    std::optional<HttpAnswer> refusal_of_token(const Request& request);
    HttpAnswer file(const Request& request, const std::string& path) const;
    HttpAnswer no_such_page() const;
    asio::awaitable<bool> send(HttpAnswer answer, unsigned version, bool only_header, bool keep_alive);
    /// Closes the sending side and discards further input for a limited time. If unread bytes remained, closing would
    /// discard the answer before the client receives it.
    asio::awaitable<void> say_goodbye();
    void become_session();

    /// Closes the connection after this time, unless another call replaces the limit before.
    ///
    /// limit  counted when the time is over.
    void limit_time(std::chrono::seconds time, std::optional<Limit> limit);

    HttpService& service_;
    const bool full_;
    std::unique_ptr<Transport> transport_; // nullptr: the connection has become a session
    const std::string address_prefix_;
    const asio::ip::address arrived_; // the address of this machine to which the client has connected
    const bool tls_;
    asio::steady_timer deadline_;
    std::uint64_t deadline_number_ = 0; // a timer of an earlier deadline does nothing
    std::string received_;              // bytes that are not parsed yet
    std::string host_;                  // the allowed Host of the present request; empty: it has none
    bool waits_for_request_ = true, over_ = false;
    bool sending_ = false; // the system has not accepted the whole answer yet
};

} // namespace evod::network
