#include "server/network/websocket.h"

#include "server/base/assert.h"

#include <openssl/evp.h>
#include <openssl/sha.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace evod::network {
namespace {

constexpr std::uint8_t final_bit = 0x80, reserved_bits = 0x70, opcode_bits = 0x0f;
constexpr std::uint8_t mask_bit = 0x80, length_bits = 0x7f;
constexpr std::uint8_t length_16 = 126, length_64 = 127; // the length follows in 2 or 8 bytes
constexpr std::uint8_t binary = 2, close_frame = 8, ping = 9, pong = 10;

/// Whether an endpoint may send this code in a Close frame, RFC 6455 section 7.4.
bool may_be_sent(unsigned code) {
    constexpr unsigned reserved_last = 2999, last = 4999;
    return (code >= 1000 && code <= 1014 && code != 1004 && code != 1005 && code != 1006) ||
           (code > reserved_last && code <= last);
}

std::string control_frame(std::uint8_t opcode, std::string_view payload) {
    constexpr std::size_t payload_bytes_max = 125;
    EVOD_ASSERT(payload.size() <= payload_bytes_max);
    std::string frame;
    frame += static_cast<char>(final_bit | opcode);
    frame += static_cast<char>(payload.size());
    return frame.append(payload);
}

} // namespace

std::size_t WebSocketDecoder::decode(std::span<std::byte> bytes) {
    std::size_t decoded = 0;
    for (std::size_t at = 0; !fault_ && !closed_ && (at < bytes.size() || (within_frame_ && payload_left_ == 0));) {
        if (!within_frame_) {
            header_[header_count_++] = bytes[at++];
            if (header_count_ >= 2 && header_count_ == header_bytes()) {
                begin_frame();
            }
            continue;
        }
        const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(payload_left_, bytes.size() - at));
        std::byte* to = bytes.data() + decoded;
        if (is_control()) {
            to = control_.data() + control_count_;
            control_count_ += count;
        } else {
            decoded += count;
        }
        for (std::size_t i = 0; i < count; ++i) {
            to[i] = bytes[at + i] ^ mask_[(mask_index_ + i) % mask_.size()];
        }
        mask_index_ = (mask_index_ + count) % mask_.size();
        at += count;
        payload_left_ -= count;
        if (payload_left_ == 0) {
            end_frame();
        }
    }
    return decoded;
}

std::size_t WebSocketDecoder::header_bytes() const {
    const auto length = std::to_integer<std::uint8_t>(header_[1]) & length_bits;
    const bool masked = (std::to_integer<std::uint8_t>(header_[1]) & mask_bit) != 0;
    return 2 + (length == length_16 ? 2U : length == length_64 ? 8U : 0U) + (masked ? mask_.size() : 0U);
}

void WebSocketDecoder::begin_frame() {
    const auto first = std::to_integer<std::uint8_t>(header_[0]);
    const auto second = std::to_integer<std::uint8_t>(header_[1]);
    const auto short_length = static_cast<std::uint8_t>(second & length_bits);
    const auto opcode = static_cast<std::uint8_t>(first & opcode_bits);
    const bool is_known = opcode <= binary || (opcode >= close_frame && opcode <= pong);
    opcode_ = static_cast<Opcode>(opcode);
    final_ = (first & final_bit) != 0;
    const std::size_t header_count = std::exchange(header_count_, 0);
    if ((first & reserved_bits) != 0 || !is_known) {
        return fail(WebSocketClose::ProtocolError, "a WebSocket frame has an unknown opcode or a reserved bit");
    }
    if ((second & mask_bit) == 0) {
        return fail(WebSocketClose::ProtocolError, "a WebSocket frame of a client is not masked");
    }
    const std::size_t mask_at = header_count - mask_.size();
    std::uint64_t length = short_length < length_16 ? short_length : 0;
    for (std::size_t i = 2; i < mask_at; ++i) {
        length = length << 8 | std::to_integer<std::uint8_t>(header_[i]);
    }
    if ((short_length == length_16 && length < length_16) || (short_length == length_64 && length <= 0xffff) ||
        length >> 63 != 0) {
        return fail(WebSocketClose::ProtocolError,
                    "the length of a WebSocket frame is not encoded in the shortest way");
    }
    if (is_control() && (!final_ || length > control_bytes_max)) {
        return fail(WebSocketClose::ProtocolError, "a WebSocket control frame is fragmented or longer than 125 bytes");
    }
    if (opcode_ == Opcode::Text) {
        return fail(WebSocketClose::UnsupportedData, "got a WebSocket text message, allowed are binary messages");
    }
    if (!is_control() && within_message_ != (opcode_ == Opcode::Continuation)) {
        return fail(WebSocketClose::ProtocolError, within_message_
                                                       ? "a WebSocket message begins before the one before has ended"
                                                       : "a WebSocket fragment continues no message");
    }
    std::copy_n(header_.begin() + static_cast<std::ptrdiff_t>(mask_at), mask_.size(), mask_.begin());
    mask_index_ = 0;
    payload_left_ = length;
    control_count_ = 0;
    within_frame_ = true;
    if (is_control() || length == 0) {
        ++empty_frame_count_;
    }
}

void WebSocketDecoder::end_frame() {
    within_frame_ = false;
    if (!is_control()) {
        within_message_ = !final_;
        return;
    }
    if (opcode_ == Opcode::Ping) {
        ping_.emplace(reinterpret_cast<const char*>(control_.data()), control_count_);
    } else if (opcode_ == Opcode::Close) {
        const unsigned code = std::to_integer<unsigned>(control_[0]) << 8 | std::to_integer<unsigned>(control_[1]);
        if (control_count_ == 1 || (control_count_ >= 2 && !may_be_sent(code))) {
            return fail(WebSocketClose::ProtocolError, "a WebSocket Close frame has an invalid code");
        }
        closed_ = true;
    }
}

std::optional<std::string> WebSocketDecoder::take_ping() {
    return std::exchange(ping_, std::nullopt);
}

std::uint64_t WebSocketDecoder::take_empty_frame_count() {
    return std::exchange(empty_frame_count_, 0);
}

WebSocketHeader binary_message_header(std::uint64_t payload_bytes) {
    WebSocketHeader header;
    const auto add = [&](std::uint64_t byte) { header.bytes[header.size++] = static_cast<std::byte>(byte); };
    add(final_bit | binary);
    int length_bytes = 0;
    if (payload_bytes < length_16) {
        add(payload_bytes);
    } else if (payload_bytes <= 0xffff) {
        add(length_16);
        length_bytes = 2;
    } else {
        add(length_64);
        length_bytes = 8;
    }
    for (int i = length_bytes - 1; i >= 0; --i) {
        add(payload_bytes >> 8 * i & 0xff);
    }
    return header;
}

std::string encode_ping() {
    return control_frame(ping, {});
}

std::string encode_pong(std::string_view payload) {
    return control_frame(pong, payload);
}

std::string encode_close(WebSocketClose code) {
    const auto number = static_cast<std::uint16_t>(code);
    const char payload[] = {static_cast<char>(number >> 8), static_cast<char>(number & 0xff)};
    return control_frame(close_frame, {payload, sizeof payload});
}

std::optional<std::string> websocket_accept(std::string_view key) {
    constexpr std::size_t key_bytes = 24; // Base64 of 16 bytes
    constexpr int decoded_bytes = 18;     // with the two bytes that the padding stands for
    std::array<unsigned char, decoded_bytes> decoded{};
    const auto bytes_of = [](std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); };
    if (key.size() != key_bytes || !key.ends_with("==") || key.find('=') != key_bytes - 2 ||
        EVP_DecodeBlock(decoded.data(), bytes_of(key), static_cast<int>(key.size())) != decoded_bytes) {
        return std::nullopt;
    }
    const std::string joined = std::string{key} + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"; // RFC 6455 section 4.2.2
    std::array<unsigned char, SHA_DIGEST_LENGTH> hash{};
    SHA1(bytes_of(joined), joined.size(), hash.data());
    std::array<unsigned char, 4 * ((SHA_DIGEST_LENGTH + 2) / 3) + 1> text{};
    const int length = EVP_EncodeBlock(text.data(), hash.data(), static_cast<int>(hash.size()));
    return std::string{reinterpret_cast<const char*>(text.data()), static_cast<std::size_t>(length)};
}

} // namespace evod::network
