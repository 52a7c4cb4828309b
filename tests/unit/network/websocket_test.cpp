#include "server/network/websocket.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace evod::network {
namespace {

/// A frame of a client. `first` has the opcode and the bit of the last fragment.
std::string frame(unsigned first, std::string payload, std::string length = "", const std::string& mask = "abcd") {
    if (length.empty()) {
        length = std::string(1, static_cast<char>(payload.size()));
    }
    length[0] = static_cast<char>(length[0] | 0x80);
    for (std::size_t i = 0; i < payload.size(); ++i) {
        payload[i] = static_cast<char>(payload[i] ^ mask[i % 4]);
    }
    return std::string(1, static_cast<char>(first)) + length + mask + payload;
}

constexpr unsigned last = 0x80, continuation = 0, text = 1, binary = 2, close_frame = 8, ping = 9, pong = 10;

/// Decodes bytes in pieces of a size. Returns the content.
std::string decode(WebSocketDecoder& decoder, std::string bytes, std::size_t piece = SIZE_MAX) {
    std::string content;
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t count = std::min(piece, bytes.size() - at);
        std::string part = bytes.substr(at, count);
        content += part.substr(0, decoder.decode(std::as_writable_bytes(std::span{part})));
        at += count;
    }
    return content;
}

WebSocketClose fault_of(const std::string& bytes) {
    WebSocketDecoder decoder;
    decode(decoder, bytes);
    return decoder.fault() ? decoder.fault()->code : WebSocketClose::Normal;
}

TEST(WebSocketDecoder, ReadsContentInPiecesOfAnySize) {
    const std::string all = frame(binary, "one ") + frame(ping, "hidden") + frame(continuation, "") +
                            frame(last | continuation, "two ") + frame(last | binary, "three") +
                            frame(last | binary, std::string(70'000, 'x'), std::string{"\x7f\0\0\0\0\0\1\x11\x70", 9});
    const std::string ping_of_all = frame(last | ping, "hidden");
    std::string sound = all;
    sound.replace(sound.find(frame(ping, "hidden")), ping_of_all.size(), ping_of_all);
    for (const std::size_t piece : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{1000}, sound.size()}) {
        WebSocketDecoder decoder;
        EXPECT_EQ(decode(decoder, sound, piece), "one two three" + std::string(70'000, 'x')) << piece;
        EXPECT_FALSE(decoder.fault());
        EXPECT_FALSE(decoder.closed());
        EXPECT_EQ(decoder.take_ping(), "hidden");
        EXPECT_EQ(decoder.take_ping(), std::nullopt);
        EXPECT_EQ(decoder.take_empty_frame_count(), 2U) << "the ping and the empty fragment";
        EXPECT_EQ(decoder.take_empty_frame_count(), 0U);
    }
}

TEST(WebSocketDecoder, OnlyTheNewestPingIsKept) {
    WebSocketDecoder decoder;
    EXPECT_EQ(decode(decoder, frame(last | ping, "a") + frame(last | ping, "b") + frame(last | pong, "c")), "");
    EXPECT_EQ(decoder.take_ping(), "b");
    EXPECT_EQ(decoder.take_empty_frame_count(), 3U);
}

TEST(WebSocketDecoder, StopsAtACloseFrame) {
    for (const std::string& reason : {std::string{}, std::string{"\x03\xe8"}, std::string{"\x0b\xb8why"}}) {
        WebSocketDecoder decoder;
        EXPECT_EQ(decode(decoder, frame(last | binary, "before") + frame(last | close_frame, reason) +
                                      frame(last | binary, "after")),
                  "before");
        EXPECT_TRUE(decoder.closed());
        EXPECT_FALSE(decoder.fault());
    }
}

TEST(WebSocketDecoder, NamesFaults) {
    EXPECT_EQ(fault_of(frame(last | text, "hello")), WebSocketClose::UnsupportedData);
    EXPECT_EQ(fault_of(frame(text, "hello")), WebSocketClose::UnsupportedData);
    for (const std::string& bytes :
         {std::string{"\x82\x01", 2}, frame(0xc2, "reserved bit"), frame(last | 3, "opcode"),
          frame(last | 11, "opcode"), frame(last | continuation, "of nothing"),
          frame(binary, "one") + frame(last | binary, "two"), frame(ping, "fragment"),
          frame(last | ping, std::string(126, 'x'), std::string{"\x7e\0\x7e", 3}),
          frame(last | binary, "", std::string{"\x7e\0\x7d", 3}),
          frame(last | binary, "", std::string{"\x7f\0\0\0\0\0\0\xff\xff", 9}),
          frame(last | binary, "", std::string{"\x7f\x80\0\0\0\0\0\0\0", 9}), frame(last | close_frame, "x"),
          frame(last | close_frame, "\x03\xed"), frame(last | close_frame, "\x03\xe7"),
          frame(last | close_frame, "\x0b\xb7"), frame(last | close_frame, "\x13\x88")}) {
        EXPECT_EQ(fault_of(bytes), WebSocketClose::ProtocolError) << testing::PrintToString(bytes);
    }
}

TEST(WebSocketDecoder, ContentBeforeAFaultIsKept) {
    WebSocketDecoder decoder;
    EXPECT_EQ(decode(decoder, frame(last | binary, "before") + frame(last | text, "x") + frame(last | binary, "no")),
              "before");
    EXPECT_TRUE(decoder.fault());
}

TEST(WebSocketHeaders, LengthsAreEncodedInTheShortestWay) {
    EXPECT_EQ(binary_message_header(0).view(), (std::string_view{"\x82\0", 2}));
    EXPECT_EQ(binary_message_header(125).view(), "\x82\x7d");
    EXPECT_EQ(binary_message_header(126).view(), (std::string_view{"\x82\x7e\0\x7e", 4}));
    EXPECT_EQ(binary_message_header(65535).view(), "\x82\x7e\xff\xff");
    EXPECT_EQ(binary_message_header(65536).view(), (std::string_view{"\x82\x7f\0\0\0\0\0\1\0\0", 10}));
}

TEST(WebSocketHeaders, ControlFramesAreNotMasked) {
    EXPECT_EQ(encode_ping(), (std::string{"\x89\0", 2}));
    EXPECT_EQ(encode_pong("x"), "\x8a\x01x");
    EXPECT_EQ(encode_close(WebSocketClose::GoingAway), "\x88\x02\x03\xe9");
}

TEST(WebSocketHandshake, AKeyIsTheBase64Of16Bytes) {
    EXPECT_EQ(websocket_accept("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="); // of RFC 6455
    for (const char* key : {"", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZQ===", "dGhlIHNhbXBsZSBub25jZQAA",
                            "dGhlIHNhbXBsZSBub25j\n===", "dGhlIHNhbXBsZSBub25jZ*==", "                      =="}) {
        EXPECT_EQ(websocket_accept(key), std::nullopt) << key;
    }
}

} // namespace
} // namespace evod::network
