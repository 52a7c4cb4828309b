// HTTP: one port that serves the page of the browser viewer, its sessions in WebSockets, and pages for monitoring.
//
// Owner        the server, on the network thread. http_connection.h serves each connection.
// Full         limits.h limits the number of connections, the size of a request's header and the time for a request. An
//              address may have half of the connections (base::Quota).
// Source       RFC 9110 and RFC 9112.
#pragma once

#include "server/base/quota.h"
#include "server/network/http_connection.h"
#include "server/network/limits.h"
#include "server/network/listener.h"

#include <boost/asio/io_context.hpp>

#include <list>
#include <memory>
#include <string>

namespace evod::network {

class Http {
  public:
    /// Opens the port; 0 selects any free port.
    static base::Result<std::unique_ptr<Http>> open(boost::asio::io_context& context, const std::string& address,
                                                    std::uint16_t port, HttpService service);

    boost::asio::ip::tcp::endpoint endpoint() const { return listener_.endpoint(); }

    /// The connections that are open, by address.
    base::Quota places() const;

    /// Accepts connections until close() is called.
    void start();
    void close();
    /// Uses other settings of TLS for new connections.
    void set_tls(boost::asio::ssl::context* tls) { service_.tls = tls; }

  private:
    Http(boost::asio::io_context& context, Listener listener, HttpService service)
        : context_{context}, listener_{std::move(listener)}, service_{std::move(service)} {}

    void accepted(boost::asio::ip::tcp::socket socket);
    /// Makes room for one more connection of this address. Closes one that waits for a request, the oldest: of this
    /// address if it holds half, otherwise of the address with the most. Closes other connections only of an address
    /// that has clearly more. Returns false if there is no room.
    bool make_room(const std::string& address_prefix);

    boost::asio::io_context& context_;
    Listener listener_;
    HttpService service_;
    std::list<HttpConnectionPtr> connections_; // the oldest first
    bool closed_ = false;
};

} // namespace evod::network
