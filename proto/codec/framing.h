// Framing: messages in a byte stream.
//
// A frame is an 8-byte header and a body:
//
//   byte 0, 1   'E' 'V'
//   byte 2      1, the version of the framing
//   byte 3      channel: 1 control (ClientMessage, ServerMessage), 2 stream (SnapshotFrame)
//   byte 4..7   length of the body in bytes, unsigned, least significant byte first
//
// The reader checks the two letters, the version and the channel of every header, so it detects a stream that is out of
// step at the next frame. It cannot resynchronise, so the connection ends. It checks the length against the limit of the
// channel before it allocates memory for the body.
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

constexpr std::uint32_t protocol_version = 1; // of Hello and Welcome
constexpr std::uint16_t default_port = 7744;

enum class Channel : std::uint8_t { Control = 1, Stream = 2 };

constexpr std::size_t header_bytes = 8;

struct FrameHeader {
    Channel channel = Channel::Control;
    std::uint32_t body_bytes = 0;
    friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

/// The longest body that is accepted on each channel; nullopt: the channel is not used in this direction.
struct FrameLimits {
    std::optional<std::uint32_t> control_bytes_max;
    std::optional<std::uint32_t> stream_bytes_max;
};

/// What a server accepts before the hello, and after it.
constexpr FrameLimits hello_limits{.control_bytes_max = 4 << 10, .stream_bytes_max = std::nullopt};
constexpr FrameLimits server_limits{.control_bytes_max = 1 << 20, .stream_bytes_max = std::nullopt};
/// What a client accepts; a Description or a History can be long.
constexpr FrameLimits client_limits{.control_bytes_max = 64 << 20, .stream_bytes_max = 256 << 20};

std::array<std::byte, header_bytes> encode_header(FrameHeader header);

/// Damage names the invalid part of the header: magic, version, channel or length.
Result<FrameHeader> decode_header(std::span<const std::byte, header_bytes> bytes, const FrameLimits& limits);

/// Header and message as one string of bytes.
std::string encode_frame(Channel channel, const google::protobuf::MessageLite& message);

/// The deepest nesting of messages that protobuf parses.
constexpr int message_depth_max = 100;

/// Why the body of a frame could not be parsed as this message.
Damage damage_of_body(std::span<const std::byte> body, const google::protobuf::Descriptor& message);

/// A message from the body of a frame.
template <class Message>
Result<Message> parse_body(std::span<const std::byte> body) {
    Message message;
    if (!message.ParseFromArray(body.data(), static_cast<int>(body.size()))) {
        return damage_of_body(body, *Message::descriptor());
    }
    return message;
}

/// One frame, as a view into its reader.
struct Frame {
    Channel channel;
    std::span<const std::byte> body; // valid until the reader is fed again
};

/// Cuts a byte stream into frames, whatever the pieces in which it arrives. Memory is bounded by the bytes received, not by
/// the declared lengths.
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

    /// Adds bytes; ignored once the stream is damaged.
    void feed(std::span<const std::byte> bytes);

    /// The next complete frame; nullopt if more bytes are needed. Damage is permanent.
    Result<std::optional<Frame>> next();

    /// Frees the memory of a long frame after it has been returned completely.
    void trim();

    /// Applies to frames that next() has not returned: the limits of a server change after the hello.
    void set_limits(FrameLimits limits) { limits_ = limits; }

    /// Bytes received and not yet returned by next().
    std::size_t buffered_bytes() const { return buffer_.size() - begin_; }
    /// Bytes of memory in use.
    std::size_t capacity_bytes() const { return buffer_.capacity(); }

  private:
    FrameLimits limits_;
    std::vector<std::byte> buffer_;
    std::size_t begin_ = 0; // of the bytes that next() has not returned
    std::optional<Damage> damage_;
};

} // namespace evod::codec
