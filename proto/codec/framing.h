// Framing: divides a byte stream into messages.
//
// A frame consists of an 8-byte header and a body:
//
//   byte 0, 1   'E' 'V'
//   byte 2      1, the version of the framing
//   byte 3      channel: 1 control (ClientMessage, ServerMessage), 2 stream (SnapshotFrame)
//   byte 4..7   length of the body in bytes, unsigned, least significant byte first
//
// The reader checks the two letters, the version and the channel of every header. It therefore notices at the next
// header if it has lost the frame boundaries. It cannot resynchronise, so the connection must end. The reader compares
// the length with the limit of the channel before it allocates memory for the body.
//
// Owner        each end of a connection has its own FrameReader.
// Threads      none; nothing here is shared.
#pragma once

#include "proto/codec/result.h"

#include <google/protobuf/message.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::codec {

constexpr std::uint32_t protocol_version = 1; // the version in Hello and Welcome
constexpr std::uint16_t default_port = 7744;

enum class Channel : std::uint8_t { Control = 1, Stream = 2 };

constexpr std::size_t header_bytes = 8;

struct FrameHeader {
    Channel channel = Channel::Control;
    std::uint32_t body_bytes = 0;
    friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

/// The largest body that is accepted on each channel; nullopt: the channel is not used in this direction.
struct FrameLimits {
    std::optional<std::uint32_t> control_bytes_max;
    std::optional<std::uint32_t> stream_bytes_max;
};

/// The limits of a server before and after the Hello.
constexpr FrameLimits hello_limits{.control_bytes_max = 4 << 10, .stream_bytes_max = std::nullopt};
constexpr FrameLimits server_limits{.control_bytes_max = 1 << 20, .stream_bytes_max = std::nullopt};
/// The limits of a client. A Description or a History can be long.
constexpr FrameLimits client_limits{.control_bytes_max = 64 << 20, .stream_bytes_max = 256 << 20};

std::array<std::byte, header_bytes> encode_header(FrameHeader header);

/// Decodes a header. Damage names the invalid part: magic, version, channel or length.
Result<FrameHeader> decode_header(std::span<const std::byte, header_bytes> bytes, const FrameLimits& limits);

/// Encodes the header and the message as one string of bytes.
std::string encode_frame(Channel channel, const google::protobuf::MessageLite& message);

/// Protobuf does not parse messages that are nested deeper than this.
constexpr int message_depth_max = 100;

/// Explains why the body of a frame could not be parsed as this message.
Damage damage_of_body(std::span<const std::byte> body, const google::protobuf::Descriptor& message);

/// Parses a message from the body of a frame.
template <class Message>
Result<Message> parse_body(std::span<const std::byte> body) {
    Message message;
    if (!message.ParseFromArray(body.data(), static_cast<int>(body.size()))) {
        return damage_of_body(body, *Message::descriptor());
    }
    return message;
}

/// One frame. It points into the memory of its reader.
struct Frame {
    Channel channel;
    std::span<const std::byte> body; // valid until feed() or trim() is called
};

/// Divides a byte stream into frames, whatever the sizes of the pieces in which the bytes arrive. Its memory is bounded
/// by the number of bytes received, not by the lengths that headers declare.
///
///     reader.feed(bytes);
///     for (;;) {
///         const auto frame = reader.next();
///         if (!frame) … the stream is damaged: close the connection
///         if (!*frame) break; // needs more bytes
///         … (*frame)->body …
///     }
class FrameReader {
  public:
    explicit FrameReader(FrameLimits limits) : limits_{limits} {}

    /// Adds received bytes. Ignores them after the stream was found to be damaged.
    void feed(std::span<const std::byte> bytes);

    /// Returns the next complete frame; nullopt if more bytes are needed. After Damage every further call returns
    /// Damage.
    Result<std::optional<Frame>> next();

    /// Frees the memory of a long frame after all its bytes were returned.
    void trim();

    /// Sets limits for all frames that next() has not returned yet. A server changes its limits after the Hello.
    void set_limits(FrameLimits limits) { limits_ = limits; }

    /// Returns the number of received bytes that next() has not returned yet.
    std::size_t buffered_bytes() const { return buffer_.size() - begin_; }
    /// Returns the number of bytes of memory in use.
    std::size_t capacity_bytes() const { return buffer_.capacity(); }

  private:
    FrameLimits limits_;
    std::vector<std::byte> buffer_;
    std::size_t begin_ = 0; // offset of the first byte that next() has not returned
    std::optional<Damage> damage_;
};

} // namespace evod::codec
