#include "server/parameters/json_text.h"

#include <boost/json.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::parameters {
namespace {

TEST(JsonText, LinesAreCountedFromOne) {
    EXPECT_EQ(line_of("a\nb\n\nc", 0), 1u);
    EXPECT_EQ(line_of("a\nb\n\nc", 1), 1u);
    EXPECT_EQ(line_of("a\nb\n\nc", 2), 2u);
    EXPECT_EQ(line_of("a\nb\n\nc", 5), 4u);
    EXPECT_EQ(line_of("", 0), 1u);
}

TEST(JsonText, HasOneValue) {
    ASSERT_TRUE(parse_json(" {\"a\": [1, 2]}\r\n\t").has_value());
    EXPECT_EQ(parse_json("3").value().as_int64(), 3);
    EXPECT_FALSE(parse_json("").has_value());
    EXPECT_FALSE(parse_json("1 2").has_value());
    EXPECT_FALSE(parse_json("{} {}").has_value());
}

TEST(JsonText, ErrorsNameTheirLine) {
    const auto refused = parse_json("{\n\"a\": 1,\n\"b\" 2\n}").error();
    EXPECT_EQ(refused.code, base::RefusalCode::InvalidArgument);
    EXPECT_THAT(refused.message, testing::StartsWith("not JSON: line 3: "));
    EXPECT_THAT(parse_json("{\"a\": 1}\n}").error().message, testing::StartsWith("not JSON: line 2: "));
}

} // namespace
} // namespace evod::parameters
