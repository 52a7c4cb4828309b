#include "server/protocol/refusals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace evod::protocol {
namespace {

TEST(Refusals, HaveTheReasonsOfTheProtocol) {
    EXPECT_EQ(static_cast<int>(base::Reason::SessionsMax), v1::REASON_SESSIONS_MAX);
    EXPECT_EQ(static_cast<int>(base::Reason::JoinsTooFast), v1::Reason_MAX);
    EXPECT_EQ(static_cast<int>(base::Reason::WorldNotFound), v1::REASON_WORLD_NOT_FOUND);
    EXPECT_EQ(static_cast<int>(base::Reason::RunFileDamaged), v1::REASON_RUN_FILE_DAMAGED);
    EXPECT_EQ(static_cast<int>(base::Reason::NoView), v1::REASON_NO_VIEW);
    EXPECT_EQ(static_cast<int>(base::Reason::AnswerTooLarge), v1::REASON_ANSWER_TOO_LARGE);
    EXPECT_EQ(to_proto(refusal(base::RefusalCode::InvalidArgument, "")).reason(), v1::REASON_FIELD_INVALID);
    EXPECT_EQ(to_proto(refusal(base::RefusalCode::NotFound, "", base::Reason::ReplaysMax)).reason(),
              v1::REASON_REPLAYS_MAX);
}

TEST(Refusals, QuoteNoControlCharacters) {
    EXPECT_EQ(quotable("a\nb\x1b[31m"), "a?b?[31m");
    EXPECT_EQ(quotable("a\xc2\x9b[31m é\xc2\xa0\xc2"), "a?[31m é\xc2\xa0\xc2")
        << "U+009B starts an escape sequence, too";
    EXPECT_EQ(quotable("a\xe2\x80\xa8"
                       "b\xe2\x80\xae"
                       "c\xe2\x81\xa6"
                       "d\xd8\x9c"),
              "a?b?c?d?")
        << "U+2028 ends a line, and others change the text direction";
    EXPECT_EQ(quotable("a – b … c\xe2\x80"), "a – b … c\xe2\x80");
    EXPECT_EQ(quotable("abcdef", 3), "abc…");
    EXPECT_EQ(quotable("ää", 3), "ä…") << "cut between characters";
    EXPECT_EQ(quotable("äää", 0), "…");
}

TEST(Refusals, HaveACompleteMessage) {
    const base::Refusal one{.message = "no such island", .violations = {{"place.island", "0 to 3", "9"}}};
    EXPECT_EQ(to_proto(one).message(), "no such island\n  place.island: got 9, allowed 0 to 3");
    const base::Refusal said{.message = "a.b: got 9, allowed 1", .violations = {{"a.b", "1", "9"}}};
    EXPECT_EQ(to_proto(said).message(), "a.b: got 9, allowed 1") << "the sentence says it already";
    const base::Refusal unknown{.message = "invalid parameter values",
                                .violations = {{"foot", "a parameter; did you mean food", base::unknown_name}}};
    EXPECT_EQ(to_proto(unknown).message(), "invalid parameter values\n  foot: unknown name; did you mean food?");
}

TEST(Refusals, ContainTheirArguments) {
    const auto status = to_proto(base::limit_refusal("too many", base::Reason::WorldsMax, "worlds_max", 7, 8));
    ASSERT_EQ(status.arguments_size(), 3);
    EXPECT_EQ(status.arguments(0).name() + " " + status.arguments(0).value(), "limit worlds_max");
    EXPECT_EQ(status.arguments(1).name() + " " + status.arguments(1).value(), "held 7");
    EXPECT_EQ(status.arguments(2).name() + " " + status.arguments(2).value(), "allowed 8");
}

TEST(Refusals, AreBoundedInLength) {
    base::Refusal refusal;
    refusal.violations.assign(100'000, {std::string(10'000, 'f'), "a", ""});
    const auto status = to_proto(refusal);
    EXPECT_EQ(status.violations_size(), 200);
    EXPECT_LT(status.ByteSizeLong(), 100'000);
    EXPECT_THAT(status.message(), testing::EndsWith("\n  and 99980 more fields"));
    EXPECT_EQ(status.violations(0).got(), "nothing");
}

} // namespace
} // namespace evod::protocol
