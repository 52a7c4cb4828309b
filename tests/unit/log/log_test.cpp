#include "server/log/log.h"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <gtest/gtest.h>

#include <string>

namespace evod::log {
namespace {

using namespace std::chrono_literals;
constexpr std::chrono::system_clock::time_point moment{1763786452s + 7ms};

boost::json::object read(const std::string& line) {
    EXPECT_EQ(line.find('\n'), std::string::npos);
    return boost::json::parse(line).as_object();
}

TEST(JsonLine, HasTimeLevelMessageAndKnownFields) {
    EXPECT_EQ(json_line(moment, Level::Warn, {}, "worlds wait"),
              R"({"time":"2025-11-22T04:40:52.007Z","level":"warn","message":"worlds wait"})");
    EXPECT_EQ(json_line(moment, Level::Info, {.session = 3, .client = "anna", .world = "lesson"}, "hello"),
              R"({"time":"2025-11-22T04:40:52.007Z","level":"info","message":"hello","session":3,"client":"anna",)"
              R"("world":"lesson"})");
}

TEST(JsonLine, EveryByteOfAMessageSurvives) {
    std::string every;
    for (int c = 1; c < 128; ++c) {
        every += static_cast<char>(c);
    }
    every += "é – 🦠\xc2\x9b[31m";
    const auto object = read(json_line(moment, Level::Error, {.client = every}, every));
    EXPECT_EQ(object.at("message").as_string(), every);
    EXPECT_EQ(object.at("client").as_string(), every);
}

TEST(JsonLine, HasNoTerminalControlCharacters) {
    std::string every;
    for (int c = 0; c < 256; ++c) {
        every += static_cast<char>(c);
    }
    every += "\xc2\x9b[31m";
    const std::string line = json_line(moment, Level::Info, {}, every);
    for (const char c : line) {
        EXPECT_TRUE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    }
    EXPECT_EQ(line.find("\xc2\x9b"), std::string::npos);
}

TEST(JsonLine, InvalidUtf8IsReplaced) {
    for (const std::string wrong : {"\xff", "\xc3", "\xc0\xaf", "\xe2\x82", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                                    "\xf4\x90\x80\x80", "\x80", "\xf8\x88\x80\x80\x80"}) {
        const auto object = read(json_line(moment, Level::Info, {}, "a" + wrong + "b"));
        const std::string message{object.at("message").as_string()};
        EXPECT_TRUE(message.starts_with("a\xef\xbf\xbd") && message.ends_with("\xef\xbf\xbd"
                                                                              "b"))
            << message;
    }
}

TEST(PlainLine, HasNoTerminalControlCharacters) {
    EXPECT_EQ(plain_line("cannot\n  a: \x1b[31m\r\t\x7f"), "cannot\n  a: ?[31m???");
}

} // namespace
} // namespace evod::log
