#include "server/base/result.h"

#include <gmock/gmock.h>

namespace evod::base {
namespace {

TEST(Refusal, AsTextHasALinePerWrongField) {
    const Refusal refused{.code = RefusalCode::InvalidArgument,
                          .message = "invalid parameter values",
                          .violations = {{"mutation_chance", "0 to 1", "1.5"}, {"food_count", "0 to 9", "-1"}},
                          .reason = Reason::FieldInvalid};
    EXPECT_EQ(to_text(refused.violations[0]), "mutation_chance: got 1.5, allowed 0 to 1");
    const std::string text = to_text(refused);
    EXPECT_THAT(text, testing::StartsWith("invalid parameter values"));
    EXPECT_THAT(text, testing::HasSubstr("\n  mutation_chance: got 1.5, allowed 0 to 1\n  food_count: got -1"));
    EXPECT_EQ(to_text(refusal(RefusalCode::NotFound, "no such world")), "no such world");
}

TEST(Refusal, CodesHaveTheNamesOfTheProtocol) {
    EXPECT_STREQ(name_of(RefusalCode::InvalidArgument), "INVALID_ARGUMENT");
    EXPECT_STREQ(name_of(RefusalCode::Unauthenticated), "UNAUTHENTICATED");
    EXPECT_STREQ(name_of(RefusalCode::DataLoss), "DATA_LOSS");
}

TEST(Result, OfARefusalThrowsItsText) {
    const Result<int> refused = refusal(RefusalCode::NotFound, "no such world");
    try {
        (void)refused.value();
        FAIL() << "a value was returned";
    } catch (const std::exception& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("no such world"));
    }
}

} // namespace
} // namespace evod::base
