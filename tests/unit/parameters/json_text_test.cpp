#include "server/parameters/json_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace evod::parameters {
namespace {

using testing::StartsWith;

TEST(JsonText, HasOneValue) {
    ASSERT_TRUE(parse_json(" {\"a\": [1, 2]}\r\n\t").has_value());
    EXPECT_EQ(parse_json("3").value().whole_number(), 3u);
    EXPECT_FALSE(parse_json("").has_value());
    EXPECT_FALSE(parse_json("1 2").has_value());
    EXPECT_FALSE(parse_json("{} {}").has_value());
    EXPECT_FALSE(parse_json(std::string(100'000, '[')).has_value());
}

TEST(JsonText, ErrorsNameTheirLine) {
    const auto refused = parse_json("{\n\"a\": 1,\n\"b\" 2\n}").error();
    EXPECT_EQ(refused.code, base::RefusalCode::InvalidArgument);
    EXPECT_THAT(refused.message, StartsWith("not JSON: line 3, column 5: "));
    EXPECT_THAT(parse_json("{\"a\": 1}\n}").error().message, StartsWith("not JSON: line 2, column 1: "));
}

TEST(JsonText, AByteOrderMarkIsSkipped) {
    const auto document = parse_json("\xef\xbb\xbf{\"a\": 30.0}\r\n");
    ASSERT_TRUE(document) << document.error().message;
    EXPECT_EQ(document->find("a")->value.whole_number(), 30u);
}

TEST(JsonText, ErrorsStateTheLikelyCause) {
    const auto message = [](std::string_view text) { return parse_json(text).error().message; };
    EXPECT_THAT(message("{\"a\": 1,\n }"), testing::AllOf(StartsWith("not JSON: line 2, column 2: "),
                                                          testing::EndsWith(" at }; remove the comma before }")));
    EXPECT_THAT(message("[1, ]"), testing::EndsWith("remove the comma before ]"));
    EXPECT_THAT(message("{\n// why\n\"a\": 1}"), testing::HasSubstr("JSON has no comments"));
    EXPECT_THAT(message("{\"a\": 1 # why\n}"), testing::HasSubstr("JSON has no comments"));
    EXPECT_THAT(message("{'a': 1}"), testing::HasSubstr("double quotes"));
    EXPECT_THAT(message("{\"a\": 'b'}"), testing::HasSubstr("double quotes"));
    EXPECT_THAT(message("{\"a\": 0,1}"), testing::HasSubstr("write a point in a decimal number"));
    EXPECT_THAT(message("{\"a\": True}"), testing::HasSubstr("lower case"));
    EXPECT_THAT(message("{\"a\": 1 \"b\": 2}"), testing::HasSubstr("a comma may be missing"));
    EXPECT_THAT(message("{a: 1}"), testing::HasSubstr("double quotes"));
}

TEST(JsonText, MembersAndElementsHaveTheirLines) {
    const std::string text = "\n{\"a\": {\n\"b\\n\\u0022\": [1,\n\"x,]}\", [ ]]},\n\"a\":\nnull}";
    const auto document = parse_json(text);
    ASSERT_TRUE(document);
    EXPECT_EQ(document->line, 2u);
    ASSERT_EQ(document->members.size(), 2u);
    EXPECT_EQ(document->members[1].line, 5u);
    EXPECT_EQ(document->members[1].value.line, 6u);
    EXPECT_EQ(document->members[1].value.text, "null");
    const JsonMember& inner = document->find("a")->value.members[0];
    EXPECT_EQ(inner.name, "b\n\"");
    EXPECT_EQ(inner.line, 3u);
    ASSERT_EQ(inner.value.elements.size(), 3u);
    EXPECT_EQ(inner.value.elements[1].line, 4u);
    EXPECT_EQ(inner.value.elements[1].string(), "x,]}");
    EXPECT_TRUE(inner.value.elements[2].elements.empty());
    EXPECT_EQ(document->find("b"), nullptr);
}

TEST(JsonText, NumbersKeepAllTheirBits) {
    const auto whole = [](std::string_view text) { return parse_json(text)->whole_number(); };
    EXPECT_EQ(whole("18446744073709551615"), ~std::uint64_t{0});
    EXPECT_EQ(whole("-0"), 0u);
    EXPECT_EQ(whole("30.0"), 30u);
    EXPECT_EQ(whole("1e3"), 1000u);
    EXPECT_EQ(whole("9007199254740991.0"), 9'007'199'254'740'991u);
    for (const char* text : {"18446744073709551616", "-1", "1.5", "1e20", "-1e2", "\"1\"", "null"}) {
        EXPECT_EQ(whole(text), std::nullopt) << text;
    }
    EXPECT_EQ(parse_json("0.1")->real(), 0.1);
    EXPECT_EQ(parse_json("123456789012345678901234567890")->real(), 123456789012345678901234567890.0);
    EXPECT_EQ(parse_json("1e-999")->real(), 0.0);
}

TEST(JsonText, LongTextsAreDescribedInErrors) {
    EXPECT_EQ(parse_json("[1, 2]")->quoted(), "[1, 2]");
    const std::string list = "[" + std::string(60, ' ') + "]", object = "{" + std::string(60, ' ') + "}";
    EXPECT_EQ(parse_json(list)->quoted(), "a list");
    EXPECT_EQ(parse_json(object)->quoted(), "an object");
}

TEST(JsonText, ARepeatedNameIsAViolation) {
    const std::string text = "{\"a\": 1,\n\"b\": 2,\n\"a\": 3}";
    const auto document = parse_json(text);
    std::vector<base::Violation> violations;
    const auto members = unique_members(*document, "list[0].", violations);
    ASSERT_EQ(members.size(), 2u);
    EXPECT_EQ(members[0]->value.text, "1");
    ASSERT_EQ(violations.size(), 1u);
    EXPECT_EQ(violations[0].field, "list[0].a (line 3)");
    EXPECT_EQ(violations[0].got, "given twice");
}

} // namespace
} // namespace evod::parameters
