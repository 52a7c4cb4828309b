// Line: the bytes of one connection, in the clear or through TLS.
//
// Owner     a session; on the network thread. One read and one write may be under way at a time.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

#include <cstdint>
#include <optional>
#include <span>
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
    /// As much of at most buffers_at_once of them as the system takes without waiting, which may be nothing; of TLS it
    /// always is.
    Transferred write_now(std::span<const asio::const_buffer> buffers);
    static constexpr std::size_t buffers_at_once = 16;
    /// All of them.
    asio::awaitable<Transferred> write(const std::vector<asio::const_buffer>& buffers);

    /// Differs from before if the other end has taken anything since.
    struct Progress {
        std::uint64_t given = 0;     // to the system
        std::uint64_t not_taken = 0; // of that, by the other end's system
        bool operator==(const Progress&) const = default;
    };
    Progress progress();

    tcp::socket& socket() { return socket_; }
    /// Says that nothing more is written. One of TLS waits for the other end to say the same, which somebody has to
    /// read meanwhile.
    asio::awaitable<void> finish();
    void close();
    /// Closes, and what the other end has not taken is thrown away: nothing is left of it in the system either.
    void abort();

  private:
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    std::uint64_t given_ = 0;
};

} // namespace evod::network
