// Listener: accepts connections on one port.
//
// Owner        the server, on the network thread.
#pragma once

#include "server/base/result.h"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include <cstdint>
#include <functional>
#include <string>

namespace evod::network {

class Listener {
  public:
    /// The names of the command-line options for the address and the port. Error messages contain them.
    struct Names {
        const char* address = "--bind";
        const char* port = "--port";
    };
    /// Checks that the text is an IP address, without opening a port.
    ///
    /// option  the command-line option for the address, for the message of a refusal.
    static base::Result<void> check(const std::string& address, const char* option);
    /// Opens the port. If that fails, the refusal states how to solve the problem.
    ///
    /// address  the IP address of an interface: "127.0.0.1", "0.0.0.0", "::1".
    /// port     0: any free port.
    static base::Result<Listener> open(boost::asio::io_context& context, const std::string& address, std::uint16_t port,
                                       const Names& names);
    static base::Result<Listener> open(boost::asio::io_context& context, const std::string& address,
                                       std::uint16_t port) {
        return open(context, address, port, Names{});
    }

    boost::asio::ip::tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }

    /// Calls `accepted` for each new connection until close() is called.
    boost::asio::awaitable<void> accept(std::function<void(boost::asio::ip::tcp::socket)> accepted);

    void close();

  private:
    explicit Listener(boost::asio::ip::tcp::acceptor acceptor) : acceptor_{std::move(acceptor)} {}

    boost::asio::ip::tcp::acceptor acceptor_;
};

} // namespace evod::network
