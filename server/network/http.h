// HTTP: read-only pages for monitoring. Every client that can connect to the port may read them.
//
// Owner        the server, on the network thread. Each connection has one coroutine.
// Full         limits.h limits the number of connections, the size of a request's header and the time for a request.
// Source       RFC 9110 and RFC 9112. Boost.Beast parses requests and writes answers.
#pragma once

#include "server/network/limits.h"
#include "server/network/listener.h"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/status.hpp>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

namespace evod::network {

class Http {
  public:
    struct Page {
        boost::beast::http::status status = boost::beast::http::status::ok;
        std::string text;
        std::string type = "text/plain; charset=utf-8";
    };
    /// The key is the path of a page, such as "/metrics".
    using Pages = std::map<std::string, std::function<boost::asio::awaitable<Page>()>, std::less<>>;

    /// Opens the port; 0 selects any free port. The counters must outlive the object.
    static base::Result<std::unique_ptr<Http>> open(boost::asio::io_context& context, const std::string& address,
                                                    std::uint16_t port, Pages pages, LimitCounters& counters);

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_.endpoint(); }

    /// Accepts connections until close() is called.
    void start();
    void close();

  private:
    Http(boost::asio::io_context& context, Listener listener, Pages pages, LimitCounters& counters)
        : context_{context}, listener_{std::move(listener)}, pages_{std::move(pages)}, counters_{counters} {}

    /// full  true: there are too many connections, so the client receives only a 503.
    boost::asio::awaitable<void> serve(boost::asio::ip::tcp::socket socket, bool full);
    boost::asio::awaitable<Page> page(std::string target);

    boost::asio::io_context& context_;
    Listener listener_;
    Pages pages_;
    LimitCounters& counters_;
    std::set<boost::beast::tcp_stream*> connections_;
    bool closed_ = false;
};

} // namespace evod::network
