// Line: the bytes of one connection, in the clear or through TLS.
//
// Owner     a session; on the network thread. One read and one write may be under way at a time.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

#include <optional>
#include <tuple>
#include <vector>

namespace evod::network {

namespace asio = boost::asio;
using asio::ip::tcp;

class Line {
  public:
    using Transferred = std::tuple<boost::system::error_code, std::size_t>;

    /// tls  outlives the line; nullptr: in the clear.
    Line(tcp::socket socket, asio::ssl::context* tls);

    /// Before anything else. A client that speaks in the clear to a server of TLS is found out, and is answered so:
    /// then the error is `not_tls`, and what is written goes in the clear.
    asio::awaitable<boost::system::error_code> begin();
    static boost::system::error_code not_tls();

    asio::awaitable<Transferred> read_some(asio::mutable_buffer buffer);
    /// All of them.
    asio::awaitable<Transferred> write(const std::vector<asio::const_buffer>& buffers);

    tcp::socket& socket() { return socket_; }
    /// Nothing more is written.
    void finish();
    void close();

  private:
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
};

} // namespace evod::network
