// Transport: sends and receives the bytes of one connection: plain or through TLS, and on top of that possibly in the
// binary messages of a WebSocket. The bytes are the same in each case; messages need not be frames.
//
// Owner        an HTTP connection, then perhaps a session, on the network thread. At most one read and one write are in
//              progress.
#pragma once

#include "server/network/websocket.h"

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

    /// Must be called first; later calls do nothing. Performs the TLS handshake. Returns not_tls() if a client sends
    /// plain bytes to a TLS server; the connection then continues without TLS, so that the server can send its refusal.
    asio::awaitable<boost::system::error_code> begin();
    static boost::system::error_code not_tls();

    /// From now on all bytes travel in WebSocket messages. The handshake must be complete.
    ///
    /// received  what has already been received after the client's handshake.
    void begin_websocket(std::string received);
    bool is_websocket() const { return websocket_.has_value(); }

    /// With a WebSocket it may return no bytes and no error: the client has sent frames without content. It returns
    /// websocket_fault() after the bytes before an invalid frame, and eof after those before a Close frame.
    asio::awaitable<Transferred> read_some(asio::mutable_buffer buffer);
    static boost::system::error_code websocket_fault();
    /// Reads bytes as they arrive, even those of a WebSocket.
    asio::awaitable<Transferred> receive_some(asio::mutable_buffer buffer);
    /// Writes as many bytes as the system accepts without waiting, possibly none. Accepts at most buffers_at_once
    /// buffers. With TLS it writes nothing. The next call must be write() with the rest of the buffers, if there is
    /// one.
    Transferred write_now(std::span<const asio::const_buffer> buffers);
    static constexpr std::size_t buffers_at_once = 16;
    /// Writes all buffers, after the WebSocket control frames that wait.
    asio::awaitable<Transferred> write(const std::vector<asio::const_buffer>& buffers);

    /// What is wrong with the frames of the client; nullopt: nothing, or this is not a WebSocket.
    std::optional<WebSocketDecoder::Fault> fault() const;
    /// Number of frames without content that the client has sent since the last call; 0 if this is not a WebSocket.
    std::uint64_t take_empty_frame_count();
    /// Whether control frames wait for the next write(), which may be one without buffers.
    bool control_waits() const { return websocket_ && (websocket_->ping_due || websocket_->pong); }
    /// Sends a ping with the next write(). Only for a WebSocket.
    void ping();

    /// States how much data was sent. While data waits to be sent, two equal values mean that the peer received nothing
    /// in between.
    struct Progress {
        std::uint64_t given = 0;     // number of bytes passed to the system
        std::uint64_t not_taken = 0; // number of these bytes that the peer's system has not acknowledged
        bool operator==(const Progress&) const = default;
    };
    Progress progress();

    tcp::socket& socket() { return socket_; }
    /// The peer's address, even after the peer has disconnected.
    const tcp::endpoint& peer() const { return peer_; }
    /// The address of this machine that the peer has connected to.
    tcp::endpoint local() const;
    /// Closes the sending side, a WebSocket with this code. With TLS it waits for the peer's close_notify, so a
    /// concurrent read must be in progress to receive it.
    asio::awaitable<void> finish(WebSocketClose code = WebSocketClose::Normal);
    void close();
    /// Closes the connection at once and discards all data that the peer has not received.
    void abort();

  private:
    struct WebSocket {
        std::string received; // bytes that wait to be decoded
        WebSocketDecoder decoder;
        std::optional<std::string> pong; // the payload of the pong that waits to be sent
        bool ping_due = false;
        // The rest of a message that write_now() has begun: bytes of its header, and number of bytes of its payload.
        std::string header_rest;
        std::size_t message_rest = 0;
        std::string prefix; // what write() sends before its buffers
    };

    asio::awaitable<Transferred> read_messages(asio::mutable_buffer buffer);
    asio::awaitable<Transferred> write_message(const std::vector<asio::const_buffer>& buffers);
    asio::awaitable<Transferred> write_bytes(const std::vector<asio::const_buffer>& buffers);

    tcp::socket socket_;
    const tcp::endpoint peer_;
    std::optional<asio::ssl::stream<tcp::socket&>> tls_;
    std::optional<WebSocket> websocket_;
    bool begun_ = false;
    std::uint64_t given_ = 0;
};

/// Formats an address and a port: "127.0.0.1:51234".
std::string to_text(const tcp::endpoint& endpoint);

/// The part of an address that identifies one site: the IPv4 address, or the /48 prefix of the IPv6 address, because a
/// site has up to 65,536 /64 prefixes (RFC 6177).
std::string address_key(const asio::ip::address& address);

} // namespace evod::network
