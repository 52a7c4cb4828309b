// WebSocket: the server's half of the framing of RFC 6455. Decodes masked frames of a client and encodes the headers of
// the server's frames. transport.h sends and receives the bytes, http_connection.h performs the handshake.
//
// Boost.Beast's websocket::stream is not used: it answers pings within its reads, so that a snapshot cannot be written
// to an idle socket at once, and it skips pings, empty messages and empty fragments without a limit.
//
// Owner        a transport, on the network thread.
// Full         stores one header and the payload of one control frame. The content of messages is never stored: the
//              boundaries of messages have no meaning, because codec::FrameReader finds the frames in the bytes.
// Source       RFC 6455.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace evod::network {

/// Why a WebSocket connection ends, RFC 6455 section 7.4.1.
enum class WebSocketClose : std::uint16_t {
    Normal = 1000,
    GoingAway = 1001,
    ProtocolError = 1002,
    UnsupportedData = 1003, // a text message
    PolicyViolation = 1008, // refused: no Hello, unknown token, too many sessions, ...
    MessageTooBig = 1009,
};

/// Decodes the bytes of a client.
class WebSocketDecoder {
  public:
    struct Fault {
        WebSocketClose code;
        std::string_view what; // constant text
    };

    /// Decodes bytes in place: moves the content of binary messages to the front. Decodes nothing more after a fault or
    /// a Close frame.
    ///
    /// returns  the number of bytes at the front.
    std::size_t decode(std::span<std::byte> bytes);

    /// What is wrong with the bytes; nullopt: nothing so far.
    const std::optional<Fault>& fault() const { return fault_; }
    /// Whether the client has sent a Close frame.
    bool closed() const { return closed_; }
    /// Returns the payload of the newest ping if it was not taken yet. A server need not answer earlier ones.
    std::optional<std::string> take_ping();
    /// Returns the number of frames without content since the last call: control frames and empty fragments.
    std::uint64_t take_empty_frame_count();

  private:
    enum class Opcode : std::uint8_t { Continuation = 0, Text = 1, Binary = 2, Close = 8, Ping = 9, Pong = 10 };
    static constexpr std::size_t header_bytes_max = 14, control_bytes_max = 125;

    bool is_control() const { return (static_cast<unsigned>(opcode_) & 8U) != 0; }
    /// The size of the header, as far as its first bytes determine it.
    std::size_t header_bytes() const;
    void begin_frame();
    void end_frame();
    void fail(WebSocketClose code, std::string_view what) { fault_ = {code, what}; }

    std::array<std::byte, header_bytes_max> header_{};
    std::size_t header_count_ = 0; // bytes of the header that have arrived
    bool within_frame_ = false;    // the header is complete, the payload is not
    Opcode opcode_ = Opcode::Continuation;
    bool final_ = false, within_message_ = false;
    std::uint64_t payload_left_ = 0;
    std::array<std::byte, 4> mask_{};
    std::size_t mask_index_ = 0;
    std::array<std::byte, control_bytes_max> control_{};
    std::size_t control_count_ = 0;

    std::optional<Fault> fault_;
    bool closed_ = false;
    std::optional<std::string> ping_;
    std::uint64_t empty_frame_count_ = 0;
};

/// The header of a frame that the server sends.
struct WebSocketHeader {
    std::array<std::byte, 10> bytes{};
    std::size_t size = 0;

    std::string_view view() const { return {reinterpret_cast<const char*>(bytes.data()), size}; }
};

/// The header of a binary message in one frame.
WebSocketHeader binary_message_header(std::uint64_t payload_bytes);
/// A complete frame. `payload` has at most 125 bytes.
std::string encode_ping();
std::string encode_pong(std::string_view payload);
std::string encode_close(WebSocketClose code);

/// Returns the value of Sec-WebSocket-Accept that answers a Sec-WebSocket-Key; nullopt if the key is not the Base64 of
/// 16 bytes.
std::optional<std::string> websocket_accept(std::string_view key);

} // namespace evod::network
