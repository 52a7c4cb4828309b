#include "proto/codec/framing.h"

#include "proto/codec/little_endian.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>

#include <algorithm>
#include <limits>

namespace evod::codec {

namespace {

constexpr std::array<std::byte, 3> prefix{std::byte{'E'}, std::byte{'V'}, std::byte{1}};

/// Returns the error in the first bytes of a header, if there is one. The header may be incomplete.
std::optional<Damage> damage_of_prefix(std::span<const std::byte> bytes) {
    for (std::size_t i = 0; i < std::min<std::size_t>(2, bytes.size()); ++i) {
        if (bytes[i] != prefix[i]) {
            return Damage{
                "a frame must begin with 'EV': the stream is not in the protocol of evod, or bytes were lost"};
        }
    }
    if (bytes.size() > 2 && bytes[2] != prefix[2]) {
        return Damage{"a frame has framing version " + std::to_string(std::to_integer<int>(bytes[2])) + ", not 1"};
    }
    return std::nullopt;
}

Result<std::uint32_t> limit_of(std::byte channel, const FrameLimits& limits) {
    const int number = std::to_integer<int>(channel);
    if (number == static_cast<int>(Channel::Control) && limits.control_bytes_max) {
        return *limits.control_bytes_max;
    }
    if (number == static_cast<int>(Channel::Stream) && limits.stream_bytes_max) {
        return *limits.stream_bytes_max;
    }
    return Damage{"a frame is on channel " + std::to_string(number) + ", which is not used in this direction"};
}

/// Returns whether the rest of a message nests messages and groups more than `levels` deep. Checks up to the first
/// invalid byte.
///
/// of  the type of the message; nullptr: the type is unknown, so only groups can be recognised.
bool is_deeper(google::protobuf::io::CodedInputStream& in, const google::protobuf::Descriptor* of, int levels) {
    using google::protobuf::internal::WireFormatLite;
    while (const std::uint32_t tag = in.ReadTag()) {
        const auto type = WireFormatLite::GetTagWireType(tag);
        if (type == WireFormatLite::WIRETYPE_END_GROUP) {
            return false;
        }
        if (type == WireFormatLite::WIRETYPE_START_GROUP) {
            if (levels == 0 || is_deeper(in, nullptr, levels - 1)) {
                return true;
            }
            continue;
        }
        const auto* field = of == nullptr ? nullptr : of->FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
        if (type != WireFormatLite::WIRETYPE_LENGTH_DELIMITED || field == nullptr || field->message_type() == nullptr) {
            if (!WireFormatLite::SkipField(&in, tag)) {
                return false;
            }
            continue;
        }
        int bytes = 0;
        if (!in.ReadVarintSizeAsInt(&bytes)) {
            return false;
        }
        if (levels == 0) {
            return true;
        }
        const auto rest = in.PushLimit(bytes);
        if (is_deeper(in, field->message_type(), levels - 1)) {
            return true;
        }
        in.PopLimit(rest);
    }
    return false;
}

} // namespace

Damage damage_of_body(std::span<const std::byte> body, const google::protobuf::Descriptor& message) {
    const std::string frame = "the body of a frame of " + std::to_string(body.size()) + " bytes ";
    google::protobuf::io::CodedInputStream in{reinterpret_cast<const std::uint8_t*>(body.data()),
                                              static_cast<int>(body.size())};
    if (is_deeper(in, &message, message_depth_max)) {
        return {.what = frame + "nests messages more than " + std::to_string(message_depth_max) + " deep",
                .exceeded = ExceededLimit::MessageDepth};
    }
    return {.what = frame + "is not a " + message.full_name()};
}

std::array<std::byte, header_bytes> encode_header(FrameHeader header) {
    std::array<std::byte, header_bytes> bytes{prefix[0], prefix[1], prefix[2], static_cast<std::byte>(header.channel)};
    store(header.body_bytes, bytes.data() + 4);
    return bytes;
}

Result<FrameHeader> decode_header(std::span<const std::byte, header_bytes> bytes, const FrameLimits& limits) {
    if (auto damage = damage_of_prefix(bytes)) {
        return *std::move(damage);
    }
    const auto limit = limit_of(bytes[3], limits);
    if (!limit) {
        return limit.error();
    }
    const auto body_bytes = load<std::uint32_t>(bytes.data() + 4);
    if (body_bytes > *limit) {
        return Damage{.what = "a frame declares " + std::to_string(body_bytes) +
                              " bytes, allowed on its channel: at most " + std::to_string(*limit),
                      .exceeded = ExceededLimit::FrameBytes};
    }
    return FrameHeader{.channel = static_cast<Channel>(bytes[3]), .body_bytes = body_bytes};
}

std::string encode_frame(Channel channel, const google::protobuf::MessageLite& message) {
    const auto body_bytes = static_cast<std::uint32_t>(message.ByteSizeLong());
    const auto header = encode_header({.channel = channel, .body_bytes = body_bytes});
    std::string frame;
    frame.reserve(header_bytes + body_bytes);
    frame.append(reinterpret_cast<const char*>(header.data()), header_bytes);
    message.AppendToString(&frame);
    return frame;
}

void FrameReader::feed(std::span<const std::byte> bytes) {
    if (damage_) {
        return;
    }
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    // Frees the memory that a long snapshot needed, so that it does not stay allocated until the connection ends.
    constexpr std::size_t kept_bytes = 1 << 20;
    if (buffer_.empty() && buffer_.capacity() > kept_bytes && bytes.size() < kept_bytes / 2) {
        buffer_ = std::vector<std::byte>{};
    }
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

void FrameReader::trim() {
    constexpr std::size_t kept_bytes = 16 << 10;
    if (buffered_bytes() == 0 && buffer_.capacity() > kept_bytes) {
        buffer_ = std::vector<std::byte>{};
        begin_ = 0;
    }
}

Result<std::optional<Frame>> FrameReader::next() {
    if (damage_) {
        return *damage_;
    }
    const auto rest = std::span<const std::byte>{buffer_}.subspan(begin_);
    const auto fail = [&](Damage damage) {
        damage_ = std::move(damage);
        buffer_ = std::vector<std::byte>{};
        begin_ = 0;
        return *damage_;
    };
    if (rest.size() < header_bytes) {
        if (auto damage = damage_of_prefix(rest)) {
            return fail(*std::move(damage));
        }
        if (rest.size() > 3) {
            if (const auto limit = limit_of(rest[3], limits_); !limit) {
                return fail(limit.error());
            }
        }
        return std::optional<Frame>{};
    }
    const auto header = decode_header(rest.first<header_bytes>(), limits_);
    if (!header) {
        return fail(header.error());
    }
    if (rest.size() - header_bytes < header->body_bytes) {
        return std::optional<Frame>{};
    }
    begin_ += header_bytes + header->body_bytes;
    return std::optional{Frame{.channel = header->channel, .body = rest.subspan(header_bytes, header->body_bytes)}};
}

} // namespace evod::codec
