// Transport: sends and receives the bytes of one connection, either plain or through TLS.
//
// Owner        a session, on the network thread. At most one read and one write are in progress.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace evod::network {

namespace asio = boost::asio;
using asio::ip::tcp;

class Transport {
  public:
    using Transferred = std::tuple<boost::system::error_code, std::size_t>;

    /// tls  the settings of TLS, which must outlive the transport; nullptr: no TLS.
    Transport(tcp::socket socket, asio::ssl::context* tls);

    /// Must be called first. Performs the TLS handshake. Returns not_tls() if a client sends plain bytes to a TLS
    /// server; the connection then continues without TLS, so that the server can send its refusal.
    asio::awaitable<boost::system::error_code> begin();
    static boost::system::error_code not_tls();

    asio::awaitable<Transferred> read_some(asio::mutable_buffer buffer);
    /// Writes as many bytes as the system accepts without waiting, possibly none. Accepts at most buffers_at_once
    /// buffers. With TLS it writes nothing.
    Transferred write_now(std::span<const asio::const_buffer> buffers);
    static constexpr std::size_t buffers_at_once = 16;
    /// Writes all buffers.
    asio::awaitable<Transferred> write(const std::vector<asio::const_buffer>& buffers);

    /// States how much data was sent. While data waits to be sent, two equal values mean that the peer received nothing
    /// in between.
    struct Progress {
        std::uint64_t given = 0;     // number of bytes passed to the system
        std::uint64_t not_taken = 0; // number of these bytes that the peer's system has not acknowledged
        bool operator==(const Progress&) const = default;
    };
    Progress progress();

    tcp::socket& socket() { return socket_; }
    /// The peer's address; the unspecified address if the peer has disconnected.
    tcp::endpoint peer() const;
    /// Closes the sending side. With TLS it waits for the peer's close_notify, so a concurrent read_some() must be in
    /// progress to receive it.
    asio::awaitable<void> finish();
    void close();
    /// Closes the connection at once and discards all data that the peer has not received.
    void abort();

  private:
    tcp::socket socket_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    std::uint64_t given_ = 0;
};

/// Formats an address and a port: "127.0.0.1:51234".
std::string to_text(const tcp::endpoint& endpoint);

/// The part of an address that identifies one user: the IPv4 address, or the /64 prefix of the IPv6 address.
std::string address_key(const asio::ip::address& address);

} // namespace evod::network
