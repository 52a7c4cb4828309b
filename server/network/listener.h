// Listener: the port, and a session for each connection that comes.
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
    /// Takes the port; says what to do about it if that cannot be.
    ///
    /// address   of an interface: "127.0.0.1", "0.0.0.0", "::1".
    /// port      0: any that is free.
    /// names     the options by which a person chooses these.
    struct Names {
        const char* address = "--bind";
        const char* port = "--port";
    };
    /// Refused if that is no address; nothing is opened. option: by which a person chooses it.
    static base::Result<void> check(const std::string& address, const char* option);
    static base::Result<Listener> open(boost::asio::io_context& context, const std::string& address, std::uint16_t port,
                                       const Names& names);
    static base::Result<Listener> open(boost::asio::io_context& context, const std::string& address,
                                       std::uint16_t port) {
        return open(context, address, port, Names{});
    }

    boost::asio::ip::tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }

    /// Accepts until close(). accepted: called for each connection.
    boost::asio::awaitable<void> accept(std::function<void(boost::asio::ip::tcp::socket)> accepted);

    void close();

  private:
    explicit Listener(boost::asio::ip::tcp::acceptor acceptor) : acceptor_{std::move(acceptor)} {}

    boost::asio::ip::tcp::acceptor acceptor_;
};

} // namespace evod::network
