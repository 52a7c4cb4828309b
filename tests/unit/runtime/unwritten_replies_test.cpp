#include "server/runtime/unwritten_replies.h"

#include <gmock/gmock.h>

#include <string>

namespace evod::runtime {
namespace {

CommandDone command(const std::string& frame, recording::Ticket ticket) {
    return {.mail = {},
            .outcome = simulation::Applied{.world = "w", .tick = 7, .parameters = {}},
            .frame = frame,
            .event = v1::Event{},
            .ticket = ticket,
            .fork = ForkFile{}};
}

RunFound found(recording::Ticket ticket) {
    return {
        .mail = {}, .run = FoundRun{.run = {{"w.evod"}, {1, 2}}, .generation = 5, .until = {5, 90}}, .ticket = ticket};
}

TEST(UnwrittenReplies, PassOnWhatNeedsNoReceipt) {
    UnwrittenReplies replies;
    const auto done = replies.pass(command("done", 0));
    ASSERT_TRUE(done);
    EXPECT_EQ(std::get<CommandDone>(*done).frame, "done");
    EXPECT_TRUE(replies.pass(QueryDone{.mail = {}, .response = {}, .result = {}}));
    EXPECT_TRUE(replies.pass(found(0)));
}

TEST(UnwrittenReplies, ARunMayNotReachWhatIsNotWritten) {
    UnwrittenReplies replies;
    EXPECT_FALSE(replies.pass(found(1)));
    EXPECT_FALSE(replies.pass(found(2)));
    EXPECT_EQ(std::get<RunFound>(replies.pass(recording::Receipt{1}).value()).run->until.tick, 90u);
    const auto why = base::refusal(base::RefusalCode::Unavailable, "no room");
    EXPECT_EQ(std::get<RunFound>(replies.pass(recording::Receipt{2, why}).value()).run->until.tick, 0u);
}

TEST(UnwrittenReplies, ComeInTheOrderOfTheirReceipts) {
    UnwrittenReplies replies;
    EXPECT_FALSE(replies.pass(command("first", 1)));
    EXPECT_FALSE(replies.pass(found(2)));
    EXPECT_FALSE(replies.pass(command("third", 3)));
    EXPECT_EQ(std::get<CommandDone>(replies.pass(recording::Receipt{3}).value()).frame, "third");
    EXPECT_EQ(std::get<RunFound>(replies.pass(recording::Receipt{2}).value()).run->generation, 5u);
    const auto first = std::get<CommandDone>(replies.pass(recording::Receipt{1}).value());
    EXPECT_EQ(first.frame, "first");
    EXPECT_TRUE(first.outcome && first.event && first.fork);
    EXPECT_EQ(first.ticket, 0u);
}

TEST(UnwrittenReplies, ACommandThatIsNotRecordedIsRefused) {
    UnwrittenReplies replies;
    const base::Refusal why = base::refusal(base::RefusalCode::DataLoss, "w.evod is damaged");
    EXPECT_FALSE(replies.pass(command("done", 1)));
    EXPECT_FALSE(replies.pass(found(2)));
    const auto refused = std::get<CommandDone>(replies.pass(recording::Receipt{1, why}).value());
    ASSERT_FALSE(refused.outcome);
    EXPECT_EQ(refused.outcome.error().reason, base::Reason::WorldDamaged);
    EXPECT_THAT(refused.outcome.error().message, testing::HasSubstr(why.message));
    EXPECT_NE(refused.frame, "done");
    EXPECT_FALSE(refused.event || refused.fork);
    EXPECT_TRUE(std::get<RunFound>(replies.pass(recording::Receipt{2, why}).value()).run)
        << "the file is read in its present state";
}

} // namespace
} // namespace evod::runtime
