#include "proto/codec/framing.h"

#include "evod/v1/session.pb.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace evod::codec {
namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span{text});
}
std::string text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string raw_frame(Channel channel, const std::string& body) {
    const auto header = encode_header({.channel = channel, .body_bytes = static_cast<std::uint32_t>(body.size())});
    return text_of(header) + body;
}

std::array<std::byte, header_bytes> header_of(std::array<int, 8> values) {
    std::array<std::byte, header_bytes> header;
    std::ranges::transform(values, header.begin(), [](int value) { return static_cast<std::byte>(value); });
    return header;
}

/// Nested groups of an unknown field.
std::string groups(int count) {
    std::string begin, end;
    for (int i = 0; i < count; ++i) {
        begin += "\xa3\x06"; // field 100
        end += "\xa4\x06";
    }
    return begin + end;
}

/// Bytes or a message as field `number`.
std::string within(char number, const std::string& body) {
    EXPECT_LT(body.size(), 128u * 128u);
    return std::string{static_cast<char>(number << 3 | 2)} + static_cast<char>(body.size() % 128 + 128) +
           static_cast<char>(body.size() / 128) + body;
}

TEST(Body, IsParsedDownToTheDepthLimit) {
    using evod::v1::ClientMessage;
    for (const auto& body : {groups(message_depth_max), within(2, groups(message_depth_max - 1))}) {
        EXPECT_TRUE(parse_body<ClientMessage>(bytes_of(body)));
    }
    for (const auto& body : {groups(message_depth_max + 1), within(2, groups(message_depth_max)), groups(200'000),
                             within(2, within(10, groups(message_depth_max - 1)))}) {
        const auto deep = parse_body<ClientMessage>(bytes_of(body));
        ASSERT_FALSE(deep);
        EXPECT_EQ(deep.error().exceeded, ExceededLimit::MessageDepth) << deep.error().what;
        EXPECT_NE(deep.error().what.find("more than 100 deep"), std::string::npos) << deep.error().what;
    }
}

TEST(Body, DamageIsNotReportedAsDepth) {
    using evod::v1::ClientMessage;
    for (const std::string body : {"\xff\xff\xff", "\x12\x7f", "\xa4\x06", "\x12\x04\x12\x02\xff\xfe"}) {
        const auto damaged = parse_body<ClientMessage>(bytes_of(body));
        ASSERT_FALSE(damaged);
        EXPECT_EQ(damaged.error().exceeded, ExceededLimit::Nothing) << damaged.error().what;
        EXPECT_NE(damaged.error().what.find("is not a evod.v1.ClientMessage"), std::string::npos);
    }
    // A string that looks like nested messages is not a message.
    ClientMessage named;
    named.mutable_hello()->set_token("\x12\x04\x12\x02\x12");
    EXPECT_TRUE(parse_body<ClientMessage>(bytes_of(named.SerializeAsString())));
}

TEST(Header, IsEightBytesWithALittleEndianLength) {
    EXPECT_EQ(encode_header({.channel = Channel::Stream, .body_bytes = 0x01020304}),
              header_of({'E', 'V', 1, 2, 4, 3, 2, 1}));
    const auto decoded = decode_header(header_of({'E', 'V', 1, 1, 4, 3, 2, 0}), client_limits);
    ASSERT_TRUE(decoded) << decoded.error().what;
    EXPECT_EQ(*decoded, (FrameHeader{.channel = Channel::Control, .body_bytes = 0x020304}));
}

TEST(Header, AWrongLetterVersionOrChannelIsDamage) {
    for (const auto& header : {header_of({'X', 'V', 1, 1, 0, 0, 0, 0}), header_of({'E', 'v', 1, 1, 0, 0, 0, 0}),
                               header_of({'E', 'V', 2, 1, 0, 0, 0, 0}), header_of({'E', 'V', 1, 0, 0, 0, 0, 0}),
                               header_of({'E', 'V', 1, 3, 0, 0, 0, 0})}) {
        EXPECT_FALSE(decode_header(header, client_limits));
    }
}

TEST(Header, StreamFramesOfAClientAreRefused) {
    EXPECT_FALSE(decode_header(header_of({'E', 'V', 1, 2, 0, 0, 0, 0}), server_limits));
}

TEST(Header, TheLimitIsInclusive) {
    for (const auto& [limits, channel, limit] : {std::tuple{hello_limits, Channel::Control, 4U << 10},
                                                 {server_limits, Channel::Control, 1U << 20},
                                                 {client_limits, Channel::Control, 64U << 20},
                                                 {client_limits, Channel::Stream, 256U << 20}}) {
        EXPECT_TRUE(decode_header(encode_header({.channel = channel, .body_bytes = limit}), limits));
        EXPECT_FALSE(decode_header(encode_header({.channel = channel, .body_bytes = limit + 1}), limits));
    }
}

RC_GTEST_PROP(FrameReader, ReturnsFramesFromBytesInAnyPieces, (const std::vector<std::pair<bool, std::string>>& sent)) {
    std::string stream;
    for (const auto& [control, body] : sent) {
        stream += raw_frame(control ? Channel::Control : Channel::Stream, body);
    }
    FrameReader reader{client_limits};
    std::vector<std::pair<bool, std::string>> received;
    std::string_view rest = stream;
    while (!rest.empty()) {
        const auto length = *rc::gen::inRange<std::size_t>(1, std::min<std::size_t>(rest.size(), 40) + 1);
        reader.feed(bytes_of(rest.substr(0, length)));
        rest.remove_prefix(length);
        for (;;) {
            const auto frame = reader.next();
            RC_ASSERT(frame.has_value());
            if (!*frame) {
                break;
            }
            received.emplace_back((*frame)->channel == Channel::Control, text_of((*frame)->body));
        }
    }
    RC_ASSERT(received == sent);
    RC_ASSERT(reader.buffered_bytes() == 0U);
}

TEST(FrameReader, DetectsTheFirstWrongByte) {
    for (const std::string wrong : {"G", "EX", "EV\x02", "EV\x01\x07"}) {
        FrameReader reader{client_limits};
        reader.feed(bytes_of(raw_frame(Channel::Control, "first") + wrong));
        const auto first = reader.next();
        ASSERT_TRUE(first && *first);
        EXPECT_EQ(text_of((*first)->body), "first");
        EXPECT_FALSE(reader.next());
        reader.feed(bytes_of(raw_frame(Channel::Control, "later")));
        EXPECT_FALSE(reader.next()) << "there is no way back into step";
        EXPECT_EQ(reader.buffered_bytes(), 0U);
    }
}

TEST(FrameReader, ADeclaredLengthTakesNoMemory) {
    FrameReader reader{client_limits};
    reader.feed(encode_header({.channel = Channel::Stream, .body_bytes = 256U << 20}));
    const auto frame = reader.next();
    ASSERT_TRUE(frame);
    EXPECT_FALSE(*frame);
    EXPECT_LT(reader.capacity_bytes(), 1024U);

    FrameReader strict{hello_limits};
    strict.feed(encode_header({.channel = Channel::Control, .body_bytes = 5000}));
    EXPECT_FALSE(strict.next()) << "the length is refused before the body arrives";
}

TEST(FrameReader, FreesTheMemoryOfALongFrame) {
    FrameReader reader{client_limits};
    reader.feed(bytes_of(raw_frame(Channel::Stream, std::string(8 << 20, 'x'))));
    EXPECT_TRUE(*reader.next());
    reader.feed(bytes_of(raw_frame(Channel::Control, "short")));
    EXPECT_TRUE(*reader.next());
    EXPECT_LT(reader.capacity_bytes(), 1U << 20);
}

TEST(FrameReader, NewLimitsApplyToReceivedFrames) {
    FrameReader reader{hello_limits};
    reader.feed(bytes_of(raw_frame(Channel::Control, "hello") + raw_frame(Channel::Control, std::string(5000, 'x'))));
    EXPECT_TRUE(*reader.next());
    reader.set_limits(server_limits);
    const auto second = reader.next();
    ASSERT_TRUE(second) << second.error().what;
    EXPECT_TRUE(*second);
}

TEST(Body, ParsesAMessageAndRefusesOtherBytes) {
    evod::v1::ClientMessage message;
    message.mutable_hello()->set_client_name("a test");
    FrameReader reader{hello_limits};
    reader.feed(bytes_of(encode_frame(Channel::Control, message)));
    const auto frame = reader.next();
    ASSERT_TRUE(frame && *frame);
    const auto parsed = parse_body<evod::v1::ClientMessage>((*frame)->body);
    ASSERT_TRUE(parsed);
    EXPECT_EQ(parsed->hello().client_name(), "a test");
    const auto damaged = parse_body<evod::v1::ClientMessage>(bytes_of("\xff\xff\xff"));
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().what, "the body of a frame of 3 bytes is not a evod.v1.ClientMessage");
}

} // namespace
} // namespace evod::codec
