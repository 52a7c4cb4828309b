#include "client/viewer/world/lineage_poll.h"

#include "tests/unit/viewer/world/lineage_table.h"
#include "tests/unit/viewer/world/viewed_world_fixture.h"

namespace evod::viewer {
namespace {

using testing::HasSubstr;

struct LineagePollTest : ViewedWorldTest {
    LineagePollTest() : session{begin(world)} {}

    /// Updates until the condition holds.
    template <class Condition>
    void poll_until(Condition condition) {
        until(world, [&] {
            poll.update(world, true, std::chrono::steady_clock::now());
            return condition();
        });
    }
    void show(std::uint64_t generation, const std::string& run_id = "\xaa") {
        evod::v1::SnapshotFrame frame;
        frame.set_width_px(100);
        frame.set_height_px(100);
        codec::encode_plain({}, frame);
        frame.set_world("default");
        frame.set_run_id(run_id);
        frame.set_subscription_id(7);
        frame.set_island(1);
        frame.set_island_count(2);
        frame.set_generation(generation);
        frame.set_tick(100 * generation);
        frame.mutable_live()->set_organism_count(2'500);
        session.send(frame);
        until(world, [&] { return world.feed.snapshot() && world.feed.snapshot()->about.generation() == generation; });
    }
    /// The next request other than queries of the world's state.
    evod::v1::Request next() {
        for (;;) {
            poll_until([&] { return session.unread_bytes() > 0; });
            const auto request = session.read_request();
            if (!request.has_get_statistics()) {
                return request;
            }
            answer_statistics(session, request);
        }
    }
    void answer(const evod::v1::Request& request, const std::string& text, bool last) {
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request.request_id());
        auto& part = *message.mutable_response()->mutable_export_part();
        part.set_export_id(5);
        part.set_text(text);
        part.set_last(last);
        session.send(message);
    }

    ViewedWorld world{wanted()};
    core::FakeSession session;
    LineagePoll poll;
};

TEST_F(LineagePollTest, ReadsTheRunPartByPart) {
    show(3);
    const auto first = next();
    EXPECT_EQ(first.export_run().world(), "default");
    EXPECT_EQ(first.export_run().table(), evod::v1::RUN_TABLE_LINEAGE);
    EXPECT_EQ(first.export_run().first_generation(), 1u);
    answer(first, lineage_heading + lineage_rows(1, {{}, {}}) + "2,0,0,1,0", false);
    const auto second = next();
    EXPECT_EQ(second.continue_export().export_id(), 5u);
    answer(second, ",1,1,0,0,child,1,,\n3,0,0,2,0,0,2,0,0,elite,,,\n", true);
    poll_until([&] { return poll.lineage().version() == 3; });
    EXPECT_EQ(poll.lineage().last(), 3u);
    EXPECT_EQ(poll.problem(), "");
}

TEST_F(LineagePollTest, RequestsNewGenerationsFromTheLastKnownOne) {
    show(150);
    const auto first = next();
    EXPECT_EQ(first.export_run().first_generation(), 51u) << "500,000 organisms are 100 generations of two islands";
    answer(first, lineage_heading + lineage_rows(149, {{1}}) + lineage_rows(150, {{0}}), true);
    poll_until([&] { return !poll.lineage().empty(); });
    show(152);
    EXPECT_EQ(next().export_run().first_generation(), 150u);
}

TEST_F(LineagePollTest, AnotherRunClearsTheLineage) {
    show(2);
    answer(next(), lineage_heading + lineage_rows(1, {{}}) + lineage_rows(2, {{0}}), true);
    poll_until([&] { return !poll.lineage().empty(); });
    show(1, "\xbb");
    poll_until([&] { return poll.lineage().empty(); });
}

TEST_F(LineagePollTest, AnInvalidTableIsReported) {
    show(2);
    answer(next(), "generation\n", true);
    poll_until([&] { return !poll.problem().empty(); });
    EXPECT_THAT(poll.problem(), HasSubstr("The server's answer is invalid: line 1 of the lineage table"));
}

TEST_F(LineagePollTest, ARefusalIsReported) {
    show(2);
    session.refuse(next().request_id(), evod::v1::CODE_FAILED_PRECONDITION, "the server keeps no runs");
    poll_until([&] { return !poll.problem().empty(); });
    EXPECT_EQ(poll.problem(), "The server keeps no runs");
}

TEST_F(LineagePollTest, AsksAServerWithoutRunsOncePerChoice) {
    show(2);
    const auto refuse = [&](std::uint64_t request_id) {
        evod::v1::ServerMessage message;
        message.mutable_response()->set_request_id(request_id);
        message.mutable_response()->mutable_status()->set_code(evod::v1::CODE_FAILED_PRECONDITION);
        message.mutable_response()->mutable_status()->set_reason(evod::v1::REASON_RUNS_NOT_KEPT);
        message.mutable_response()->mutable_status()->set_message("this server stores no runs");
        session.send(message);
    };
    refuse(next().request_id());
    poll_until([&] { return !poll.problem().empty(); });
    const auto later = std::chrono::steady_clock::now() + 2 * Poll::after_refusal;
    poll.update(world, true, later);
    EXPECT_TRUE(world.all_answered()) << "nothing was sent";
    EXPECT_EQ(poll.problem(), "This server stores no runs");
    poll.update(world, false, later);
    poll.update(world, true, later);
    EXPECT_FALSE(world.all_answered()) << "chosen again";
}

TEST_F(LineagePollTest, RequestsNothingUntilItIsWanted) {
    show(2);
    for (int i = 0; i < 20; ++i) {
        world.update(std::chrono::steady_clock::now());
        poll.update(world, false, std::chrono::steady_clock::now());
        take_a_nap();
    }
    while (session.unread_bytes() > 0) {
        EXPECT_TRUE(session.read_request().has_get_statistics());
    }
}

} // namespace
} // namespace evod::viewer
